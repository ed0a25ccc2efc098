"""Colours of a WIF file: its palette, and which colour each thread has; what is out of range is replaced and told."""

from __future__ import annotations

import numpy as np

from sim_core.validation.files import shown
from sim_core.weave.files.wif.sections import Section, from_one, listed

__all__ = ["Palette", "palette_of", "thread_colours"]

MOST_COLOURS = 4096
Sections = dict[str, Section]
Pair = tuple[np.ndarray, np.ndarray]
# (n, 3) int of 0 to top, top, number of the first colour (0 or 1), places from 1 of the colours without a line
Palette = tuple[np.ndarray, int, int, frozenset[int]]
Table = tuple[
    int, int, int, frozenset[int]
]  # first colour, how many, which is taken where none is named, no line


def palette_of(sections: Sections, remarks: list[str], first: int | None = None) -> Palette:
    """The colour table, its highest value, and the number that its first colour has (None: as the table tells).

    A table that is missing, or lines of it that are no colour, leave white, as does what no line names.
    """
    low, high = _range(sections, remarks)
    colours: dict[int, list[int]] = {}
    clipped, lost = [], []
    for lower, (key, value) in sections.get("COLOR TABLE", {}).items():
        colour = _rgb(value)
        if colour is None or not lower.isdigit() or int(lower[:9]) > MOST_COLOURS:
            lost.append(key)
            continue
        if any(not low <= part <= high for part in colour):
            clipped.append(key)
        colours[int(lower)] = [min(max(part, low), high) - low for part in colour]
    if lost:
        remarks.append(
            f"[COLOR TABLE] {listed(lost)}: no red,green,blue with a number up to {MOST_COLOURS} – left out"
        )
    if clipped:
        remarks.append(f"[COLOR TABLE] {listed(clipped)}: outside the range {low},{high} – cut off at it")
    if first is None:
        first = 0 if 0 in colours else 1
        if first == 0:
            remarks.append("[COLOR TABLE]: its colours are numbered from 0, and so are those of the threads")
    top = high - low
    palette = np.full((max(colours, default=first + 1) + 1 - first, 3), top)
    for number, colour in colours.items():
        palette[number - first] = colour
    if not colours:
        palette[1] = 0
        if sections.get("WARP COLORS") or sections.get("WEFT COLORS"):
            remarks.append(f"[COLOR TABLE]: missing – colour {first} is white and colour {first + 1} black")
    told = {number + 1 - first for number in colours}
    return palette, top, first, frozenset(range(1, len(palette) + 1)) - told if told else frozenset()


def thread_colours(
    sections: Sections, made: Palette, counts: tuple[int, int], remarks: list[str]
) -> tuple[np.ndarray, Pair]:
    """The palette, in white where the threads name a colour that it leaves out, and the colours of ends and picks."""
    palette, top, first, gaps = made
    ends = _colours(sections, "WARP", counts[0], (first, len(palette), 1, gaps), remarks)
    picks = _colours(sections, "WEFT", counts[1], (first, len(palette), 2, gaps), remarks)
    most = max(int(ends.max()), int(picks.max()))
    white = np.full((max(most - len(palette), 0), 3), top)
    return np.concatenate([palette, white]), (ends, picks)


def _colours(sections: Sections, side: str, count: int, table: Table, remarks: list[str]) -> np.ndarray:
    """A colour a thread, from 1; a thread without a line has the usual colour of [WARP] or [WEFT].

    Lines that are numbered from 0 count from there; a line that names no thread is left out with a remark.
    """
    first, size, default, _ = table
    name = f"{side} COLORS"
    lines = from_one(name, sections.get(name, {}), count, remarks)
    key, value = sections.get(side, {}).get("color", ("Color", ""))
    usual = _number(value, first) or min(default, size)
    if value or len(lines) < count:
        told = _told(value, table, usual)
        if told:
            remarks.append(f"[{side}] {key}: {told}")
    colours = np.full(count, usual)
    wrong: dict[str, list[str]] = {}
    beyond = []
    for lower, (key, value) in lines.items():
        number = int(lower[:9]) if lower.isascii() and lower.isdigit() else 0
        if not 1 <= number <= count:
            beyond.append(key)
            continue
        colours[number - 1] = _number(value, first) or usual
        told = _told(value, table, usual)
        if told:
            wrong.setdefault(told, []).append(key)
    remarks += [f"[{name}] {listed(keys)}: {told}" for told, keys in wrong.items()]
    if beyond:
        remarks.append(f"[{name}] {listed(beyond)}: no such thread – left out")
    return colours


def _told(value: str, table: Table, usual: int) -> str:
    """What was taken for the colour of a thread that the table does not have; nothing where it does."""
    first, size, _, gaps = table
    number = _number(value, first)
    if number is None:
        what = f"{shown(value, 30)} is no colour" if value else "no colour"
        return f"{what} – colour {usual - 1 + first} was taken"
    if number > size:
        return f"colour {number - 1 + first} is not among the {size} of [COLOR TABLE] – white was taken"
    if number in gaps:
        return f"colour {number - 1 + first} has no line in [COLOR TABLE] – white was taken"
    return ""


def _number(value: str, first: int) -> int | None:
    """A colour from 1, or None where it cannot be one; what follows a comma is another program's."""
    text = value.partition(",")[0].strip()
    if not (text.isascii() and text.isdigit() and len(text) < 10):
        return None
    number = int(text) + 1 - first
    return number if 1 <= number <= MOST_COLOURS else None


def _range(sections: Sections, remarks: list[str]) -> tuple[int, int]:
    key, value = sections.get("COLOR PALETTE", {}).get("range", ("Range", "0,255"))
    parts = [part.strip() for part in value.split(",")]
    if len(parts) == 1 and parts[0] not in ("", "0"):  # some programs write the highest value alone
        parts = ["0", *parts]
    if len(parts) == 2 and all(part.isascii() and part.isdigit() and len(part) < 6 for part in parts):
        low, high = int(parts[0]), int(parts[1])
        if low < high <= 65535:
            if "," not in value:
                remarks.append(f"[COLOR PALETTE] {key}: {shown(value, 30)} – taken for 0,{high}")
            return low, high
    remarks.append(f"[COLOR PALETTE] {key}: {shown(value, 30)} is no range – 0,255 was taken")
    return 0, 255


def _rgb(value: str) -> list[int] | None:
    parts = [part.strip() for part in value.split(",")]
    good = len(parts) == 3 and all(p.isascii() and p.isdigit() and len(p) < 7 for p in parts)
    return [int(part) for part in parts] if good else None
