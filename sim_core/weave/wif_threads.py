"""Threads of a WIF file: their colours, and more of them than a draft may have cut to their smallest repeat."""

from __future__ import annotations

import numpy as np

from sim_core.errors import WeaveError
from sim_core.weave.algebra import smallest_period
from sim_core.weave.draft import MOST
from sim_core.weave.wif_sections import Section, whole

__all__ = ["MOST_COLOURS", "MOST_THREADS", "Lists", "Shed", "cut_to_repeat", "thread_colours"]

MOST_THREADS = 65_536  # of a file; of its repeat, MOST
MOST_COLOURS = 4096
Lists = dict[int, list[int]]  # number of a thread or treadle -> shafts or treadles
Shed = tuple[Lists | None, Lists | None, Lists | None]  # tie-up, treadling, lift plan
Pair = tuple[np.ndarray, np.ndarray]


def cut_to_repeat(
    threading: Lists, shed: Shed, colours: Pair, remarks: list[str]
) -> tuple[Lists, Shed, Pair]:
    """What is wider or longer than a draft may be, cut to its smallest repeat, with its colours if they repeat."""
    tied, treadled, planned = shed
    made = [*colours]
    for k, (side, tables) in enumerate((("WARP", (threading,)), ("WEFT", (treadled, planned)))):
        count = len(colours[k])
        if count <= MOST:
            continue
        rows = [
            tuple(tuple(sorted(set(table.get(n, ())))) for table in tables if table)
            for n in range(1, count + 1)
        ]
        period = smallest_period([(*row, int(c)) for row, c in zip(rows, colours[k], strict=True)])
        if period > MOST:
            period = smallest_period(rows)
            made[k] = np.full(count, colours[k][0])
        if period > MOST:
            raise WeaveError(
                f"[{side}] Threads: {count} that repeat after {period} – a repeat of 1 to {MOST} threads can be read"
            )
        lost = ", without its colours, which do not repeat" if (made[k] != colours[k]).any() else ""
        remarks.append(f"[{side}] {count} threads were cut to their repeat of {period}{lost}")
        made[k] = made[k][:period]
        for table in tables:
            for number in [n for n in table or () if n > period]:
                del table[number]  # type: ignore[union-attr]
    return threading, (tied, treadled, planned), (made[0], made[1])


def thread_colours(
    sections: dict[str, Section], given: np.ndarray, ends: int, picks: int
) -> tuple[np.ndarray, Pair]:
    """The palette, in white for colours that the table leaves out, and the colours of ends and picks."""
    colours = (
        _colours(sections, "WARP", ends, min(1, len(given))),
        _colours(sections, "WEFT", picks, min(2, len(given))),
    )
    most = max(int(c.max()) for c in colours)
    palette = given
    if most > len(given):
        white = np.full((most - len(given), 3), int(given.max()) if len(given) else 255)
        palette = np.concatenate([given, white])
    return palette, colours


def _colours(sections: dict[str, Section], side: str, count: int, default: int) -> np.ndarray:
    """A colour number a thread; a thread without a line, or of colour 0, has the default of [WARP] or [WEFT]."""
    key, value = sections.get(side, {}).get("color", ("Color", ""))
    usual = _colour(value, side, key, default) if value else default
    colours = np.full(count, usual)
    for lower, (key, value) in sections.get(f"{side} COLORS", {}).items():
        number = whole(lower, f"{side} COLORS", key, "number the threads from 1")
        if 1 <= number <= count:  # colours of threads that are not there are surplus
            colours[number - 1] = _colour(value, f"{side} COLORS", key, usual)
    return colours


def _colour(value: str, section: str, key: str, default: int) -> int:
    number = whole(value.split(",")[0], section, key, "give the number of a colour")
    if number > MOST_COLOURS:
        raise WeaveError(f"[{section}] {key}: colour {number} – give 1 to {MOST_COLOURS}")
    return number or default
