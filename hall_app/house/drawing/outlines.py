"""How long the outlines of shapes are at most, in the units of their drawing: what dashes are laid along."""

from __future__ import annotations

import re
from math import hypot, inf
from xml.etree.ElementTree import Element

__all__ = ["NUMBER", "corners", "frame", "letters", "numbers", "outline", "side"]

_A_NUMBER = r"[+-]?(?:\d++\.?+\d*+|\.\d++)(?:e[+-]?\d++)?+"
NUMBER = re.compile(_A_NUMBER, re.IGNORECASE)
_SIDE = re.compile(rf"({_A_NUMBER})\s*(%|[a-z]*)", re.IGNORECASE)
# Both flags of an arc are a single figure each, after which nothing has to stand.
_GAP = r"[\s,]*+"
_ARC = re.compile(
    _GAP.join((*[f"({_A_NUMBER})"] * 3, "([01])", "([01])", *[f"({_A_NUMBER})"] * 2, "")), re.IGNORECASE
)
_COMMAND = re.compile(r"([a-z])([^a-df-z]*)", re.IGNORECASE)
_PAIRS = {"q": 2, "s": 2, "c": 3}  # of a segment's numbers

_SIDES = "r rx ry width height".split()
_BY_SIDES = frozenset(("rect", "circle", "ellipse"))
_UNITS = {"": 1.0, "px": 1.0, "pt": 1.4, "pc": 16.0, "mm": 3.8, "cm": 38.0, "in": 96.0}
# [px] of units that go by the size of letters, which browsers draw no larger than 10,000.
_UNITS |= dict.fromkeys(("em", "rem", "ex", "ch", "ic", "cap"), 10_000.0)
_FRAMES = frozenset(("svg", "use", "symbol"))
_ROOM = 10_000.0  # [px] that a share is of at least: a drawing need not say how large it is


def numbers(text: str) -> list[float]:
    """All that stand in it, whatever stands between."""
    return list(map(float, NUMBER.findall(text)))


def frame(root: Element) -> float:
    """[px] of which shares are asked at most: the largest number of any frame; infinite where one may pass its own."""
    return max(_ROOM, *map(_largest, root.iter()))


def letters(element: Element) -> int:
    """How many are written in it, not in its children."""
    return len((element.text or "").strip()) + sum(len((one.tail or "").strip()) for one in element)


def corners(element: Element) -> int:
    """Of its own line, at most."""
    if element.tag == "line":
        return 2
    line = _line(element)
    return len(numbers(line)) + line.count("z") + line.count("Z")


def side(text: str, share: float = 0.0) -> float:
    """A length [px]; infinite where nobody knows. share: what all of 100 % is."""
    text = text.strip()
    if text.lower() in ("", "auto"):
        return 0.0
    if (read := _SIDE.fullmatch(text)) is None:
        return inf
    unit = share / 100.0 if read[2] == "%" else _UNITS.get(read[2].lower(), inf)
    many = abs(float(read[1]))
    return many * unit if many and unit else 0.0


def outline(element: Element, of: float) -> float:
    """How long the lines of a shape are at most; 0 for what is none. of: `frame`."""
    if element.tag == "line":
        return sum(_apart(element.get(f"{one}1", ""), element.get(f"{one}2", ""), of) for one in "xy")
    if element.tag not in _BY_SIDES:
        return _along(_line(element))
    return 4.0 * sum(side(value, of) for one in _SIDES if (value := element.get(one)))


def _apart(begin: str, end: str, of: float) -> float:
    begin, end = begin.strip() or "0", end.strip() or "0"
    if NUMBER.fullmatch(begin) and NUMBER.fullmatch(end):
        return abs(float(end) - float(begin))
    return side(begin, of) + side(end, of)


def _line(element: Element) -> str:
    """What its kind has of it, whatever else is written there."""
    if element.tag in ("polyline", "polygon"):
        return f"M{element.get('points', '')}Z"
    return element.get("d", "") if element.tag == "path" else ""


def _largest(element: Element) -> float:
    sides = [element.get(one, "") for one in ("width", "height")]
    beyond = element.tag in _FRAMES and any("%" in one and side(one, 100.0) > 100.0 for one in sides)
    return inf if beyond else max(*numbers(element.get("viewBox", "")), *map(side, sides))


def _along(path: str) -> float:
    """By the corners of what controls it; infinite for arcs that are none."""
    total = x = y = first_x = first_y = bent_x = bent_y = (
        0.0  # bent: what the last quadratic curve was bent by
    )
    for command, rest in _COMMAND.findall(path):
        kind, relative = command.lower(), command.islower()
        found = numbers(rest) if kind != "a" else []
        if kind not in "qt":
            bent_x = bent_y = inf
        if kind == "z":
            total += hypot(x - first_x, y - first_y)
            x, y = first_x, first_y
        elif kind == "h":
            for one in found:
                total, x = total + abs(one if relative else one - x), x + one if relative else one
        elif kind == "v":
            for one in found:
                total, y = total + abs(one if relative else one - y), y + one if relative else one
        elif kind == "a":
            if (arcs := _arcs(rest)) is None:
                return inf
            for rx, ry, new_x, new_y in arcs:
                new_x, new_y = new_x + x * relative, new_y + y * relative
                total += _arc(abs(rx), abs(ry), hypot(new_x - x, new_y - y))
                x, y = new_x, new_y
        elif kind == "t":
            for k in range(0, len(found) - 1, 2):
                bent_x, bent_y = (x, y) if bent_x == inf else (2.0 * x - bent_x, 2.0 * y - bent_y)
                new_x, new_y = found[k] + x * relative, found[k + 1] + y * relative
                total += hypot(bent_x - x, bent_y - y) + hypot(new_x - bent_x, new_y - bent_y)
                x, y = new_x, new_y
        else:
            step = 2 * _PAIRS.get(kind, 1)
            for k in range(0, len(found) - step + 1, step):
                last_x, last_y = x, y
                for pair in range(k, k + step, 2):
                    new_x, new_y = found[pair] + x * relative, found[pair + 1] + y * relative
                    moved = kind == "m" and k == 0  # there draws nothing
                    total += 0.0 if moved else 2.0 * hypot(new_x - last_x, new_y - last_y)
                    if kind == "q" and pair == k:
                        bent_x, bent_y = new_x, new_y
                    last_x, last_y = new_x, new_y
                x, y = last_x, last_y
                if kind == "m" and k == 0:
                    first_x, first_y = x, y
    return total


def _arc(rx: float, ry: float, chord: float) -> float:
    """Radii that do not reach from end to end grow alike, and one that is 0 makes the arc a line."""
    small, large = sorted((rx, ry))
    return chord + (7.0 * large * max(1.0, chord / (2.0 * small)) if small else 0.0)


def _arcs(text: str) -> list[tuple[float, float, float, float]] | None:
    """(rx, ry, x, y) of each; None where the text is more than arcs."""
    found, at, text = [], 0, text.strip(" ,\t\r\n")
    while at < len(text):
        if (one := _ARC.match(text, at)) is None:
            return None
        found.append((float(one[1]), float(one[2]), float(one[6]), float(one[7])))
        at = one.end()
    return found
