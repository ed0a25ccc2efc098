"""What stands round the drawing on its page, in millimetres, alike for SVG and PNG: texts, swatches, map and scale."""

from __future__ import annotations

from dataclasses import dataclass

from sim_core.weave.chart.paper import MARGIN, SCALE, Page, below, columns_of, lines_of
from sim_core.weave.chart.values import Chart

__all__ = ["Note", "Patch", "furniture"]

GREY, BLACK = (77, 84, 92), (31, 35, 40)
LETTER, SLIM = 0.56, 0.5  # mean width of a letter in its height, bold and plain
MAP, TALL = 3.4, 2.6  # [mm] of a page on the map of pages
WIDEST = 50.0  # [mm] of that map


@dataclass(frozen=True)
class Note:
    """A text whose base line begins, or ends, at x, y [mm]; size of its letters [mm]."""

    x: float
    y: float
    text: str
    size: float
    anchor: str = "start"
    bold: bool = False
    colour: tuple[int, int, int] = GREY


@dataclass(frozen=True)
class Patch:
    """A rectangle [mm]; fill: sRGB or None, edged: with a thin line round it."""

    x: float
    y: float
    width: float
    height: float
    fill: tuple[int, int, int] | None
    edged: bool = True


def furniture(chart: Chart, page: Page) -> tuple[list[Note], list[Patch]]:
    """Texts and rectangles of a page."""
    notes, patches = _map(chart, page)
    room = (notes[0].x - 20 if notes else page.width - MARGIN) - MARGIN
    size = min(5.0, room / (LETTER * max(len(chart.title), 1)))
    small = min(2.7, room / (SLIM * max(len(chart.facts), len(chart.credits), 1)))
    notes += [
        Note(MARGIN, MARGIN + 4, chart.title, size, bold=True, colour=BLACK),
        Note(MARGIN, MARGIN + 9, chart.facts, small),
        Note(MARGIN, MARGIN + 13, chart.credits, small),
    ]
    foot = lines_of(chart.foot, page)
    bottom = page.height - MARGIN + 2
    notes += [Note(MARGIN, bottom - 3.8 * k, line, 2.7) for k, line in enumerate(reversed(foot))]
    columns, wide = columns_of(chart, page.width)
    top = page.height - MARGIN - below(chart, page.width, page.height) + 4.5
    for k, (colour, text) in enumerate(chart.swatches):
        x, y = MARGIN + k % columns * wide, top + k // columns * 4.2
        if colour is not None:
            patches.append(Patch(x, y, 5.0, 3.0, colour))
        notes.append(Note(x + (6.2 if colour is not None else 0), y + 2.4, text, 2.5))
    if page.name:
        right = page.width - MARGIN
        patches += [Patch(right - SCALE, bottom - 0.3, SCALE, 0.3, BLACK, False)]
        patches += [Patch(right - x, bottom - 1.5, 0.3, 1.5, BLACK, False) for x in (SCALE, SCALE / 2, 0.3)]
        notes.append(Note(right, bottom - 2.3, f"50 mm · a cell {page.cell:.3g} mm", 2.4, "end"))
    return notes, patches


def _map(chart: Chart, page: Page) -> tuple[list[Note], list[Patch]]:
    """Which page of a larger draft this is, and where it lies."""
    leaf = chart.leaf
    if leaf is None:
        return [], []
    wide = min(MAP, WIDEST / leaf.columns)
    tall = min(wide * TALL / MAP, 12.0 / leaf.rows)
    left = page.width - MARGIN - leaf.columns * wide
    patches = [
        Patch(
            left + c * wide,
            MARGIN + r * tall,
            wide,
            tall,
            BLACK if (c, r) == (leaf.column, leaf.row) else None,
        )
        for r in range(leaf.rows)
        for c in range(leaf.columns)
    ]
    return [
        Note(left - 1.5, MARGIN + 3, f"page {leaf.number} of {leaf.columns * leaf.rows}", 2.7, "end")
    ], patches
