"""Nested viewports of an SVG file as groups: `<svg>` within `<svg>`, `<use>` of a `<symbol>` (SVG 2, chapter 8).

svgelements 1.9.6 moves a nested `<svg>` twice and draws a `<symbol>` where it is declared, so both are worked out here.
"""

import re
from copy import deepcopy
from xml.etree import ElementTree

import numpy as np

__all__ = ["LENGTHS", "NUMBER", "flatten_viewports"]

NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
LENGTHS = {
    "": 1,
    "px": 1,
    "mm": 96 / 25.4,
    "cm": 960 / 25.4,
    "m": 96000 / 25.4,
    "in": 96,
    "pt": 4 / 3,
    "pc": 16,
    "q": 24 / 25.4,
}
ALIGNED = {"Min": 0.0, "Mid": 0.5, "Max": 1.0}
PLACED = ("x", "y", "width", "height", "viewBox", "preserveAspectRatio", "transform")

Size = tuple[float, float]


def flatten_viewports(root: ElementTree.Element, size: Size) -> None:
    """Turn nested viewports into groups, in place. size: of the outermost one, in user units. Raises ValueError."""
    space = root.tag[: root.tag.rfind("}") + 1]
    named = {name: element for element in root.iter() if (name := element.get("id"))}
    _flatten(root, size, space, named)
    for parent in list(root.iter()):
        for child in [child for child in parent if child.tag == f"{space}symbol"]:
            parent.remove(child)


def _flatten(
    element: ElementTree.Element, size: Size, space: str, named: dict[str, ElementTree.Element]
) -> None:
    for k, child in enumerate(list(element)):
        inner = size
        if child.tag == f"{space}symbol":
            continue
        if child.tag == f"{space}svg":
            child, inner = _group(child, child, size, space)
            element[k] = child
        elif child.tag == f"{space}use":
            name = next((text for key, text in child.items() if key.rsplit("}", 1)[-1] == "href"), "")
            symbol = named.get(name.removeprefix("#"))
            if symbol is not None and symbol.tag == f"{space}symbol":
                child, inner = _group(child, deepcopy(symbol), size, space)
                element[k] = child
        _flatten(child, inner, space, named)


def _group(placed: ElementTree.Element, held: ElementTree.Element, size: Size, space: str):
    """A group with the children of `held`, standing where `placed` puts its viewport; and the size in it."""
    x, y = _pair(placed, ("x", "y"), size, (0.0, 0.0))
    width = _pair(placed, ("width", "height"), size, size)
    scale, shift, inner = _viewport(held.get("viewBox", ""), held.get("preserveAspectRatio", ""), width)
    frame = f"matrix({scale[0]!r} 0 0 {scale[1]!r} {x + shift[0]!r} {y + shift[1]!r})"
    before = [placed.get("transform", ""), frame, held.get("transform", "") if held is not placed else ""]
    kept = {key: value for key, value in placed.items() if key not in PLACED and not key.endswith("href")}
    if held is not placed and "id" in held.keys():  # noqa: SIM118 - an element, no mapping
        kept["data-symbol"] = held.get("id", "")  # tells letters that a printer drew from pieces
    group = ElementTree.Element(f"{space}g", {**kept, "transform": " ".join(filter(None, before))})
    group.extend(list(held))
    return group, inner


def _viewport(view_box: str, aspect: str, size: Size) -> tuple[list[float], list[float], Size]:
    """Scale and shift from a viewBox to a viewport of `size`, and the size in its units."""
    box = [float(v) for v in NUMBER.findall(view_box)]
    if len(box) != 4:
        return [1.0, 1.0], [0.0, 0.0], size
    if not (box[2] > 0 and box[3] > 0 and np.isfinite(size).all()):
        raise ValueError(f"viewBox {view_box[:40]!r} of a nested drawing without a size")
    scale = np.array(size) / box[2:]
    words = (aspect.split() or ["xMidYMid"])[:2]
    found = re.fullmatch(r"x(Min|Mid|Max)Y(Min|Mid|Max)", words[0])
    if words[0] != "none":
        scale[:] = scale.max() if words[1:] == ["slice"] else scale.min()
    align = np.array([ALIGNED[k] for k in found.groups()]) if found else np.zeros(2)
    shift = align * (size - scale * box[2:]) - scale * box[:2]
    return scale.tolist(), shift.tolist(), (box[2], box[3])


def _pair(element: ElementTree.Element, names: tuple[str, str], size: Size, missing: Size) -> Size:
    """Two lengths in user units; a percentage is of the viewport's size."""
    found = []
    for name, whole, default in zip(names, size, missing, strict=True):
        text = element.get(name, "").strip()
        number = re.fullmatch(rf"({NUMBER.pattern})\s*([a-z%]*)", text.lower())
        if not text or text == "auto":
            found.append(default)
        elif number is None or number[2] not in (*LENGTHS, "%"):
            raise ValueError(f"length {text[:30]!r} is not a number with a unit such as mm")
        else:
            found.append(float(number[1]) * (whole / 100 if number[2] == "%" else LENGTHS[number[2]]))
    return found[0], found[1]
