"""The drawing of a draft before it is on paper: blocks of cells, their numbers and the floats marked, in cells.

Threading above, treadling or lift plan on the right, the tie-up where they meet, the drawdown below on the left. End 1
and pick 1 lie at the tie-up, as weavers draw it; `first="left"` begins at the lower left instead, as mills and Chinese
textbooks do. Either way shaft 1 is next to the cloth, and twills lean as they do in the cloth.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim_core.weave.algebra import lift_plan
from sim_core.weave.chart.floats import Floats, long_floats
from sim_core.weave.sources import Source

__all__ = ["FACE", "BACK", "INK", "PAPER", "Block", "Chart", "Label", "View", "Window", "chart_of"]

PAPER, INK = (255, 255, 255), (31, 35, 40)
FACE, BACK = (214, 30, 52), (22, 112, 214)  # long floats on the face and on the back
GAP = 1.5  # cells between the blocks, with the numbers of shafts and treadles
MOST_TREADLES = 80  # more are drawn as a lift plan
MOST_SHAFTS = 80  # more are no loom with shafts: only the drawdown is drawn
STRIP = 0.5  # cells between threading or treadling and the colours of the yarns


@dataclass(frozen=True)
class View:
    """How a draft is drawn. colour: the drawdown in the colours of its yarns.  floats: mark those over more crossings,
    0 none.  plan: a lift plan in place of tie-up and treadling.  first: "right" or "left", where end 1 is."""

    colour: bool = False
    floats: int = 0
    plan: bool = False
    first: str = "right"


@dataclass(frozen=True)
class Window:
    """A part of a draft: ends and picks, counted from 0, the last one excluded."""

    ends: tuple[int, int]
    picks: tuple[int, int]


@dataclass(frozen=True, eq=False)
class Block:
    """Cells with their upper left corner at x, y. cells: (rows, columns) int, numbers of `colours`; 0 is paper.

    numbers: (rows, columns) int written into the cells, 0 none; grid: whether lines are drawn between cells; counted:
    from which row and column (counted from 1, negative: backwards) every fifth and tenth line is heavier.
    """

    name: str
    x: float
    y: float
    cells: np.ndarray
    colours: np.ndarray
    grid: bool = True
    numbers: np.ndarray | None = None
    counted: tuple[int, int] = (0, 0)

    def __post_init__(self) -> None:
        object.__setattr__(self, "cells", self.cells.astype(np.int16))


@dataclass(frozen=True)
class Label:
    """A text at x, y, in cells, in the middle of its height. anchor: "start", "middle" or "end" of it lies there.

    minor: left out where the cells are too small for a number in each of them.
    """

    x: float
    y: float
    text: str
    anchor: str = "middle"
    minor: bool = False


@dataclass(frozen=True, eq=False)
class Chart:
    """The drawing of a draft or of a part of it; width and height in cells.

    lines: (kind, (n, 4) float x0, y0, x1, y1) of the floats marked.  title, facts, foot: texts around the drawing.
    """

    title: str
    facts: str
    foot: str
    width: float
    height: float
    blocks: tuple[Block, ...]
    labels: tuple[Label, ...]
    lines: tuple[tuple[str, np.ndarray], ...]


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
    def down(self) -> float:
        return self.threading + self.shafts + GAP


def chart_of(source: Source, view: View, window: Window | None = None) -> Chart:
    """The drawing of a draft, or of the part of it in the window."""
    factors, harness = source.factors, source.harness
    window = window or Window((0, factors.ends), (0, factors.picks))
    treadles, shafts = harness.tieup.shape[1], harness.tieup.shape[0]
    planned = view.plan or source.plan or treadles > MOST_TREADLES
    right = lift_plan(harness.tieup, harness.treadling) if planned else harness.treadling
    ends, picks = np.arange(*window.ends), np.arange(*window.picks)
    flipped = view.first == "left"
    place = _Place(
        ends if flipped else ends[::-1],
        picks[::-1] if flipped else picks,
        shafts if shafts <= MOST_SHAFTS else 0,
        right.shape[1] if shafts <= MOST_SHAFTS else 0,
    )
    blocks = [*_harness_blocks(source, place, right, planned), _drawdown(source, place, view.colour)]
    lines = ()
    if view.floats:
        found = long_floats(factors, view.floats, slice(*window.picks), slice(*window.ends))
        lines = tuple(_marks(found, place, flipped).items())
    width = place.across + place.right + STRIP + 1 + 3
    return Chart(
        _title(source.name),
        _facts(source),
        _foot(source, view, window),
        width,
        place.down + len(picks),
        tuple(blocks),
        tuple(_labels(place, planned)),
        lines,
    )


def _harness_blocks(source: Source, place: _Place, right: np.ndarray, planned: bool) -> list[Block]:
    """Threading, tie-up, treadling or lift plan, and the colours of the yarns beside them."""
    harness = source.harness
    if not place.shafts:
        return _colour_blocks(source, place)
    ink = np.array([PAPER, INK], dtype=np.uint8)
    threading = harness.threading[place.ends].T[::-1]
    trodden = right[place.picks]
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
    beside = place.across + place.right + STRIP
    return [
        Block("warp colours", 0, 0, warp[None, :], colours),
        Block("weft colours", beside, place.down, weft[:, None], colours),
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


def _labels(place: _Place, planned: bool):
    """Numbers of shafts and treadles in the gaps, of every tenth end and pick at the outside."""
    above = place.threading + place.shafts
    for shaft in _told(place.shafts):
        yield Label(
            len(place.ends) + 0.35, above - shaft + 0.5, str(shaft), "start", shaft > 1 and shaft % 5 > 0
        )
    for column in _told(place.right):
        yield Label(
            place.across + column - 0.5, above + GAP / 2, str(column), minor=column > 1 and column % 5 > 0
        )
    for numbers, across in ((place.ends, True), (place.picks, False)):
        for k in np.flatnonzero(((numbers + 1) % 10 == 0) | (numbers == 0)):
            text = str(numbers[k] + 1)
            if across:
                yield Label(k + 0.5, -0.7, text)
            else:
                yield Label(place.across + place.right + STRIP + 1.4, place.down + k + 0.5, text, "start")


def _told(count: int) -> range | list[int]:
    """Which of so many shafts or treadles are numbered."""
    return range(1, count + 1) if count <= 40 else [1, *range(10, count + 1, 10)]


def _title(name: str) -> str:
    """One line of letters that can be printed."""
    line = " ".join("".join(letter if letter.isprintable() else " " for letter in name).split())
    return line if len(line) <= 70 else line[:69] + "…"


def _facts(source: Source) -> str:
    facts, factors, harness = source.facts, source.factors, source.harness
    how = "lift plan" if source.plan else f"{harness.tieup.shape[1]} treadles"
    return (
        f"{factors.ends:,} ends x {factors.picks:,} picks · {harness.tieup.shape[0]:,} shafts, {how} · repeat "
        f"{facts.ends:,} x {facts.picks:,} · longest float {facts.warp.longest} warp, {facts.weft.longest} weft · "
        + ("hangs together" if facts.integral else "falls apart")
    )


def _foot(source: Source, view: View, window: Window) -> str:
    parts = []
    if window != Window((0, source.factors.ends), (0, source.factors.picks)):
        parts.append(
            f"ends {window.ends[0] + 1} to {window.ends[1]}, picks {window.picks[0] + 1} to {window.picks[1]}"
        )
    parts.append("colour and weave" if view.colour else "filled: warp on top")
    if source.harness.tieup.shape[0] > MOST_SHAFTS:
        parts.append(f"more than {MOST_SHAFTS} shafts are not drawn")
    if view.floats:
        counts = [sum(c for n, c in side if n > view.floats) for side in (
            (*source.facts.warp.face, *source.facts.weft.face), (*source.facts.warp.back, *source.facts.weft.back),
        )]  # fmt: skip
        parts.append(
            f"floats over {view.floats}: {counts[0]:,} on the face (red), {counts[1]:,} on the back (blue), a repeat"
        )
    return " · ".join(parts)
