"""How much a drawing draws: bounded, since little text may draw without end.

Counted are elements, each as often as it is drawn: by `<use>`, by patterns for all that they paint, by markers for all
corners they stand at, by masks and clips; long lines, texts, dashes and see-through groups count as several.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import hypot
from xml.etree.ElementTree import Element

from hall_app.house.drafts.drawing.styles import REFERENCE

__all__ = ["MOST_DEEP", "MOST_DRAWN", "draws_too_much"]

MOST_DEEP = 120
MOST_DRAWN = 100_000
_LINE, _LETTERS, _DASHES = (
    128,
    8,
    64,
)  # characters of a path, letters and dashes that count as one more element
_LAYER = 40  # what a group counts that is drawn by itself before it is laid over what is below
_STOPS = 8  # of a gradient, that count as an element for each that it paints

_GRADIENTS = frozenset(("linearGradient", "radialGradient"))
_PAINTS, _MARKERS = (
    frozenset(("fill", "stroke")),
    frozenset(("marker", "marker-start", "marker-mid", "marker-end")),
)
_SIDES = "x y x1 y1 x2 y2 cx cy r rx ry width height".split()
_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?", re.IGNORECASE)
_COMMAND = re.compile(r"([a-z])([^a-df-z]*)", re.IGNORECASE)

Told = Mapping[Element, list[tuple[str, str]]]  # element -> all that is said of it, property and value


@dataclass(frozen=True)
class _Drawn:
    """elements: drawn at and below an element, what it uses included; corners: of their lines; cost: what all of it
    draws, paints included."""

    elements: int = 0
    corners: int = 0
    cost: int = 0

    def __add__(self, other: _Drawn) -> _Drawn:
        sums = (self.elements + other.elements, self.corners + other.corners, self.cost + other.cost)
        return _Drawn(*(min(one, MOST_DRAWN + 1) for one in sums))


def draws_too_much(root: Element, told: Told) -> bool:
    """Whether it draws more than MOST_DRAWN elements, or in a circle. told: of elements that anything is said of."""
    try:
        return _Counting(root, told).of(root).cost > MOST_DRAWN
    except _InACircle:
        return True


class _InACircle(Exception):
    pass


class _Counting:
    def __init__(self, root: Element, told: Told) -> None:
        self._told = told
        self._by_id: dict[str, Element] = {}
        for one in root.iter():
            self._by_id.setdefault(one.get("id", ""), one)  # of two of one name browsers take the first
        self._above = {child: one for one in root.iter() for child in one}
        self._dash = min(filter(None, map(self._dash_of, root.iter())), default=0.0)
        self._known: dict[Element, _Drawn] = {}
        self._within: set[Element] = set()

    def of(self, element: Element) -> _Drawn:
        if (known := self._known.get(element)) is not None:
            return known
        if element in self._within or len(self._within) > 2 * MOST_DEEP:
            raise _InACircle
        self._within.add(element)
        drawn = self._alone(element)
        for child in element:
            drawn += self.of(child)
        said = self._told.get(element, [])
        for one in self._targets("href", element.get("href", "")):
            drawn += self._called(one)
        drawn += _Drawn(cost=sum(self._paint(key, value, drawn) for key, value in said))
        if len(element) and any(map(_is_layer, said)):
            drawn += _Drawn(cost=_LAYER)
        self._within.discard(element)
        self._known[element] = drawn
        return drawn

    def _alone(self, element: Element) -> _Drawn:
        line = element.get("d", "") or element.get("points", "")
        letters = len((element.text or "").strip()) + sum(len((one.tail or "").strip()) for one in element)
        dashes = int(_length(element) / self._dash / _DASHES) if self._dash else 0
        own = 1 + len(line) // _LINE + letters // _LETTERS + dashes
        return _Drawn(own, len(_NUMBER.findall(line)) + 4 * (element.tag == "line"), own)

    def _paint(self, key: str, value: str, below: _Drawn) -> int:
        cost = 0
        for one in self._targets(key, value):
            painted = self._called(one).cost
            cost += painted // _STOPS if one.tag in _GRADIENTS else painted
        if key in _PAINTS:  # handed down to all that is below
            return cost * below.elements
        if key in _MARKERS:
            return cost * (below.corners if key in ("marker", "marker-mid") else 2 * below.elements)
        return cost

    def _called(self, target: Element) -> _Drawn:
        """What is drawn from elsewhere is painted by what it lies in, too."""
        drawn = self.of(target)
        if target.tag in _GRADIENTS:
            return drawn
        above = self._above.get(target)
        while above is not None:
            if above not in self._within:
                drawn += _Drawn(cost=sum(self._paint(*said, drawn) for said in self._told.get(above, [])))
            above = self._above.get(above)
        return drawn

    def _targets(self, key: str, value: str) -> Iterator[Element]:
        names = [value[1:]] if key == "href" and value.startswith("#") else REFERENCE.findall(value)
        for name in names:
            if (target := self._by_id.get(name)) is not None:
                yield target

    def _dash_of(self, element: Element) -> float:
        """The length of a dash with its gap, the shortest that is said of the element; 0: none is."""
        said = (value for key, value in self._told.get(element, []) if key == "stroke-dasharray")
        sums = (sum(map(float, _NUMBER.findall(value))) for value in said)
        return min((one for one in sums if one > 0.0), default=0.0)


def _is_layer(said: tuple[str, str]) -> bool:
    key, value = said
    plain = {"mix-blend-mode": "normal", "isolation": "auto", "mask": "none"}
    return key in plain and value != plain[key] or (key == "opacity" and value not in ("1", "1.0", "100%"))


def _length(element: Element) -> float:
    """How long the lines of a shape are at most, as its numbers say."""
    if element.tag in ("polyline", "polygon"):
        return _steps(list(map(float, _NUMBER.findall(element.get("points", "")))), closed=True)
    if element.tag == "path":
        return _path_length(element.get("d", ""))
    numbers = (_NUMBER.match(element.get(side, "")) for side in _SIDES)
    return 4.0 * sum(abs(float(one[0])) for one in numbers if one)


def _path_length(path: str) -> float:
    """By the corners of what controls it; an arc is no longer than its ellipse."""
    total, absolute = 0.0, list[float]()
    for command, rest in _COMMAND.findall(path):
        numbers = list(map(float, _NUMBER.findall(rest)))
        if command in "aA":
            total += 7.0 * sum(map(abs, numbers[0::7] + numbers[1::7]))
            numbers = [one for k, one in enumerate(numbers) if k % 7 > 4]
        if command in "HhVv":
            total += 2.0 * sum(map(abs, numbers))
        elif command.islower():
            total += 2.0 * sum(map(abs, numbers))
        else:
            absolute += numbers[: len(numbers) // 2 * 2]
    return total + 2.0 * _steps(absolute, closed=True)


def _steps(numbers: list[float], *, closed: bool) -> float:
    points = list(zip(numbers[0::2], numbers[1::2], strict=False))
    if closed and points:
        points.append(points[0])
    return sum(hypot(b[0] - a[0], b[1] - a[1]) for a, b in zip(points, points[1:], strict=False))
