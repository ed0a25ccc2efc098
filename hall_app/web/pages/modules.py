"""The page's modules as one: sixty small files, each asked for after the one that names it, are seconds on a slow line.

The sources stay plain modules that a browser runs as they are. They are put together when they are first asked for:
each becomes a function that returns its exports, in the order in which a browser would run them.
"""

from __future__ import annotations

import json
import posixpath
import re
from collections.abc import Callable

__all__ = ["one_module"]

_IMPORT = re.compile(r'^import\s+(?:(\{[^}]*\}|\*\s+as\s+\w+)\s+from\s+)?"(\.[^"]+)";[ \t]*$', re.MULTILINE)
_EXPORT = re.compile(
    r"^export\s+(?=(?:async\s+)?function\*?\s+(\w+)|class\s+(\w+)|const\s+(\w+))", re.MULTILINE
)
_LEFT = re.compile(r"^(?:import\b(?!\s*[.(])|export\b).*", re.MULTILINE)
_AS = re.compile(r"(\w+)\s+as\s+(\w+)")


def one_module(read: Callable[[str], str], entry: str) -> str:
    """One script that does what loading `entry` as a module does.

    read: source of a module by its path, "ui/words.js"; raises KeyError if there is none. Raises ValueError where
    a module is written in another way than the page's modules are.
    """
    done: dict[str, str] = {}

    def add(path: str, above: tuple[str, ...]) -> None:
        if path in above:
            raise ValueError(
                f"{path}: imports itself by way of {' → '.join(above)} – let one of them be told instead"
            )
        if path in done:
            return
        try:
            source = read(path)
        except KeyError:
            raise ValueError(
                f"{above[-1] if above else entry}: imports {path}, which does not exist"
            ) from None
        for match in _IMPORT.finditer(source):
            add(_target(path, match[2]), (*above, path))
        done[path] = _wrapped(path, source)

    add(entry, ())
    return '"use strict";\nconst modules = {};\n' + "".join(done.values())


def _target(path: str, named: str) -> str:
    return posixpath.normpath(posixpath.join(posixpath.dirname(path), named))


def _wrapped(path: str, source: str) -> str:
    """The module as a function's body; imports become constants, exports what it returns."""
    names = [next(name for name in match.groups() if name) for match in _EXPORT.finditer(source)]
    body = _EXPORT.sub("", _IMPORT.sub(lambda match: _constant(path, match[1], match[2]), source))
    left = _LEFT.search(body)
    if left:
        raise ValueError(
            f'{path}: {left[0].strip()!r} – write: import {{…}} from "./…"; export function|class|const'
        )
    return f"// {path}\nmodules[{json.dumps(path)}] = (() => {{\n{body}\nreturn {{ {', '.join(names)} }};\n}})();\n"


def _constant(path: str, taken: str | None, named: str) -> str:
    module = f"modules[{json.dumps(_target(path, named))}]"
    if taken is None:
        return ""
    if taken.startswith("*"):
        return f"const {taken.split()[-1]} = {module};"
    renamed = _AS.sub(r"\1: \2", taken)
    return f"const {renamed} = {module};"
