"""Paper: which sheet a drawing fits on, and how large its cells are there, in millimetres."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil

from sim_core.weave.chart.values import Chart

__all__ = [
    "MARGIN", "PAPERS", "READABLE", "SCALE", "SMALL", "SMALLEST_ASKED", "Page", "below", "columns_of", "free_page",
    "lines_of", "page_of", "room_on",
]  # fmt: skip

SHEETS = {"A4": (210, 297), "A3": (297, 420), "A2": (420, 594), "A1": (594, 841), "A0": (841, 1189)}
PAPERS = SHEETS | {"letter": (215.9, 279.4), "legal": (215.9, 355.6), "tabloid": (279.4, 431.8)}
MARGIN, HEAD, FOOT = 12.0, 21.0, 4.0  # [mm]; numbers of ends stand within the head
HEDDLES = 6.0  # [mm] on the left of the threading
SCALE = 50.0  # [mm] of the line by which a print is measured
LARGEST, SMALLEST = 6.0, 1.0  # cells [mm]
SMALL = 1.4  # cells [mm] below which only every fifth line is drawn, and every fifth shaft numbered
READABLE = 1.6  # cells that need no larger sheet [mm]
SMALLEST_ASKED = 2.0  # cells on a paper that was asked for [mm]; smaller ones become several pages
LETTER = 0.53  # mean width of a letter in its height


@dataclass(frozen=True)
class Page:
    """A sheet of paper [mm] and where the drawing lies on it. name: such as "A4", empty for the screen."""

    name: str
    width: float
    height: float
    cell: float
    left: float
    top: float


def page_of(chart: Chart, paper: str = "") -> Page:
    """The sheet asked for, else the smallest one on which the cells can be read; upright or on its side.

    On the largest sheet, and on one that was asked for, cells may be smaller than a millimetre.
    """
    best = None
    for name in (paper,) if paper else SHEETS:
        for width, height in (PAPERS[name], PAPERS[name][::-1]):
            across, along = room_on(chart, width, height)
            cell = min(across / chart.width, along / chart.height, LARGEST)
            if best is None or cell > best.cell:
                best = _placed(name, width, height, cell, chart)
        if best is not None and best.cell >= (READABLE if name in ("A4", "A3") else SMALLEST):
            break
    assert best is not None
    return best


def room_on(chart: Chart, width: float, height: float) -> tuple[float, float]:
    """Millimetres across and along that a sheet leaves for the cells."""
    across = width - 2 * MARGIN - (HEDDLES if chart.heddles else 0)
    return across, height - 2 * MARGIN - HEAD - below(chart, width, height)


def free_page(chart: Chart, cell: float) -> Page:
    """A sheet as large as the drawing and its texts need, for the screen."""
    letters = max(len(chart.facts), len(chart.credits), len(chart.foot) // 2, 2 * len(chart.title), 60)
    width = max((chart.width + 2) * cell + HEDDLES, 1.45 * letters) + 2 * MARGIN
    height = chart.height * cell + 2 * MARGIN + HEAD + below(chart, width, 0)
    return _placed("", width, height, cell, chart)


def below(chart: Chart, width: float, height: float) -> float:
    """Millimetres beneath the cells for the colours and the lines of the foot."""
    page = Page("", width, height, 1.0, MARGIN, MARGIN)
    columns, _ = columns_of(chart, width)
    rows = ceil(len(chart.swatches) / columns)
    return FOOT + 3.8 * len(lines_of(chart.foot, page)) + 4.2 * rows


def columns_of(chart: Chart, width: float) -> tuple[int, float]:
    """How many colours stand side by side, and how wide each is [mm]."""
    wide = 10 + LETTER * 2.5 * max((len(text) for _, text in chart.swatches), default=1)
    return max(1, int((width - 2 * MARGIN) / wide)), wide


def lines_of(foot: str, page: Page) -> list[str]:
    """The foot in lines that leave room for the scale."""
    most = max(int((page.width - 2 * MARGIN - SCALE - 6) / (LETTER * 2.7)), 20)
    lines = [""]
    for part in foot.split(" · "):
        if lines[-1] and len(lines[-1]) + 3 + len(part) > most:
            lines.append("")
        lines[-1] += (" · " if lines[-1] else "") + part
    return lines


def _placed(name: str, width: float, height: float, cell: float, chart: Chart) -> Page:
    return Page(name, width, height, cell, MARGIN + (HEDDLES if chart.heddles else 0), MARGIN + HEAD)
