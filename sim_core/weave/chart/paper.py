"""Paper: which sheet a drawing fits on, and how large its cells are there, in millimetres."""

from __future__ import annotations

from dataclasses import dataclass

from sim_core.weave.chart.layout import Chart

__all__ = ["MARGIN", "SMALL", "Page", "free_page", "page_of"]

SHEETS = {"A4": (210, 297), "A3": (297, 420), "A2": (420, 594), "A1": (594, 841), "A0": (841, 1189)}
MARGIN, HEAD, FOOT = 12.0, 17.0, 8.0  # [mm]; numbers of ends stand within the head
LARGEST, SMALLEST = 6.0, 1.0  # cells [mm]
SMALL = 1.4  # cells [mm] below which only every fifth line is drawn, and every fifth shaft numbered
READABLE = 1.6  # cells that need no larger sheet [mm]


@dataclass(frozen=True)
class Page:
    """A sheet of paper [mm] and where the drawing lies on it. name: such as "A4"."""

    name: str
    width: float
    height: float
    cell: float
    left: float
    top: float


def page_of(chart: Chart) -> Page:
    """The smallest sheet on which the cells can be read; on the largest one they may be smaller than a millimetre."""
    best = None
    for name, (short, long) in SHEETS.items():
        for width, height in ((short, long), (long, short)):
            cell = min(
                (width - 2 * MARGIN) / chart.width,
                (height - 2 * MARGIN - HEAD - FOOT) / chart.height,
                LARGEST,
            )
            if best is None or cell > best.cell:
                best = _placed(name, width, height, cell, chart)
        if best is not None and best.cell >= (READABLE if name in ("A4", "A3") else SMALLEST):
            break
    assert best is not None
    return best


def free_page(chart: Chart, cell: float) -> Page:
    """A sheet as large as the drawing and its texts need, for the screen."""
    letters = max(len(chart.facts), len(chart.foot), 2 * len(chart.title))
    width = max(chart.width * cell, 1.35 * letters) + 2 * MARGIN
    return _placed("", width, chart.height * cell + 2 * MARGIN + HEAD + FOOT, cell, chart)


def _placed(name: str, width: float, height: float, cell: float, chart: Chart) -> Page:
    return Page(name, width, height, cell, MARGIN, MARGIN + HEAD)
