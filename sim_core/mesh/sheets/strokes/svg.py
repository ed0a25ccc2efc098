"""Lines of an SVG drawing, read by svgelements: shapes, paths, transforms, units, viewports, `<use>`, style sheets.

What it is handed has been decoded, checked and bounded before (`svg_tree.py`).
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from sim_core.mesh.sheets.strokes.stroke import Drawn, Stroke
from sim_core.mesh.sheets.strokes.words import speaks, spoken
from sim_core.validation.svg import (
    PIXEL,
    check_bounds,
    curves_of,
    drawing_of,
    left_out_of,
    polylines,
    svg_root,
    told,
)

__all__ = ["svg_strokes"]

PIXELS = "no size in units of length: a drawing unit is taken for 0.2646 mm (a CSS pixel) – if it is not, say --units"
UNNAMED = re.compile(
    r"(svg|g|layer|path|use|group|rect|polygon|fs|_|xmlid|text|surface|clip|source|_?x)*[\s_-]*[\d_-]*",
    re.IGNORECASE,
)
GLYPH = re.compile(r"#?(glyph|font)[\d_-]*\d")  # as cairo and MuPDF name the letters they draw as outlines
PAINT = ("fill", "stroke", "stroke-dasharray", "visibility")
NAMING = ("class", "id", "label", "href", "marker", "text")
LETTERS = ("id", "href", "xlink:href", "data-symbol")


def svg_strokes(path: Path, metres: float | None = None) -> Drawn:
    """The lines of an SVG file [m], y down; raises FileProblem.

    metres: of a user unit; without it the drawing's size counts, and without that a user unit is a CSS pixel
    (FreeSewing: a millimetre).
    """
    root = svg_root(path)
    left_out = left_out_of(root)
    with told(path, "give paths, polygons, rectangles or circles"):
        check_bounds(root)
        drawing, guessed = drawing_of(root, metres)
        with np.errstate(all="ignore"):  # what leaves the range is told by whoever sorts the lines
            found = list(_strokes(drawing))
    return Drawn(found, left_out, notes=(PIXELS,) if guessed else ())


def _strokes(drawing: Any) -> Iterator[Stroke]:
    """Lines of every shape, with the names and the paint of the groups around."""
    from svgelements import Shape as Drawn
    from svgelements import Use

    waiting = [(child, (), (), {}) for child in reversed(drawing)]
    while waiting:
        element, groups, said, paint = waiting.pop()
        paint = {**paint, **_paint(element)}
        if _lettering(element):
            said = (*said, "text")
        if isinstance(element, Drawn):
            yield from _shape(element, curves_of(element), groups, said, paint)
        elif isinstance(element, list):
            if isinstance(element, Use):
                said = (*said, *_names(element))
            else:
                name = _name(element)
                groups = (*groups, name) if name else groups
                said = (
                    *said,
                    *_names(element, kinds=("class",)),
                    *(n for n in _titles(element) if speaks(n)),
                )
            waiting += [(child, groups, said, paint) for child in reversed(element)]


def _lettering(element: Any) -> bool:
    """Whether an element is text drawn as outlines: cairo and MuPDF name letters, Inkscape keeps what they say."""
    own = (getattr(element, "values", None) or {}).get("attributes") or {}
    if any(GLYPH.fullmatch(str(v)) for k, v in own.items() if str(k).rsplit("}", 1)[-1] in LETTERS):
        return True
    return "aria-label" in own and "font-" in str(own.get("style", ""))


def _paint(element: Any) -> dict[str, str]:
    """What an element itself says of fill, stroke, dashes and visibility."""
    own = (getattr(element, "values", None) or {}).get("attributes") or {}
    styled = re.findall(r"([a-z-]+)\s*:\s*([^;]+)", str(own.get("style", "")))
    said = {**own, **dict(styled)}
    return {key: str(said[key]).strip() for key in PAINT if key in said}


def _names(element: Any, kinds: tuple[str, ...] = NAMING) -> tuple[str, ...]:
    """What an element is called by itself, not by what is around it."""
    values = getattr(element, "values", None) or {}
    own = values.get("attributes", values)
    return tuple(
        str(value)
        for key, value in own.items()
        if str(key).rsplit("}", 1)[-1].rsplit(":", 1)[-1].removeprefix("data-").split("-")[0] in kinds
        and isinstance(value, str)
        and not UNNAMED.fullmatch(value)
        and not str(key).startswith("data-text-")
    )


def _titles(element: Any) -> tuple[str, ...]:
    """The label of an element and its id, unless a program made them up."""
    return (*_names(element, kinds=("label",)), *_names(element, kinds=("id",)))


def _name(element: Any) -> str:
    """The name of a group: its label, else its id unless a program made it up."""
    names = _titles(element)
    return names[0].removeprefix("fs-stack-").removeprefix("fs-container") if names else ""


def _shape(element: Any, curves: Any, groups, said, paint: dict[str, str]) -> Iterator[Stroke]:
    titles = _titles(element)
    names = _names(element, kinds=("class", "marker", "text"))
    words = spoken(*said, *names, *(title for title in titles if speaks(title)))
    if paint.get("visibility", "visible") in ("hidden", "collapse"):
        words = (*words, "hidden")
    dashed = paint.get("stroke-dasharray", "none") not in ("none", "0", "") or "dashed" in words
    layer = ((element.values or {}).get("attributes") or {}).get("class") or ""
    own = titles[0] if titles else ""
    filled = paint.get("fill", "none") not in ("none", "transparent") and not _sheer(paint)
    for points, closed in polylines(curves):
        yield Stroke(points * PIXEL, closed, str(layer), groups, words, filled, dashed, own)


def _sheer(paint: dict[str, str]) -> bool:
    """Whether a fill has a line of another colour around it: a coloured piece, not an arrow or a letter."""
    stroke = paint.get("stroke", "none")
    return stroke not in ("none", "transparent") and stroke != paint.get("fill")
