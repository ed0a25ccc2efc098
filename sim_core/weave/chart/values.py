"""A drawing of a draft as values: how it is asked for, and the blocks, numbers and lines that it has, in cells."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

__all__ = [
    "BACK",
    "FACE",
    "INK",
    "PAPER",
    "REPEAT",
    "Block",
    "Chart",
    "Label",
    "Leaf",
    "Swatch",
    "View",
    "Window",
]

PAPER, INK = (255, 255, 255), (31, 35, 40)
FACE, BACK = (214, 30, 52), (22, 112, 214)  # long floats on the face and on the back
REPEAT = (0, 128, 88)
Swatch = tuple[
    tuple[int, int, int] | None, str
]  # sRGB, None where only the text stands; what is written beside it


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


@dataclass(frozen=True)
class Leaf:
    """One of the pages of a larger draft: its number, and its column and row on the map of them, from 0."""

    number: int
    columns: int
    rows: int
    column: int
    row: int


@dataclass(frozen=True, eq=False)
class Chart:
    """The drawing of a draft or of a part of it; width and height in cells.

    lines: (kind, (n, 4) float x0, y0, x1, y1) of the floats marked.  repeats: (n, 4) float, lines between repeats.
    title, facts, credits, foot: texts around the drawing.  swatches: the colours, and how many yarns have them.
    heddles: whether numbers stand on the left of the threading.  leaf: which page it is, None for a single one.
    """

    title: str
    facts: str
    credits: str
    foot: str
    width: float
    height: float
    blocks: tuple[Block, ...]
    labels: tuple[Label, ...]
    lines: tuple[tuple[str, np.ndarray], ...]
    repeats: np.ndarray
    swatches: tuple[Swatch, ...]
    heddles: bool = False
    leaf: Leaf | None = None
