"""Outlines from SVG: paths, polygons, polylines, rectangles, circles and ellipses, with transforms and units.

Closed shapes are contours (the largest is the outline, the others are holes), open ones are inner lines; a path or
polyline that ends where it began is closed too. Lengths are
millimetres unless width and viewBox say otherwise; user units without them are CSS pixels (96 to the inch).
"""

import re
from collections.abc import Iterator
from math import cos, radians, sin, tan
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from sim_core.errors import FileProblem
from sim_core.mesh.curves import arc_points, bezier_points
from sim_core.reading import read_text

__all__ = ["read_svg"]

UNITS = {
    "mm": 1e-3,
    "cm": 1e-2,
    "m": 1.0,
    "in": 0.0254,
    "pt": 0.0254 / 72,
    "pc": 0.0254 / 6,
    "px": 0.0254 / 96,
    "": 0.0254 / 96,
}
NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
FLAGS = re.compile(r"\s*,?\s*([01])\s*,?\s*([01])")  # of an arc; they may stand without a space between
TOKENS = re.compile(r"[MmLlHhVvCcSsQqTtAaZz]|[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
COUNTS = {"M": 2, "L": 2, "H": 1, "V": 1, "C": 6, "S": 4, "Q": 4, "T": 2, "A": 7}
HIDDEN = {"defs", "symbol", "clipPath", "mask", "pattern", "marker"}


def read_svg(path: Path) -> list[tuple[np.ndarray, bool]]:
    """The shapes of an SVG file as (points (n, 2) [m], closed). Raises FileProblem."""
    text = read_text(path, "an outline drawn as SVG")
    if "<!ENTITY" in text:
        raise FileProblem(f"{path}: declares entities – save it as plain SVG without them")
    try:
        root = ElementTree.fromstring(text)
    except (ElementTree.ParseError, ValueError) as error:
        raise FileProblem(f"{path}: not valid SVG ({error}) – give an outline drawn as SVG") from error
    if _tag(root) != "svg":
        raise FileProblem(f"{path}: its root is <{_tag(root)[:40]}> – give an outline drawn as SVG")
    try:
        scale = _scale(root)
        with np.errstate(all="ignore"):  # what leaves the range is told by whoever sorts the lines
            return [(points * scale, closed) for points, closed in _shapes(root, np.eye(3))]
    except RecursionError as error:
        raise FileProblem(f"{path}: groups nested too deep – take shapes out of their groups") from error
    except (ValueError, IndexError, OverflowError) as error:
        raise FileProblem(f"{path}: {error} – give paths, polygons, rectangles or circles") from error


def _tag(element) -> str:
    return element.tag.rsplit("}", 1)[-1] if isinstance(element.tag, str) else ""


def _length(text: str) -> float:
    """A length with unit in metres."""
    match = re.fullmatch(rf"\s*({NUMBER.pattern})\s*([a-z]*)\s*", text)
    if match is None or match[2] not in UNITS:
        raise ValueError(f"length {text[:30]!r} is not a number with a unit such as mm")
    return float(match[1]) * UNITS[match[2]]


def _scale(root) -> float:
    """Metres a user unit."""
    box = [float(v) for v in NUMBER.findall(root.get("viewBox", ""))]
    width = root.get("width", "")
    if len(box) == 4 and box[2] > 0 and width and not width.strip().endswith("%"):
        if (metres := _length(width)) <= 0:
            raise ValueError(f"width {width[:30]!r} is not positive")
        return metres / box[2]
    return UNITS["px"]


def _shapes(element, frame: np.ndarray) -> Iterator[tuple[np.ndarray, bool]]:
    tag = _tag(element)
    if tag in HIDDEN:
        return
    frame = frame @ _transform(element.get("transform", ""))
    for points, closed in _drawn(element, tag):
        if len(points) > 1:
            if len(points) > 3 and np.array_equal(points[0], points[-1]):
                points, closed = points[:-1], True
            yield points @ frame[:2, :2].T + frame[:2, 2], closed
    for child in element:
        yield from _shapes(child, frame)


def _drawn(element, tag: str) -> list[tuple[np.ndarray, bool]]:
    def value(name: str) -> float:
        text = element.get(name, "0")
        return _length(text) / UNITS["px"] if re.search("[a-z]", text) else float(text)

    if tag == "path":
        return _path(element.get("d", ""))
    if tag in ("polygon", "polyline"):
        numbers = [float(v) for v in NUMBER.findall(element.get("points", ""))]
        return [(np.array(numbers[: len(numbers) // 2 * 2]).reshape(-1, 2), tag == "polygon")]
    if tag == "line":
        return [(np.array([[value("x1"), value("y1")], [value("x2"), value("y2")]]), False)]
    if tag == "rect":
        x, y, w, h = (value(name) for name in ("x", "y", "width", "height"))
        rx, ry = (value(name if element.get(name) else other) for name, other in (("rx", "ry"), ("ry", "rx")))
        return [(_rectangle(x, y, w, h, min(rx, w / 2), min(ry, h / 2)), True)]
    if tag in ("circle", "ellipse"):
        rx, ry = (value("r"),) * 2 if tag == "circle" else (value("rx"), value("ry"))
        turn = np.arange(256) * 2 * np.pi / 256
        return [(np.column_stack([value("cx") + rx * np.cos(turn), value("cy") + ry * np.sin(turn)]), True)]
    return []


def _rectangle(x: float, y: float, w: float, h: float, rx: float, ry: float) -> np.ndarray:
    """Corners of a rectangle, rounded by quarters of an ellipse where both radii are positive."""
    if rx <= 0 or ry <= 0:
        return np.array([[x, y], [x + w, y], [x + w, y + h], [x, y + h]])
    found = []
    for turn, (cx, cy) in enumerate(
        ((x + w - rx, y + ry), (x + w - rx, y + h - ry), (x + rx, y + h - ry), (x + rx, y + ry))
    ):
        t = (np.linspace(0, 1, 33) + turn - 1) * np.pi / 2
        found.append(np.column_stack([cx + rx * np.cos(t), cy + ry * np.sin(t)]))
    return np.concatenate(found)


def _transform(text: str) -> np.ndarray:
    frame = np.eye(3)
    for name, inner in re.findall(r"([a-zA-Z]+)\s*\(([^)]*)\)", text):
        v = [float(n) for n in NUMBER.findall(inner)]
        step = np.eye(3)
        if name == "matrix" and len(v) == 6:
            step[:2] = [[v[0], v[2], v[4]], [v[1], v[3], v[5]]]
        elif name == "translate" and v:
            step[:2, 2] = v[0], v[1] if len(v) > 1 else 0
        elif name == "scale" and v:
            step[0, 0], step[1, 1] = v[0], v[-1]
        elif name == "rotate" and v:
            c, s = cos(radians(v[0])), sin(radians(v[0]))
            x, y = v[1:3] if len(v) > 2 else (0.0, 0.0)
            step[:2] = [[c, -s, x - c * x + s * y], [s, c, y - s * x - c * y]]
        elif name in ("skewX", "skewY") and v:
            step[(0, 1) if name == "skewX" else (1, 0)] = tan(radians(v[0]))
        else:
            raise ValueError(f"transform {name[:20]}({inner[:30]}) cannot be read")
        frame = frame @ step
    return frame


def _tokens(text: str) -> list[str]:
    """Command letters and numbers of path data; the flags of an arc are single digits, however close they stand."""
    found: list[str] = []
    at, kind, count = 0, "", 0
    while at < len(text):
        if kind == "A" and count % 7 == 3 and (flags := FLAGS.match(text, at)):
            found += flags.groups()
            at, count = flags.end(), count + 2
            continue
        match = TOKENS.search(text, at)
        if match is None:
            break
        found.append(match[0])
        at = match.end()
        kind, count = (match[0].upper(), 0) if match[0].isalpha() else (kind, count + 1)
    return found


def _path(text: str) -> list[tuple[np.ndarray, bool]]:
    """The subpaths of path data as polylines, curves in short steps."""
    tokens = _tokens(text)
    found: list[tuple[np.ndarray, bool]] = []
    points: list[np.ndarray] = []
    here, before, command, k = np.zeros(2), None, "", 0
    while k < len(tokens):
        if tokens[k].isalpha():
            command, k = tokens[k], k + 1
            if command in "Zz":
                if points:
                    found.append((np.array(points), True))
                    here, points = points[0], []
                continue
        kind = command.upper()
        if kind not in COUNTS or k + COUNTS[kind] > len(tokens):
            raise ValueError(f"path data end within {command or 'a number'!r}")
        v = [float(t) for t in tokens[k : k + COUNTS[kind]]]
        k += COUNTS[kind]
        if kind == "M":
            if len(points) > 1:
                found.append((np.array(points), False))
            here = np.array(v) + (here if command == "m" else 0)
            points, before, command = [here], None, "l" if command == "m" else "L"
            continue
        if not points:
            points = [here]
        steps, before = _piece(kind, v, here, here if command.islower() else np.zeros(2), before)
        points.extend(steps)
        here = points[-1]
    if len(points) > 1:
        found.append((np.array(points), False))
    return found


def _piece(kind: str, v: list[float], here, origin, before):
    """Points after `here` for one path command, and (kind, control point) for a smooth successor."""
    if kind in "HV":
        end = here.copy()
        end["HV".index(kind)] = v[0] + origin["HV".index(kind)]
        return [end], None
    if kind == "L":
        return [np.array(v) + origin], None
    if kind == "A":
        return arc_points(here, v[:2], v[2], v[3] != 0, v[4] != 0, np.array(v[5:]) + origin), None
    given = [np.array(v[i : i + 2]) + origin for i in range(0, len(v), 2)]
    family = "C" if kind in "CS" else "Q"
    if kind in "ST":
        mirrored = 2 * here - before[1] if before is not None and before[0] == family else here
        given = [mirrored, *given]
    return bezier_points([here, *given]), (family, given[-2])
