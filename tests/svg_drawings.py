"""Drawings in SVG to clean: one around given elements, what is kept of it, and few bytes that draw without end."""

from __future__ import annotations

import io
import re

from hall_app.house.drafts import Taken, intake, take_in
from hall_app.house.drawing import redrawn

__all__ = ["doubled", "drawing", "kept", "read", "taken"]


def drawing(inside: bytes, root: bytes = b"svg") -> bytes:
    told = b' xmlns="http://www.w3.org/2000/svg" viewBox="0 0 9 9">'
    return b"<" + root + told + inside + b"<!-- <svg --></" + root + b">"


def doubled(times: int) -> bytes:
    """Few bytes that draw one path 2^times times."""
    levels = [b'<path id="u0" d="M0 0h9"/>']
    for n in range(1, times + 1):
        levels.append(b'<g id="u%d"><use href="#u%d"/><use href="#u%d"/></g>' % (n, n - 1, n - 1))
    return b"".join(levels)


def taken(data: bytes, use: str = "picture") -> Taken:
    return take_in("sheet.svg", io.BytesIO(data), len(data), use)


def kept(inside: str) -> tuple[str, str]:
    """(what is kept within the root, what is told)."""
    one = taken(drawing(inside.encode()))
    return re.sub(r"^.*?<svg[^>]*>|</svg>$", "", one.data.decode(), flags=re.DOTALL), one.told


def read(data: bytes) -> str:
    """What is told of it; of a large one without the process of its own, where a clock would stop what is slow."""
    if len(data) < intake._AT_ONCE:
        return taken(data).told
    return redrawn("sheet.svg", data, _no_picture, 40_000_000)[1]


def _no_picture(*_: object) -> tuple[bytes, str, str]:
    raise AssertionError("none is within")
