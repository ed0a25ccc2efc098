"""The drawing of a draft before it is on paper: blocks of cells, their numbers and the floats marked, in cells.

Threading above, treadling or lift plan on the right, the tie-up where they meet, the drawdown below on the left. End 1
and pick 1 lie at the tie-up, as weavers draw it; `first="left"` begins at the lower left instead, as mills and Chinese
textbooks do. Either way shaft 1 is next to the cloth, and twills lean as they do in the cloth.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim_core.weave.chart.floats import Floats, long_floats
from sim_core.weave.chart.texts import MOST_SHAFTS, credits_of, facts_of, foot_of, swatches_of, title_of
from sim_core.weave.chart.values import INK, PAPER, Block, Chart, Label, View, Window
from sim_core.weave.draft.algebra import lift_plan
from sim_core.weave.files.sources import Source

__all__ = ["chart_of"]

GAP = 1.5  # cells between the blocks, with the numbers of shafts and treadles
MOST_TREADLES = 80  # more are drawn as a lift plan
FEWEST, MOST_MARKS = 3, 200  # yarns of a repeat that is marked, and marks a side
BEYOND = 0.35  # cells by which a mark stands out
STRIP = 0.5  # cells between threading or treadling and the colours of the yarns


@dataclass(frozen=True, eq=False)
class _Place:
    """Where the blocks lie, and in which order their rows and columns are drawn."""

    ends: np.ndarray  # numbers from 0 of the ends from left to right
    picks: np.ndarray  # of the picks from top to bottom
    shafts: int
    right: int  # columns on the right: treadles or shafts

    @property
    def across(self) -> float:
        return len(self.ends) + GAP

    @property
    def threading(self) -> float:
        return 1 + STRIP

    @property
    def beside(self) -> float:
        return self.across + self.right + STRIP

    @property
    def down(self) -> float:
        return self.threading + self.shafts + GAP


def chart_of(source: Source, view: View, window: Window | None = None) -> Chart:
    """The drawing of a draft, or of the part of it in the window."""
    factors, harness = source.factors, source.harness
    window = window or Window((0, factors.ends), (0, factors.picks))
    treadles, shafts = harness.tieup.shape[1], harness.tieup.shape[0]
    planned = view.plan or source.plan or treadles > MOST_TREADLES
    shown = shafts <= MOST_SHAFTS
    ends, picks = np.arange(*window.ends), np.arange(*window.picks)
    flipped = view.first == "left"
    place = _Place(
        ends if flipped else ends[::-1],
        picks[::-1] if flipped else picks,
        shafts if shown else 0,
        (shafts if planned else treadles) if shown else 0,
    )
    blocks = [*_harness_blocks(source, place, planned), _drawdown(source, place, view.colour)]
    lines = ()
    if view.floats:
        found = long_floats(factors, view.floats, slice(*window.picks), slice(*window.ends))
        lines = tuple(_marks(found, place, flipped).items())
    repeats = np.concatenate([_marks_between(source, place, axis) for axis in (0, 1)])
    return Chart(
        title_of(source.name),
        facts_of(source),
        credits_of(source),
        foot_of(source, view, window, {block.name for block in blocks}, len(repeats) > 0),
        place.beside + 1 + 3,
        place.down + len(picks),
        tuple(blocks),
        tuple(_labels(source, place)),
        lines,
        repeats,
        swatches_of(source),
        place.shafts > 0,
    )


def _marks_between(source: Source, place: _Place, axis: int) -> np.ndarray:
    """(n, 4) lines across threading (axis 1) or treadling (axis 0) and the colours, where the weave begins again."""
    period, numbers = source.factors.periods[axis], place.ends if axis else place.picks
    turned = numbers[0] > numbers[-1]
    begins = np.flatnonzero(numbers % period == 0)
    k = (begins[begins < len(numbers) - 1] + 1 if turned else begins[begins > 0]).astype(float)
    count = source.factors.ends if axis else source.factors.picks
    if period < FEWEST or count < 2 * period or len(k) > MOST_MARKS:
        return np.zeros((0, 4))
    if axis:
        low, high = -BEYOND, (place.threading + place.shafts if place.shafts else 1) + BEYOND
        return np.column_stack([k, np.full_like(k, low), k, np.full_like(k, high)])
    left, right = (place.across if place.shafts else place.beside) - BEYOND, place.beside + 1 + BEYOND
    return np.column_stack([np.full_like(k, left), k + place.down, np.full_like(k, right), k + place.down])


def _harness_blocks(source: Source, place: _Place, planned: bool) -> list[Block]:
    """Threading, tie-up, treadling or lift plan, and the colours of the yarns beside them."""
    harness = source.harness
    if not place.shafts:
        return _colour_blocks(source, place)
    ink = np.array([PAPER, INK], dtype=np.uint8)
    threading = harness.threading[place.ends].T[::-1]
    trodden = harness.treadling[place.picks]
    if planned:
        trodden = lift_plan(harness.tieup, trodden)
    shaft = np.arange(place.shafts, 0, -1)[:, None]
    column = np.arange(1, place.right + 1)[None, :]
    counted = _counted(place)
    numbers = None if planned else trodden * column
    rows = [
        *_colour_blocks(source, place),
        Block("threading", 0, place.threading, threading, ink, True, threading * shaft, (0, counted[1])),
        Block("lift plan" if planned else "treadling", place.across, place.down, trodden, ink, True, numbers,
              (counted[0], 0)),
    ]  # fmt: skip
    if not planned:
        rows.append(Block("tie-up", place.across, place.threading, harness.tieup[::-1], ink))
    return rows


def _colour_blocks(source: Source, place: _Place) -> list[Block]:
    colours = np.vstack([PAPER, source.palette]).astype(np.uint8)
    warp, weft = 1 + source.warp_colours[place.ends], 1 + source.weft_colours[place.picks]
    return [
        Block("warp colours", 0, 0, warp[None, :], colours),
        Block("weft colours", place.beside, place.down, weft[:, None], colours),
    ]


def _counted(place: _Place) -> tuple[int, int]:
    """Numbers of the top pick and of the left end, negative where they count down."""
    down = place.picks[0] + 1 if place.picks[-1] >= place.picks[0] else -(place.picks[0] + 1)
    across = place.ends[0] + 1 if place.ends[-1] > place.ends[0] else -(place.ends[0] + 1)
    return int(down), int(across)


def _drawdown(source: Source, place: _Place, colour: bool) -> Block:
    factors = source.factors
    lift = factors.core[factors.pick[place.picks]][:, factors.end[place.ends]]
    if not colour:
        ink = np.array([PAPER, INK], dtype=np.uint8)
        return Block("drawdown", 0, place.down, lift, ink, counted=_counted(place))
    warp, weft = 1 + source.warp_colours[place.ends], 1 + source.weft_colours[place.picks]
    cells = np.where(lift, warp[None, :], weft[:, None])
    return Block(
        "drawdown", 0, place.down, cells, np.vstack([PAPER, source.palette]).astype(np.uint8), grid=False
    )


def _marks(found: Floats, place: _Place, flipped: bool) -> dict[str, np.ndarray]:
    """Lines through the long floats, a third of a cell short of their ends; to the border where they may go on."""
    lines = {}
    for kind, rows in found.items():
        warp = kind.startswith("warp")
        yarns, crossed = (len(place.ends), len(place.picks)) if warp else (len(place.picks), len(place.ends))
        yarn, begin, end = rows.T.astype(float) + [[0.5], [0.0], [0.0]]
        if warp != flipped:  # ends are drawn from the right, or picks from below
            yarn = yarns - yarn
        if warp == flipped:
            begin, end = crossed - end, crossed - begin
        begin, end = np.where(begin > 0, begin + 0.34, begin), np.where(end < crossed, end - 0.34, end)
        made = (yarn, begin, yarn, end) if warp else (begin, yarn, end, yarn)
        lines[kind] = np.column_stack(made) + [0, place.down, 0, place.down]
    return lines


def _labels(source: Source, place: _Place):
    """Numbers of shafts and treadles in the gaps, of every fifth end and pick at the outside, heddles on the left."""
    above = place.threading + place.shafts
    heddles = source.harness.threading.sum(axis=0) if place.shafts else ()
    for shaft in _told(place.shafts):
        minor = shaft > 1 and shaft % 5 > 0
        yield Label(len(place.ends) + 0.35, above - shaft + 0.5, str(shaft), "start", minor)
        yield Label(-0.4, above - shaft + 0.5, f"{heddles[shaft - 1]:,}", "end", minor)
    if place.shafts:
        yield Label(-0.4, -0.7, "heddles", "end")
    for column in _told(place.right):
        yield Label(
            place.across + column - 0.5, above + GAP / 2, str(column), minor=column > 1 and column % 5 > 0
        )
    for numbers, across in ((place.ends, True), (place.picks, False)):
        for k in np.flatnonzero(((numbers + 1) % 5 == 0) | (numbers == 0)):
            text, minor = str(numbers[k] + 1), bool((numbers[k] + 1) % 10 and numbers[k])
            if across:
                yield Label(k + 0.5, -0.7, text, minor=minor)
            else:
                yield Label(place.beside + 1.4, place.down + k + 0.5, text, "start", minor)


def _told(count: int) -> range | list[int]:
    """Which of so many shafts or treadles are numbered."""
    return range(1, count + 1) if count <= 40 else [1, *range(10, count + 1, 10)]
