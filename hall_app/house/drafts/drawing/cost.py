"""How much a drawing draws: bounded, since little text may draw without end.

Counted are elements, each as often as it is drawn: by `<use>`, by patterns for all that they paint, by markers for all
corners they stand at, by masks and clips; long lines, texts, dashes and see-through groups count as several.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import hypot, inf
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
_SIDE = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?)\s*(%|[a-z]*)", re.IGNORECASE)
_UNITS = {"": 1.0, "px": 1.0, "pt": 1.4, "pc": 16.0, "mm": 3.8, "cm": 38.0, "in": 96.0}
_PAIRS = {"q": 2, "s": 2, "c": 3}  # of a segment's numbers
_PLAIN = {"mix-blend-mode": "normal", "isolation": "auto", "mask": "none"}
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


_ONE = _Drawn(1, 1, 1)


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
        self._frame = max(map(_largest, root.iter()), default=0.0) if self._dash else 0.0
        self._within: set[Element] = set()
        self._known: dict[Element, _Drawn] = {}
        self._elsewhere: dict[Element, _Drawn | None] = {}
        # The most that a paint draws which markers take over from the line they stand at.
        self._taken_over = 0
        if any("context-" in value for said in told.values() for _, value in said):
            paints = (said for one in told.values() for said in one if said[0] in _PAINTS)
            self._taken_over = max((self._paint(*said, _ONE) for said in paints), default=0)

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
        drawn += _Drawn(cost=_LAYER * sum(self._is_layer(element, *one) for one in said))
        self._within.discard(element)
        self._known[element] = drawn
        return drawn

    def _alone(self, element: Element) -> _Drawn:
        line = element.get("d", "") or element.get("points", "")  # a browser draws but the one its kind has
        letters = len((element.text or "").strip()) + sum(len((one.tail or "").strip()) for one in element)
        dashes = 0
        if self._dash:
            count = _length(element, self._frame) / self._dash / _DASHES
            dashes = int(count) if count < MOST_DRAWN else MOST_DRAWN + 1  # what is no number, too
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
            places = below.corners if key in ("marker", "marker-mid") else 2 * below.elements
            return cost * places * (1 + self._taken_over)
        return cost

    def _called(self, target: Element) -> _Drawn:
        """What is drawn from elsewhere is painted by what it lies in, too."""
        if target in self._elsewhere:
            if (known := self._elsewhere[target]) is None:
                raise _InACircle
            return known
        self._elsewhere[target] = None
        drawn = self.of(target)
        above = self._above.get(target) if target.tag not in _GRADIENTS else None
        while above is not None:
            if above not in self._within:
                handed = [said for said in self._told.get(above, []) if said[0] in _PAINTS | _MARKERS]
                drawn += _Drawn(cost=sum(self._paint(*said, drawn) for said in handed))
            above = self._above.get(above)
        self._elsewhere[target] = drawn
        return drawn

    def _is_layer(self, element: Element, key: str, value: str) -> bool:
        """Whether the element is drawn by itself before it is laid over what is below."""
        if key == "opacity":
            return value not in ("1", "1.0", "100%") and (len(element) > 0 or element.tag == "use")
        if (
            key == "clip-path"
        ):  # a shape is cut by another as it is drawn, but for letters and what is cut itself
            inside = [one for target in self._targets(key, value) for one in target.iter()]
            return any(one.tag in ("text", "use") or _says(self._told, one, key) for one in inside)
        return key in _PLAIN and value != _PLAIN[key]

    def _targets(self, key: str, value: str) -> Iterator[Element]:
        names = [value[1:]] if key == "href" and value.startswith("#") else REFERENCE.findall(value)
        for name in names:
            if (target := self._by_id.get(name)) is not None:
                yield target

    def _dash_of(self, element: Element) -> float:
        """The length of a dash with its gap, the shortest that is said of the element; 0: none is."""
        found = [_numbers(value) for value in _says(self._told, element, "stroke-dasharray")]
        return min((2.0 * sum(one) / len(one) for one in found if sum(one) > 0.0), default=0.0)


def _says(told: Told, element: Element, key: str) -> list[str]:
    return [value for name, value in told.get(element, []) if name == key]


def _numbers(text: str) -> list[float]:
    return list(map(float, _NUMBER.findall(text)))


def _largest(element: Element) -> float:
    """The largest number of a frame, of which shares may be asked."""
    return max(
        _numbers(" ".join(element.get(side, "") for side in ("viewBox", "width", "height"))), default=0.0
    )


def _length(element: Element, frame: float) -> float:
    """How long the lines of a shape are at most. frame: what a share is of."""
    if element.tag in ("polyline", "polygon"):
        return _path_length(f"M{element.get('points', '')}Z")
    if element.tag == "path":
        return _path_length(element.get("d", ""))
    sides = filter(None, (_SIDE.match(element.get(side, "").strip()) for side in _SIDES))
    units = _UNITS | {"%": frame / 100.0}
    return 4.0 * sum(abs(float(one[1])) * units.get(one[2].lower(), 1e6) for one in sides)


def _path_length(path: str) -> float:
    """By the corners of what controls it; infinite where they go by what went before, or are run together."""
    total = x = y = first_x = first_y = 0.0
    for command, rest in _COMMAND.findall(path):
        kind, relative, numbers = command.lower(), command.islower(), _numbers(rest)
        if kind == "z":
            total += hypot(x - first_x, y - first_y)
            x, y = first_x, first_y
        elif kind == "h":
            for one in numbers:
                total, x = total + abs(one if relative else one - x), x + one if relative else one
        elif kind == "v":
            for one in numbers:
                total, y = total + abs(one if relative else one - y), y + one if relative else one
        elif kind == "a":
            if len(numbers) % 7 or any(one not in (0.0, 1.0) for one in numbers[3::7] + numbers[4::7]):
                return inf
            for k in range(0, len(numbers), 7):
                new_x, new_y = numbers[k + 5] + x * relative, numbers[k + 6] + y * relative
                total += 7.0 * (abs(numbers[k]) + abs(numbers[k + 1])) + 4.0 * hypot(new_x - x, new_y - y)
                x, y = new_x, new_y
        elif kind == "t":
            return inf
        else:
            step = 2 * _PAIRS.get(kind, 1)
            for k in range(0, len(numbers) - step + 1, step):
                last_x, last_y = x, y
                for pair in range(k, k + step, 2):
                    new_x, new_y = numbers[pair] + x * relative, numbers[pair + 1] + y * relative
                    total += 2.0 * hypot(new_x - last_x, new_y - last_y)
                    last_x, last_y = new_x, new_y
                x, y = last_x, last_y
                if kind == "m" and k == 0:
                    first_x, first_y = x, y
    return total
