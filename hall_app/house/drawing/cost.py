"""How much a drawing draws: bounded, since little text may draw without end.

Counted are elements, each as often as it is drawn: by `<use>`, by patterns for all that they paint, by markers for all
corners they stand at, by masks and clips; long lines, texts, dashes and see-through groups count as several.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from xml.etree.ElementTree import Element

from hall_app.house.drawing.dashes import Told, dashes_along
from hall_app.house.drawing.outlines import corners, letters
from hall_app.house.drawing.styles import REFERENCE

__all__ = ["MOST_DEEP", "MOST_DRAWN", "draws_too_much"]

MOST_DEEP = 120
MOST_DRAWN = 100_000
_LINE, _LETTERS, _DASHES = 128, 8, 64  # characters of a path, letters and dashes: one more element
# What a group counts that is drawn by itself before it is laid over what is below, and what hides parts of it.
_LAYER, _MASK = 100, 400
_STOPS = 8  # of a gradient, that count as an element for each that it paints

_GRADIENTS = frozenset(("linearGradient", "radialGradient"))
_PAINTS = frozenset(("fill", "stroke"))
_MARKERS = frozenset(("marker", "marker-start", "marker-mid", "marker-end"))
_HANDED = _PAINTS | _MARKERS  # down to all that is below
_PLAIN = {"mix-blend-mode": "normal", "isolation": "auto"}


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


@dataclass(frozen=True)
class _Paints:
    """What paints and markers draw for each element, at each corner and at each line's ends."""

    areas: int = 0
    corners: int = 0
    ends: int = 0

    def more(self, key: str, cost: int) -> _Paints:
        if key in _PAINTS:
            return replace(self, areas=self.areas + cost)
        if key in ("marker", "marker-mid"):
            return replace(self, corners=self.corners + cost)
        return replace(self, ends=self.ends + cost)


def draws_too_much(root: Element, told: Told, *, dashes: bool) -> bool:
    """Whether it draws more than MOST_DRAWN elements, or in a circle. told: of elements that anything is said of;
    dashes: whether they count."""
    try:
        return _Counting(root, told, dashes_along(root, told) if dashes else {}).of(root).cost > MOST_DRAWN
    except _Endless:
        return True


class _Endless(Exception):
    """It draws in a circle, or too much, whatever else it has."""


