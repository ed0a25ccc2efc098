"""Measures of a pattern: numbers in millimetres, or sums of other measures written as text."""

from __future__ import annotations

import ast
import math
import operator
import warnings
from collections.abc import Callable, Mapping

from sim_core.validation.files import shown

__all__ = ["measured"]

LONGEST = 400  # characters of an expression

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
    if isinstance(value, str) and len(value) > LONGEST:
        raise ValueError(f"an expression of {len(value)} characters – at most {LONGEST}; name its parts")
    try:
        number = float(value) if not isinstance(value, str) else _reckoned(_parsed(value), known, along)
    except ZeroDivisionError as error:
        raise ValueError(f"{shown(value)} divides by zero – change a measure") from error
    except (OverflowError, RecursionError, MemoryError) as error:
        raise ValueError(f"{shown(value)} is too large – use smaller numbers and fewer brackets") from error
    if not math.isfinite(number):
        raise ValueError(f"{shown(value)} is not finite – use smaller numbers")
    return number


def _parsed(text: str) -> ast.expr:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of odd literals, which are refused or harmless
            return ast.parse(text.strip(), mode="eval").body
    except (SyntaxError, ValueError) as error:  # ValueError: a null byte
        raise ValueError(
            f"{shown(text)} is no expression – use names, numbers, + - * / and brackets"
        ) from error


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
