"""Lines of an SVG drawing, read by svgelements: shapes, paths, transforms, units, viewports, `<use>`, style sheets.

What it is handed has been decoded, checked and bounded before (`svg_tree.py`).
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from io import StringIO
from itertools import pairwise
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from sim_core.errors import FileProblem
from sim_core.mesh.sheets.strokes.stroke import Drawn, Stroke
from sim_core.mesh.sheets.strokes.svg_tree import (
    LENGTHS,
    NUMBER,
    check_bounds,
    flatten_viewports,
    left_out_of,
    svg_root,
)
from sim_core.mesh.sheets.strokes.words import speaks, spoken

__all__ = ["svg_strokes"]

PIXEL = 0.0254 / 96  # [m]
PIXELS = "no size in units of length: a drawing unit is taken for 0.2646 mm (a CSS pixel) – if it is not, say --units"
UNNAMED = re.compile(
    r"(svg|g|layer|path|use|group|rect|polygon|fs|_|xmlid|text|surface|clip|source|_?x)*[\s_-]*[\d_-]*",
    re.IGNORECASE,
)
GLYPH = re.compile(r"#?(glyph|font)[\d_-]*\d")  # as cairo and MuPDF name the letters they draw as outlines
PAINT = ("fill", "stroke", "stroke-dasharray", "visibility")
NAMING = ("class", "id", "label", "href", "marker", "text")
LETTERS = ("id", "href", "xlink:href", "data-symbol")
SAME = 0.01  # most by which width and height of one scale differ, as sizes are rounded
STEPS, TURN = 24, 0.05  # of a curve piece; [rad] most of an arc in one step
RIGHT = 1e-9  # [rad] by which the axes of an arc may miss their right angle
Shape = tuple[np.ndarray, bool]


def svg_strokes(path: Path, metres: float | None = None) -> Drawn:
    """The lines of an SVG file [m], y down; raises FileProblem.

    metres: of a user unit; without it the drawing's size counts, and without that a user unit is a CSS pixel
    (FreeSewing: a millimetre).
    """
    root = svg_root(path)
    left_out = left_out_of(root)
    try:
        check_bounds(root)
        drawing, guessed = _drawing(root, metres)
        with np.errstate(all="ignore"):  # what leaves the range is told by whoever sorts the lines
            found = list(_strokes(drawing))
    except RecursionError as error:
        raise FileProblem(f"{path}: groups nested too deep – take shapes out of their groups") from error
    except (ValueError, IndexError, KeyError, TypeError, AttributeError, ArithmeticError) as error:
        reason = " ".join(str(error).split())[:120] or type(error).__name__
        remedy = "" if "–" in reason else " – give paths, polygons, rectangles or circles"
        raise FileProblem(f"{path}: {reason}{remedy}") from error
    return Drawn(found, left_out, notes=(PIXELS,) if guessed else ())


def _drawing(root: ElementTree.Element, metres: float | None) -> tuple[Any, bool]:
    """The drawing in CSS pixels, the size of its own viewport worked out here, to the last bit; and whether its unit is
    a guess."""
    from svgelements import SVG

    box = [float(v) for v in re.split(r"[\s,]+", root.get("viewBox", "").strip()) if v]
    styled = dict(re.findall(r"([a-z-]+)\s*:\s*([^;]+)", root.get("style", "")))
    width, height = (styled.get(side, root.get(side, "")).strip() for side in ("width", "height"))
    unit = tall = 1.0 if metres is None else metres / PIXEL
    sized = bool(width) and not width.endswith("%")
    guessed = metres is None and (not sized or re.fullmatch(NUMBER.pattern, width) is not None)
    if metres is None and not sized and root.get("freesewing"):
        unit, guessed = 1e-3 / PIXEL, False
        tall = unit
    if metres is None and len(box) == 4 and min(box[2:]) > 0 and sized:
        unit, tall = _scales(width, height, box, root.get("preserveAspectRatio", ""))
    if len(box) != 4:
        ends = [_pixels(v) / unit if v and not v.endswith("%") else float("nan") for v in (width, height)]
        flatten_viewports(root, (ends[0], ends[1]))
        box = [0.0, 0.0, 1.0, 1.0]
    elif not (box[2] > 0 and box[3] > 0):
        raise ValueError(f"viewBox {root.get('viewBox', '')[:40]!r} of a drawing without a size")
    else:
        flatten_viewports(root, (box[2], box[3]))
    root.set("viewBox", " ".join(repr(v) for v in box))
    root.set("width", repr(box[2] * unit))
    root.set("height", repr(box[3] * tall))
    root.set("preserveAspectRatio", "none")
    return SVG.parse(StringIO(ElementTree.tostring(root, "unicode")), reify=False, ppi=96), guessed


def _scales(width: str, height: str, box: list[float], aspect: str) -> tuple[float, float]:
    """CSS pixels a user unit across and down, as a browser fits the viewBox into the size; raises ValueError."""
    across = _pixels(width) / box[2]
    down = _pixels(height) / box[3] if height and not height.endswith(("%", "auto")) else across
    if abs(down - across) <= SAME * across:  # sizes are rounded: the width counts
        return across, across
    words = aspect.split()
    if words[:1] == ["none"]:
        return across, down
    both = max(across, down) if words[1:] == ["slice"] else min(across, down)
    return both, both


def _pixels(text: str) -> float:
    """A length in CSS pixels; raises ValueError."""
    match = re.fullmatch(rf"\s*({NUMBER.pattern})\s*([a-z]*)\s*", text.lower())
    if match is None or match[2] not in LENGTHS:
        raise ValueError(
            f"length {text[:30]!r} has no unit of length – say it with --units, such as --units mm"
        )
    if not (pixels := float(match[1]) * LENGTHS[match[2]]) > 0:
        raise ValueError(f"width {text[:30]!r} is not positive")
    return pixels


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
            yield from _shape(element, _curves(element), groups, said, paint)
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
    for points, closed in _lines(curves):
        yield Stroke(points * PIXEL, closed, str(layer), groups, words, filled, dashed, own)


def _curves(element: Any) -> Any:
    """The path of a shape in CSS pixels.

    svgelements keeps the axes of an ellipse at right angles, also where a transform leans them (a skew, a scale of two
    sizes around a rotation): such arcs are cut into steps before they are transformed.
    """
    from svgelements import Arc, Line
    from svgelements import Path as Curves

    matrix = element.transform
    if not any(isinstance(piece, Arc) and _leans(piece, matrix) for piece in Curves(element)):
        element.reify()
        return Curves(element).reify()
    pieces: list[Any] = []
    for piece in Curves(element):
        if isinstance(piece, Arc):
            places = np.asarray(piece.npoint(np.linspace(0, 1, _steps(piece) + 1)), float).tolist()
            pieces += [Line(start, end) for start, end in pairwise(places)]
        else:
            pieces.append(piece)
    return (Curves(pieces) * matrix).reify()


def _leans(arc: Any, matrix: Any) -> bool:
    """Whether a transform takes the right angle between the axes of an arc."""
    across, down = (
        np.array([matrix.a * x + matrix.c * y, matrix.b * x + matrix.d * y])
        for x, y in ((point.x - arc.center.x, point.y - arc.center.y) for point in (arc.prx, arc.pry))
    )
    return bool(abs(across @ down) > RIGHT * np.linalg.norm(across) * np.linalg.norm(down))


def _sheer(paint: dict[str, str]) -> bool:
    """Whether a fill has a line of another colour around it: a coloured piece, not an arrow or a letter."""
    stroke = paint.get("stroke", "none")
    return stroke not in ("none", "transparent") and stroke != paint.get("fill")


def _lines(curves: Any) -> Iterator[Shape]:
    """Polylines of a path's pieces, its arcs in steps of at most 0.05 rad."""
    from svgelements import Arc, Close, CubicBezier, Move, QuadraticBezier

    points: list[np.ndarray] = []
    closed = False
    every: Any = [*curves, Move(0)]
    for piece in every:
        place: Any = piece.end
        if isinstance(piece, Move):
            if points and len(line := np.concatenate(points)) > 1:
                if not closed and len(line) > 3 and np.array_equal(line[0], line[-1]):
                    closed = True
                yield (line[:-1] if closed and np.allclose(line[0], line[-1], atol=1e-9) else line), closed
            points, closed = [np.array([[place.x, place.y]], float)], False
        elif isinstance(piece, Close):
            closed = True
        elif isinstance(piece, Arc | CubicBezier | QuadraticBezier):
            count = _steps(piece) if isinstance(piece, Arc) else STEPS
            places = np.linspace(0, 1, count + 1)[1:]
            points.append(np.asarray(piece.npoint(places), float))
        elif place is not None:
            points.append(np.array([[place.x, place.y]], float))


def _steps(arc: Any) -> int:
    """Of an arc; raises ValueError where it leaves the range of numbers."""
    if not np.isfinite(float(arc.sweep)):
        raise ValueError("an arc leaves the range of numbers")
    return max(2, int(abs(arc.sweep) / TURN))
