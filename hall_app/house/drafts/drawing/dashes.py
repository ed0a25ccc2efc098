"""How many dashes lie along lines and letters at most: a browser draws each, seen or not."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from functools import cache
from math import inf, sqrt
from xml.etree.ElementTree import Element

from hall_app.house.drafts.drawing.outlines import NUMBER, frame, letters, numbers, outline, side

__all__ = ["Told", "dashes_along", "shortest_dash"]

Said = list[tuple[str, str]]  # property and value
Told = Mapping[Element, Said]  # all that is said of an element
_DASHES, _WIDTH = "stroke-dasharray", "vector-effect"
_SCREEN = 4_000.0  # [px] that a drawing is shown at
_APART = frozenset(("marker", "mask", "pattern", "symbol"))  # drawn elsewhere, as large as that has it
_LETTER = 64.0  # sizes of its font that the outline of a letter is long, 鬱 included
_FONT, _LARGEST_FONT = 32.0, 10_000.0  # [px] where none is said, and what browsers draw at most
_MEASURE = re.compile(r"[^\s/,]+")


def shortest_dash(told: Told) -> float:
    """The length of the shortest dash with the gap before or after it; 0: there is none."""
    said = {value for one in told.values() for key, value in one if key == _DASHES}
    return min(filter(None, map(_shortest_pair, said)), default=0.0)


def dashes_along(root: Element, told: Told) -> dict[Element, float]:
    """Of each element that dashes reach; infinite where nobody knows. told: of elements that anything is said of."""
    if not (shortest := shortest_dash(told)):
        return {}
    wholly = _shown(root)
    sides, font = frame(root), _largest_font(told)
    found: dict[Element, float] = {}
    for element, enlarged in _reached(root, told):
        length = outline(element, sides)
        if count := letters(element):
            length += count * _LETTER * font
        if length and any(
            key == _WIDTH and value.strip().lower() != "none" for key, value in told.get(element, [])
        ):
            length *= (
                enlarged * wholly
            )  # as wide and as short as the screen has them, however large it is shown
        found[element] = length / shortest
    return found


def _shortest_pair(value: str) -> float:
    """A long gap makes no dash before it longer: each line begins anew."""
    found = numbers(value)
    pairs = [one + other for one, other in zip(found, found[1:] + found[:1], strict=True)]
    return max(min(pairs), 1e-300) if any(found) else 0.0


def _reached(root: Element, told: Told) -> Iterator[tuple[Element, float]]:
    """The elements that dashes reach, and how much longer any line of theirs is drawn than it is written."""

    def visit(element: Element, dashed: bool, whole: float) -> None:
        said = told.get(element, [])
        dashed = dashed or any(
            key == _DASHES and value.lower() not in ("none", "initial") for key, value in said
        )
        for key, value in said:
            whole *= enlarged(value) if key == "transform" else 1.0
        if element.tag in _APART or ("viewBox" in element.attrib and element is not root):
            whole = inf
        every.append((element, dashed, whole))
        for child in element:
            visit(child, dashed, whole)

    enlarged = cache(_enlarged)  # programs say the same of many elements
    every: list[tuple[Element, bool, float]] = []
    visit(root, False, 1.0)
    uses = [(dashed, whole) for element, dashed, whole in every if element.tag == "use"]
    handed = any(dashed for dashed, _ in uses)  # to what lies elsewhere
    elsewhere = inf if any(whole > 1.0 for _, whole in uses) else 1.0
    for element, dashed, whole in every:
        if dashed or handed:
            yield element, whole * elsewhere


def _shown(root: Element) -> float:
    """[px] of a screen that a unit of the whole drawing is at most."""
    sides = [side(root.get(one, "")) for one in ("width", "height")]
    box = numbers(root.get("viewBox", ""))[2:] or sides
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