class _Counting:
    def __init__(self, root: Element, told: Told, dashes: Mapping[Element, float]) -> None:
        self._told, self._dashes = told, dashes
        self._by_id: dict[str, Element] = {}
        for one in root.iter():
            self._by_id.setdefault(one.get("id", ""), one)  # of two of one name browsers take the first
        self._above = {child: one for one in root.iter() for child in one}
        self._named: dict[tuple[bool, str], tuple[Element, ...]] = {}  # by what refers to them
        self._cutting: dict[Element, bool] = {}
        self._within: set[Element] = set()
        self._known: dict[Element, _Drawn] = {}
        self._elsewhere: dict[Element, _Drawn | None] = {}
        self._costs: dict[str, int] = {}  # of values
        self._hands: dict[Element, _Paints] = {}
        self._handing: dict[Element | None, tuple[Element, ...]] = {None: ()}
        # The most that a paint draws which markers take over from the line they stand at.
        self._taken_over = 0
        values = {value for said in told.values() for _, value in said}
        if any("context-" in value.lower() for value in values):
            paints = (said for one in told.values() for said in one if said[0] in _PAINTS)
            self._taken_over = max((self._paint(*said, _ONE) for said in paints), default=0)

    def of(self, element: Element) -> _Drawn:
        if (known := self._known.get(element)) is not None:
            return known
        if element in self._within or len(self._within) > 2 * MOST_DEEP:
            raise _Endless
        self._within.add(element)
        drawn = self._alone(element)
        for child in element:
            drawn += self.of(child)
            if drawn.cost > MOST_DRAWN:
                raise _Endless
        said = self._told.get(element, [])
        for one in self._targets("href", element.get("href", "")):
            drawn += self._called(one)
        drawn += _Drawn(cost=sum(self._paint(key, value, drawn) for key, value in said))
        drawn += _Drawn(cost=sum(self._layer(element, *one) for one in said))
        if drawn.cost > MOST_DRAWN:  # and so does all that it lies in
            raise _Endless
        self._within.discard(element)
        self._known[element] = drawn
        return drawn

    def _alone(self, element: Element) -> _Drawn:
        line = len(element.get("d", "")) + len(element.get("points", ""))
        count = self._dashes.get(element, 0.0) / _DASHES
        dashes = int(count) if count < MOST_DRAWN else MOST_DRAWN + 1  # what is no number, too
        own = 1 + line // _LINE + letters(element) // _LETTERS + dashes
        return _Drawn(own, corners(element), own)

    def _paint(self, key: str, value: str, below: _Drawn) -> int:
        if key in _HANDED:
            return self._painted(_Paints().more(key, self._once(key, value)), below)
        return self._once(key, value)

    def _painted(self, paints: _Paints, below: _Drawn) -> int:
        places = paints.corners * max(1, below.corners) + paints.ends * max(1, 2 * below.elements)
        return paints.areas * below.elements + places * (1 + self._taken_over)

    def _once(self, key: str, value: str) -> int:
        """What a value draws where it is asked for once; programs say the same of many elements."""
        if (known := self._costs.get(value)) is not None:
            return known
        cost = 0
        for one in self._targets(key, value):
            drawn = self._called(one).cost
            cost += max(1, drawn // _STOPS) if one.tag in _GRADIENTS else drawn
        self._costs[value] = cost
        return cost

    def _called(self, target: Element) -> _Drawn:
        """What is drawn from elsewhere is painted by what it lies in, too."""
        if target in self._elsewhere:
            if (known := self._elsewhere[target]) is None:
                raise _Endless
            return known
        self._elsewhere[target] = None
        drawn = self.of(target)
        for above in () if target.tag in _GRADIENTS else self._above_with_paint(target):
            if above not in self._within:
                drawn += _Drawn(cost=self._painted(self._handed(above), drawn))
        self._elsewhere[target] = drawn
        return drawn

    def _handed(self, above: Element) -> _Paints:
        """What it hands down; of many elements, once."""
        if (paints := self._hands.get(above)) is None:
            paints = _Paints()
            for key, value in self._told[above]:
                if key in _HANDED:
                    paints = paints.more(key, self._once(key, value))
            self._hands[above] = paints
        return paints

    def _above_with_paint(self, element: Element) -> tuple[Element, ...]:
        """What it lies in that hands any paint or marker of the file down."""
        above = self._above.get(element)
        if above not in self._handing:
            assert above is not None
            said = self._told.get(above, [])
            hands = any(key in _HANDED and self._targets(key, value) for key, value in said)
            self._handing[above] = (*((above,) if hands else ()), *self._above_with_paint(above))
        return self._handing[above]

    def _layer(self, element: Element, key: str, value: str) -> int:
        """What it counts that the element is drawn by itself before it is laid over what is below."""
        if key == "opacity":
            together = len(element) > 0 or element.tag == "use"
            return _LAYER if together and value not in ("1", "1.0", "100%") else 0
        if key == "clip-path":
            return _LAYER if any(map(self._cuts, self._targets(key, value))) else 0
        if key == "mask":
            return _MASK if value != "none" else 0
        return _LAYER if key in _PLAIN and value != _PLAIN[key] else 0

    def _cuts(self, clip: Element) -> bool:
        """Whether it is drawn by itself; others cut a shape as that is drawn: not letters, and what is cut itself."""
        if clip not in self._cutting:
            self._cutting[clip] = any(
                one.tag in ("text", "use") or any(key == "clip-path" for key, _ in self._told.get(one, []))
                for one in clip.iter()
            )
        return self._cutting[clip]

    def _targets(self, key: str, value: str) -> tuple[Element, ...]:
        linked = key == "href" and value.startswith("#")
        if (linked, value) not in self._named:
            names = [value[1:]] if linked else REFERENCE.findall(value)
            self._named[linked, value] = tuple(self._by_id[name] for name in names if name in self._by_id)
        return self._named[linked, value]
