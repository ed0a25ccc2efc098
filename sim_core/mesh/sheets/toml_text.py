"""Tables as TOML text: scalars first, then tables and arrays of tables, whose rows stand one a line."""

from __future__ import annotations

import json
import math
from typing import Any

__all__ = ["toml_text"]


def toml_text(tables: dict[str, Any]) -> str:
    """TOML of tables as `tomllib` gives them; raises TypeError for other values than text, numbers, lists, tables."""
    lines = [f"{_key(key)} = {_value(value)}" for key, value in tables.items() if not _is_table(key, value)]
    parts = ["\n".join(lines)]
    for key, value in tables.items():
        if _is_table(key, value):
            rows, head = (
                (value, f"[[{_key(key)}]]") if isinstance(value, list) else ([value], f"[{_key(key)}]")
            )
            parts += ["\n".join([head, *(f"{_key(k)} = {_rows(v)}" for k, v in row.items())]) for row in rows]
    return "\n\n".join(part for part in parts if part) + "\n"


def _is_table(key: str, value: Any) -> bool:
    if isinstance(value, list):
        return bool(value) and all(isinstance(row, dict) for row in value)
    return isinstance(value, dict) and key != "title"  # short enough for one line


def _rows(value: Any) -> str:
    """A list of tables one a line, anything else on one line."""
    if isinstance(value, list) and value and all(isinstance(row, dict) for row in value):
        return "[\n" + "".join(f"  {_value(row)},\n" for row in value) + "]"
    return _value(value)


def _key(key: Any) -> str:
    text = str(key)
    bare = bool(text) and all(c.isascii() and (c.isalnum() or c in "-_") for c in text)
    return text if bare else _text(text)


def _text(value: str) -> str:
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, int) or (isinstance(value, float) and math.isfinite(value)):
        return repr(value)
    if isinstance(value, list):
        return "[" + ", ".join(_value(v) for v in value) + "]"
    if isinstance(value, dict):
        return (
            "{ " + ", ".join(f"{_key(k)} = {_value(v)}" for k, v in value.items()) + " }" if value else "{}"
        )
    raise TypeError(f"{type(value).__name__} has no TOML")
