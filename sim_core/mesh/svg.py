"""Outlines from SVG: paths, polygons, polylines, rectangles, circles and ellipses, with transforms and units.

What <use> names is drawn where it is used, nested <svg> and <symbol> in their viewports; what is hidden, text and
pictures are left out with an OutlineWarning that names them.

Closed shapes are contours (the largest is the outline, the others are holes), open ones are inner lines; a path or
polyline that ends where it began is closed too. Lengths are
millimetres unless width and viewBox say otherwise; user units without them are CSS pixels (96 to the inch).
"""

import re
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from sim_core.errors import FileProblem
from sim_core.mesh.left_out import visited, warn_left_out
from sim_core.mesh.svg_frames import NUMBER, shifted, transform_frame, viewport_frame
from sim_core.mesh.svg_paths import path_lines
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
HIDDEN = {"defs", "symbol", "clipPath", "mask", "pattern", "marker"}
UNREAD = {"text", "image", "foreignObject"}
NOWHERE = (np.nan, np.nan)

Size = tuple[float, float]
Line = tuple[np.ndarray, bool]


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
            walk, box = _Walk(root), [float(v) for v in NUMBER.findall(root.get("viewBox", ""))]
            size = (box[2], box[3]) if len(box) == 4 else _pair(root, ("width", "height"), NOWHERE, NOWHERE)
            found = [
                (points * scale, closed) for points, closed in walk.shapes(root, np.eye(3), size, root=True)
            ]
    except RecursionError as error:
        raise FileProblem(f"{path}: groups nested too deep – take shapes out of their groups") from error
    except (ValueError, IndexError, OverflowError) as error:
        raise FileProblem(f"{path}: {error} – give paths, polygons, rectangles or circles") from error
    warn_left_out(path, walk.left_out)
    return found


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


class _Walk:
    """A way through a drawing, <use> followed to what it names."""

    def __init__(self, root) -> None:
        self.named = {name: element for element in root.iter() if (name := element.get("id"))}
        self.left_out: Counter[str] = Counter()
        self.visits = 0

    def shapes(
        self, element, frame: np.ndarray, size: Size, seen=True, uses=(), root=False
    ) -> Iterator[Line]:
        """Lines of an element and what it holds. size: of the viewport.  seen: by its visibility.  uses: names
        followed.  root: the outermost <svg>."""
        tag = _tag(element)
        self.visits = visited(self.visits)
        if tag in HIDDEN:
            return
        if tag in UNREAD or (tag == "style" and "display" in "".join(element.itertext())):
            self.left_out[f"<{tag}>"] += 1
            return
        if _styled(element, "display") == "none":
            self.left_out["hidden (display: none)"] += 1
            return
        if element.get("clip-path"):
            self.left_out["clip-path"] += 1
        if visibility := _styled(element, "visibility"):
            seen = visibility not in ("hidden", "collapse")
        frame = frame @ transform_frame(element.get("transform", ""))
        if tag == "use":
            yield from self._used(element, frame, size, seen, uses)
            return
        if tag == "svg" and not root:
            frame = frame @ shifted(*_pair(element, ("x", "y"), size, (0.0, 0.0)))
            inner = _pair(element, ("width", "height"), size, size)
            frame, size = self._viewport(element, frame, inner)
        for points, closed in _drawn(element, tag):
            if not seen:
                self.left_out["hidden (visibility)"] += 1
            elif len(points) > 1:
                if len(points) > 3 and np.array_equal(points[0], points[-1]):
                    points, closed = points[:-1], True
                yield points @ frame[:2, :2].T + frame[:2, 2], closed
        for child in element:
            yield from self.shapes(child, frame, size, seen, uses)

    def _used(self, element, frame, size: Size, seen: bool, uses) -> Iterator[Line]:
        name = next((text for key, text in element.items() if key.rsplit("}", 1)[-1] == "href"), "")
        target = self.named.get(name.removeprefix("#")) if name.startswith("#") else None
        if target is None:
            self.left_out[f"<use> of {name or 'nothing'}"] += 1
            return
        if name in uses:
            raise ValueError(f"<use> of {name[:40]} within itself")
        frame = frame @ shifted(*_pair(element, ("x", "y"), size, (0.0, 0.0)))
        if _tag(target) != "symbol":
            yield from self.shapes(target, frame, size, seen, (*uses, name))
            return
        frame = frame @ transform_frame(target.get("transform", ""))
        frame, size = self._viewport(target, frame, _pair(element, ("width", "height"), size, size))
        for child in target:
            yield from self.shapes(child, frame, size, seen, (*uses, name))

    def _viewport(self, element, frame, size: Size) -> tuple[np.ndarray, Size]:
        inner, size = viewport_frame(element.get("viewBox", ""), element.get("preserveAspectRatio", ""), size)
        return frame @ inner, size


def _styled(element, name: str) -> str:
    """A property by its attribute or in the style attribute, which counts for more."""
    found = re.search(rf"(?:^|;)\s*{name}\s*:\s*([a-z]+)", element.get("style", ""))
    return found[1] if found else element.get(name, "").strip()


def _pair(element, names: tuple[str, str], size: Size, missing: Size) -> Size:
    """Two lengths in user units; a percentage is of the viewport's size."""
    found = []
    for name, whole, default in zip(names, size, missing, strict=True):
        text = element.get(name, "").strip()
        if not text or text == "auto":
            found.append(default)
        elif text.endswith("%"):
            found.append(whole * float(text[:-1]) / 100)
        else:
            found.append(_length(text) / UNITS["px"])
    return found[0], found[1]


def _drawn(element, tag: str) -> list[tuple[np.ndarray, bool]]:
    def value(name: str) -> float:
        text = element.get(name, "0")
        return _length(text) / UNITS["px"] if re.search("[a-z]", text) else float(text)

    if tag == "path":
        return path_lines(element.get("d", ""))
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
