"""Where dashes are left out, since nobody can tell how many they are: along letters, and in lines of a screen's own
width, whose dashes are as short however large the drawing is shown."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from functools import cache
from math import inf, sqrt
from xml.etree.ElementTree import Element

from hall_app.house.drafts.drawing.outlines import NUMBER, numbers, side
from hall_app.house.drafts.drawing.styles import note

__all__ = ["TEXTS", "Told", "shortest_dash", "stretch", "stretched", "without_countless_dashes"]

Said = list[tuple[str, str]]  # property and value
Told = Mapping[Element, Said]  # all that is said of an element
TEXTS = frozenset(("text", "tspan", "textPath"))
_DASHES, _WIDTH = "stroke-dasharray", "vector-effect"
_SCREEN = 4_000.0  # [px] that a drawing is shown at
_MOST_STRETCHED = 1_000.0
_BY_BOXES = ("patternContentUnits", "maskContentUnits", "clipPathUnits")


def shortest_dash(told: Told) -> float:
    """The length of the shortest dash with its gap; 0: there is none."""
    said = {value for one in told.values() for key, value in one if key == _DASHES}
    pairs = (2.0 * sum(found) / len(found) for found in map(numbers, said) if found)
    return min(filter(None, pairs), default=0.0)


def stretched(said: Said) -> bool:
    """Whether an element's line is as wide as a screen has it, whatever its drawing's units are."""
    return any(key == _WIDTH and value.strip().lower() != "none" for key, value in said)


def stretch(root: Element, told: Told) -> float:
    """[px] of a screen that a unit of any element is at most: what all enlarge, as if each lay in each."""
    whole, enlarged = 1.0, cache(_enlarged)  # programs say the same of many elements
    for one in root.iter():
        given = [value for key, value in told.get(one, []) if key == "transform"]
        for value in (*given, one.get("patternTransform", "")):
            whole *= enlarged(value)
        by_boxes = any(one.get(name, "").strip() == "objectBoundingBox" for name in _BY_BOXES)
        if one.tag == "marker" or by_boxes or ("viewBox" in one.attrib and one is not root):
            return inf
    box = [each for each in numbers(root.get("viewBox", ""))[2:] if each > 0.0]
    shown = max(_SCREEN, side(root.get("width", "")), side(root.get("height", "")))
    return whole * max(1.0, shown / min(box, default=inf))


def without_countless_dashes(root: Element, told: Told, left: Counter[str]) -> None:
    """told: of every element; what is left out is no longer told."""
    if not shortest_dash(told):
        return
    _none_along_letters(root, told)
    lines = [one for one, said in told.items() if stretched(said)]
    if lines and stretch(root, told) > _MOST_STRETCHED:
        for one in lines:
            told[one][:] = [said for said in told[one] if said[0] != _WIDTH]
            _stress(one, _WIDTH)
            note(left, _WIDTH)


def _none_along_letters(root: Element, told: Told) -> None:
    def visit(element: Element, dashed: bool) -> None:
        nonlocal used
        dashed = dashed or any(key == _DASHES and value != "none" for key, value in told[element])
        used = used or (dashed and element.tag == "use")
        if element.tag in TEXTS:
            texts.append((element, dashed))
        for child in element:
            visit(child, dashed)

    used = False  # what is used may be letters that lie elsewhere
    texts: list[tuple[Element, bool]] = []
    visit(root, False)
    for element, dashed in texts:
        if dashed or used:
            _stress(element, _DASHES)


def _stress(element: Element, key: str) -> None:
    """That there is none, whatever else is said; once. What an escape hides is no end of what was said before."""
    none, before = f"{key}:none!important", element.get("style", "")
    if before != none and (not before.endswith(f";{none}") or before.endswith(f"\\;{none}")):
        element.set("style", f"{before};{none}".lstrip(";"))


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
