"""Lines of an SVG drawing, read by svgelements: shapes, paths, transforms, units, viewports, `<use>`, style sheets.

Checked before it is handed over: entities that multiply themselves, and `<use>` of `<use>` without end.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from io import StringIO
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from sim_core.errors import FileProblem
from sim_core.mesh.left_out import warn_left_out
from sim_core.mesh.sheets.strokes import Stroke
from sim_core.mesh.sheets.svg_bounds import check_bounds, left_out_of
from sim_core.mesh.sheets.svg_viewports import LENGTHS, NUMBER, flatten_viewports
from sim_core.mesh.sheets.words import speaks, spoken
from sim_core.reading import read_text

__all__ = ["svg_strokes"]

PIXEL = 0.0254 / 96  # [m]
WHAT = "a pattern drawn as SVG"
UNNAMED = re.compile(
    r"(svg|g|layer|path|use|group|rect|polygon|fs|_|xmlid|text|_?x)*[\s_-]*[\d_-]*", re.IGNORECASE
)
PAINT = ("fill", "stroke", "stroke-dasharray", "visibility")
NAMING = ("class", "id", "label", "href", "marker", "text")
STEPS, TURN = 24, 0.05  # of a curve piece; [rad] most of an arc in one step
Shape = tuple[np.ndarray, bool]


def svg_strokes(path: Path, metres: float | None = None) -> list[Stroke]:
    """The lines of an SVG file [m], y down; raises FileProblem.

    metres: of a user unit; without it the width counts, and without that a user unit is a CSS pixel.
    """
    text = read_text(path, WHAT)
    try:
        root = ElementTree.fromstring(_plain(path, text))
    except (ElementTree.ParseError, ValueError) as error:
        raise FileProblem(f"{path}: not valid SVG ({error}) – give {WHAT}") from error
    if (tag := str(root.tag).rsplit("}", 1)[-1]) != "svg":
        raise FileProblem(f"{path}: its root is <{tag[:40]}> – give {WHAT}")
    try:
        check_bounds(root)
        drawing = _drawing(root, metres)
        with np.errstate(all="ignore"):  # what leaves the range is told by whoever sorts the lines
            found = list(_strokes(drawing))
    except RecursionError as error:
        raise FileProblem(f"{path}: groups nested too deep – take shapes out of their groups") from error
    except (ValueError, IndexError, KeyError, TypeError, AttributeError, ArithmeticError) as error:
        reason = " ".join(str(error).split())[:120] or type(error).__name__
        raise FileProblem(f"{path}: {reason} – give paths, polygons, rectangles or circles") from error
    warn_left_out(path, left_out_of(root) + Counter())
    return found


def _plain(path: Path, text: str) -> str:
    """The text, its entities no more than names of short texts, as Illustrator writes its name spaces."""
    declared = dict(re.findall(r"<!ENTITY\s+([\w.-]+)\s+[\"']([^\"']*)[\"']\s*>", text))
    grown = sum(len(value) * text.count(f"&{name};") for name, value in declared.items())
    others = text.count("<!ENTITY") - len(declared)
    if others or grown > 1_000_000 or any("&" in value or "%" in value for value in declared.values()):
        raise FileProblem(f"{path}: declares entities within entities – save it as plain SVG without them")
    return text


def _drawing(root: ElementTree.Element, metres: float | None) -> Any:
    """The drawing in CSS pixels, the size of its own viewport worked out here, to the last bit."""
    from svgelements import SVG

    box = [float(v) for v in re.split(r"[\s,]+", root.get("viewBox", "").strip()) if v]
    width = root.get("width", "").strip()
    unit = 1.0 if metres is None else metres / PIXEL
    if metres is None and len(box) == 4 and box[2] > 0 and width and not width.endswith("%"):
        unit = _pixels(width) / box[2]
    height = root.get("height", "").strip()
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
    root.set("height", repr(box[3] * unit))
    root.set("preserveAspectRatio", "none")
    return SVG.parse(StringIO(ElementTree.tostring(root, "unicode")), reify=True, ppi=96)


def _pixels(text: str) -> float:
    """A length in CSS pixels; raises ValueError."""
    match = re.fullmatch(rf"\s*({NUMBER.pattern})\s*([a-z]*)\s*", text)
    if match is None or match[2] not in LENGTHS:
        raise ValueError(f"length {text[:30]!r} is not a number with a unit such as mm")
    if not (pixels := float(match[1]) * LENGTHS[match[2]]) > 0:
        raise ValueError(f"width {text[:30]!r} is not positive")
    return pixels


def _strokes(drawing: Any) -> Iterator[Stroke]:
    """Lines of every shape, with the names and the paint of the groups around."""
    from svgelements import Path as Curves
    from svgelements import Shape as Drawn
    from svgelements import Use

    waiting = [(child, (), (), {}) for child in reversed(drawing)]
    while waiting:
        element, groups, said, paint = waiting.pop()
        paint = {**paint, **_paint(element)}
        if isinstance(element, Drawn):
            yield from _shape(element, Curves(element).reify(), groups, said, paint)
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
