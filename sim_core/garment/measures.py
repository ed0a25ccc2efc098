"""Measures of a pattern: numbers in millimetres, or sums of other measures written as text."""

from __future__ import annotations

import ast
import math
import operator
from collections.abc import Callable, Mapping

__all__ = ["measured"]

_TWO: dict[type, Callable[[float, float], float]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
}


def measured(
    value: float | str, known: Mapping[str, float], along: Callable[[str], float] | None = None
) -> float:
    """The number of a measure: itself, or an expression of + - * / ( ), known names, min, max and along('path').

    along gives the length of a path on a panel [mm]. Raises ValueError saying what cannot be reckoned.
    """
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise ValueError(f"{value!r} – give a number in millimetres or an expression in quotes")
    if not isinstance(value, str):
        number = float(value)
    else:
        try:
            number = _reckoned(ast.parse(value, mode="eval").body, known, along)
        except SyntaxError as error:
            raise ValueError(
                f"{value!r} is no expression – use names, numbers, + - * / and brackets"
            ) from error
        except ZeroDivisionError as error:
            raise ValueError(f"{value!r} divides by zero") from error
    if not math.isfinite(number):
        raise ValueError(f"{value!r} is not finite")
    return number


def _reckoned(node: ast.expr, known: Mapping[str, float], along: Callable[[str], float] | None) -> float:
    if (
        isinstance(node, ast.Constant)
        and isinstance(node.value, int | float)
        and not isinstance(node.value, bool)
    ):
        return float(node.value)
    if isinstance(node, ast.Name):
        if node.id not in known:
            names = ", ".join(known) or "none"
            raise ValueError(f"{node.id!r} is not known – measures above it: {names}")
        return known[node.id]
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub | ast.UAdd):
        inner = _reckoned(node.operand, known, along)
        return -inner if isinstance(node.op, ast.USub) else inner
    if isinstance(node, ast.BinOp) and type(node.op) in _TWO:
        return _TWO[type(node.op)](_reckoned(node.left, known, along), _reckoned(node.right, known, along))
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and not node.keywords:
        return _called(node.func.id, node.args, known, along)
    raise ValueError(f"{ast.unparse(node)!r} is not allowed – use names, numbers, + - * / and brackets")


def _called(
    name: str, arguments: list[ast.expr], known: Mapping[str, float], along: Callable[[str], float] | None
) -> float:
    if name == "along" and along is not None and len(arguments) == 1:
        path = arguments[0]
        if isinstance(path, ast.Constant) and isinstance(path.value, str):
            return along(path.value)
    if name in ("min", "max") and arguments:
        return (min if name == "min" else max)(_reckoned(each, known, along) for each in arguments)
    raise ValueError(f"{name}(…) is not known – use min, max or along('panel: from > to')")
