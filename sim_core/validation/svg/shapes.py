"""Shapes of an SVG drawing as polylines in CSS pixels, read by svgelements: paths, transforms, units, viewports.

What it is handed has been decoded, checked and bounded before (`tree.py`).
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from io import StringIO
from itertools import pairwise
from typing import Any
from xml.etree import ElementTree

import numpy as np

from sim_core.validation.svg.tree import LENGTHS, NUMBER, flatten_viewports

__all__ = ["PIXEL", "curves_of", "drawing_of", "polylines"]

PIXEL = 0.0254 / 96  # [m]
SAME = 0.01  # most by which width and height of one scale differ, as sizes are rounded
STEPS, TURN = 24, 0.05  # of a curve piece; [rad] most of an arc in one step
RIGHT = 1e-9  # [rad] by which the axes of an arc may miss their right angle
Shape = tuple[np.ndarray, bool]


def drawing_of(root: ElementTree.Element, metres: float | None) -> tuple[Any, bool]:
    """The drawing as svgelements has it, in CSS pixels, and whether its unit is a guess.

    The size of its own viewport is worked out here, to the last bit. metres: of a user unit; without it the drawing's
    size counts, and without that a user unit is a CSS pixel (FreeSewing: a millimetre). Raises ValueError.
    """
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


def curves_of(element: Any) -> Any:
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


def polylines(curves: Any) -> Iterator[Shape]:
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
