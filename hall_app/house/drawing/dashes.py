"""How many dashes lie along lines and letters at most: a browser draws each, seen or not."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from math import inf, sqrt
from xml.etree.ElementTree import Element

from hall_app.house.drawing.outlines import NUMBER, frame, letters, numbers, outline, side

__all__ = ["Told", "dashed", "dashes_along"]

Said = list[tuple[str, str]]  # property and value
Told = Mapping[Element, Said]  # all that is said of an element
_DASHES, _WIDTH, _EFFECT = "stroke-dasharray", "stroke-width", "vector-effect"
_WIDE = 100.0  # times as wide as long, beyond which dashes are not drawn
_SCREEN = 4_000.0  # [px] that a drawing is shown at
_APART = frozenset(("marker", "mask", "pattern", "symbol"))  # drawn elsewhere, as large as that has it
_LETTER = 64.0  # sizes of its font that the outline of a letter is long, 鬱 included
_FONT, _LARGEST_FONT = 32.0, 10_000.0  # [px] where none is said, and what browsers draw at most
_MEASURE = re.compile(r"[^\s/,]+")


def dashed(told: Told) -> bool:
    """Whether anything is said to have dashes."""
    return any(
        map(_shortest_pair, {value for said in told.values() for key, value in said if key == _DASHES})
    )


def dashes_along(root: Element, told: Told) -> dict[Element, float]:
    """Of each element that dashes reach; infinite where nobody knows. told: of elements that anything is said of."""
    wholly, sides, font = _shown(root), frame(root), _largest_font(told)
    found: dict[Element, float] = {}
    for element, pen in _reached(root, told):
        length = outline(element, sides)
        if count := letters(element):
            length += count * _LETTER * font
        if length and any(
            key == _EFFECT and value.strip().lower() != "none" for key, value in told.get(element, [])
        ):
            # As wide and as short as the screen has them, however large it is shown.
            length *= pen.enlarged * wholly
        # Dashes much wider than they are long are sorted for minutes.
        found[element] = inf if pen.width > _WIDE * pen.dash else length / pen.dash
    return found


@dataclass(frozen=True)
class _Pen:
    """What reaches an element at most. dash: the shortest with a gap beside it, infinite: none; width: of the line;
    enlarged: how much longer any line is drawn than it is written."""

    dash: float = inf
    width: float = 1.0
    enlarged: float = 1.0


def _shortest_pair(value: str) -> float:
    """A dash with the gap before or after it; 0: there is none. A long gap makes no dash before it longer: each line
    begins anew."""
    found = numbers(value)
    pairs = [one + other for one, other in zip(found, found[1:] + found[:1], strict=True)]
    return max(min(pairs), 1e-300) if any(found) else 0.0


def _reached(root: Element, told: Told) -> Iterator[tuple[Element, _Pen]]:
    """The elements that dashes reach, and by which pen."""

    def visit(element: Element, pen: _Pen, used: bool) -> None:
        dash, width, enlarged = pen.dash, pen.width, pen.enlarged
        for key, value in told.get(element, []):
            if key == _DASHES:
                dash = min(dash, pair(value) or inf)
            elif key == _WIDTH:
                width = max(width, wide(value))
            elif key == "transform":
                enlarged *= larger(value)
        if element.tag in _APART or ("viewBox" in element.attrib and element is not root):
            enlarged = inf
        pen = _Pen(dash, width, enlarged)
        used = used or element.get("id") in targets
        every.append((element, pen, used))
        for child in element:
            visit(child, pen, used)

    # Programs say the same of many elements.
    larger, pair, wide = cache(_enlarged), cache(_shortest_pair), cache(lambda value: side(value, inf))
    targets = {one.get("href", "")[1:] for one in root.iter("use")}
    every: list[tuple[Element, _Pen, bool]] = []
    visit(root, _Pen(), False)
    uses = [pen for element, pen, _ in every if element.tag == "use"]
    # What is used has its user's pen too, enlarged by who knows how many of them.
    handed = _Pen(
        min((pen.dash for pen in uses), default=inf),
        max((pen.width for pen in uses), default=1.0),
        inf if any(pen.enlarged > 1.0 for pen in uses) else 1.0,
    )
    for element, pen, used in every:
        if used:
            pen = _Pen(
                min(pen.dash, handed.dash), max(pen.width, handed.width), pen.enlarged * handed.enlarged
            )
        if pen.dash < inf:
            yield element, pen


def _shown(root: Element) -> float:
    """[px] of a screen that a unit of the whole drawing is at most."""
    sides = [side(root.get(one, "")) for one in ("width", "height")]
    box = numbers(root.get("viewBox", ""))
    box = box[2:] if len(box) == 4 and min(box[2:]) > 0.0 else sides  # browsers leave out what is none
    return max(1.0, max(_SCREEN, *sides) / min(filter(None, box), default=inf))


def _largest_font(told: Told) -> float:
    """[px] of any letter; infinite where lines lie below letters, which are as long as their gaps."""
    largest = _FONT
    for key, value in {one for said in told.values() for one in said}:
        if key.startswith("text-decoration") and value.lower() not in ("none", "inherit", "initial"):
            return inf
        if key in ("font", "font-size"):
            for word in _MEASURE.findall(value):
                largest = max(largest, _font(word, alone=key == "font-size"))
    return largest


def _font(word: str, *, alone: bool) -> float:
    """[px] that a word says; in `font` a number by itself is a weight or a line's height."""
    if NUMBER.fullmatch(word):
        return min(abs(float(word)), _LARGEST_FONT) if alone else 0.0
    if word[0] in "+-.0123456789" or "(" in word or word.lower() == "larger":
        return min(side(word, inf), _LARGEST_FONT)  # inf: of what it lies in
    return 0.0


def _enlarged(transform: str) -> float:
    """How much longer it makes anything at most, 1 at least; infinite where nobody knows."""
    whole = 1.0
    for part in transform.split(")"):
        name, _, given = part.partition("(")
        name = name.strip(" ,\t\r\n").lower()
        if name not in ("", "none", "translate", "translatex", "translatey", "rotate"):
            found = given.replace(",", " ").split()
            known = all(map(NUMBER.fullmatch, found))
            whole *= max(1.0, _by(name, list(map(float, found))) if known else inf)
    return whole


def _by(name: str, given: list[float]) -> float:
    match name, given:
        case (("scale" | "scalex" | "scaley"), [_, *_] as sides):
            return max(map(abs, sides))
        case "matrix", [a, b, c, d, _, _]:  # the larger singular value
            squares, area = a * a + b * b + c * c + d * d, a * d - b * c
            return sqrt((squares + sqrt(max(0.0, squares * squares - 4.0 * area * area))) / 2.0)
        case _:
            return inf
