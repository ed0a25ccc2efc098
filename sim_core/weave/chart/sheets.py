"""Drawings written: one page, a part, or as many pages as a large draft needs."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from math import ceil
from pathlib import Path

from sim_core.errors import WeaveError
from sim_core.weave.chart.layout import chart_of
from sim_core.weave.chart.paper import PAPERS, READABLE, SMALLEST_ASKED, free_page, page_of, room_on
from sim_core.weave.chart.png import picture_of
from sim_core.weave.chart.svg import svg_of
from sim_core.weave.chart.values import Leaf, View, Window
from sim_core.weave.files.sources import Source

__all__ = ["numbered", "windows", "write_draft"]

MOST_PRINTED = 500  # ends or picks of a page to print
MOST_DRAWN = 4000  # of a PNG
MOST_PAGES = 100
FEWEST = 10  # ends or picks of a page of a paper that was asked for, whatever their size
PRINTED = 12  # pixels a millimetre of a PNG on paper, about 300 an inch
LONGEST, FINEST = 6000, 24  # pixels of a PNG about, and of a cell at most


def write_draft(
    source: Source, path: Path, view: View, part: Window | None = None, paper: str = ""
) -> list[Path]:
    """The draft, or a part of it, as SVG or PNG by the name of the file. Returns what was written.

    paper: one of PAPERS, on as many pages as readable cells need; else a sheet as large as the draft wants, and pages
    only beyond 500 ends or picks (4,000 of a PNG).  Pages are FILE-1, FILE-2 …, from end and pick 1 on.  Raises
    WeaveError where there would be more than a hundred, or the part is not within the draft.
    """
    factors = source.factors
    part = part or Window((0, factors.ends), (0, factors.picks))
    for what, (low, high), most in (("ends", part.ends, factors.ends), ("picks", part.picks, factors.picks)):
        if not 0 <= low < high <= most:
            raise WeaveError(f"{what} {low + 1} to {high}: no such part – the draft has {most:,} {what}")
    vector = path.suffix.lower() == ".svg"
    most = MOST_PRINTED if vector else MOST_DRAWN
    pages = windows(part, *(_most_on(source, view, part, paper) if paper else (most, most)))
    if len(pages) > MOST_PAGES:
        larger = "take a larger --paper, or " if paper else ""
        raise WeaveError(
            f"{path}: {len(pages):,} pages – at most {MOST_PAGES}; {larger}draw a part of it with --part"
        )
    written = []
    for number, window in enumerate(pages, 1):
        chart = replace(chart_of(source, view, window), leaf=_leaf(pages, number, view))
        place = numbered(path, number, len(pages))
        if vector:
            place.write_text(svg_of(chart, page_of(chart, paper)), "utf-8")
        else:
            page = page_of(chart, paper) if paper else free_page(chart, max(page_of(chart).cell, 1.0))
            pixels = max(2, min(FINEST, int(LONGEST / max(chart.width, chart.height))))
            picture = picture_of(chart, page, pixels if not paper else max(2, round(page.cell * PRINTED)))
            picture.save(place, dpi=picture.info["dpi"])
        written.append(place)
    return written


def _most_on(source: Source, view: View, part: Window, paper: str) -> tuple[int, int]:
    """Ends and picks of a page of this paper: all of them where their cells can be read, else few enough for that."""
    corner = Window((part.ends[0], part.ends[0] + 1), (part.picks[0], part.picks[0] + 1))
    least = chart_of(source, view, corner)  # what stands beside the drawdown takes as much room on every page
    beside = least.width - 1, least.height - 1
    counts = part.ends[1] - part.ends[0], part.picks[1] - part.picks[0]
    made = []
    for width, height in (PAPERS[paper], PAPERS[paper][::-1]):
        room = room_on(least, width, height)
        both = list(zip(room, beside, counts, strict=True))
        if min(r / (count + b) for r, b, count in both) >= READABLE:
            return counts
        fewest = min(r / (min(FEWEST, count) + b) for r, b, count in both)
        # somewhat smaller cells where with them all ends, or all picks, go on one page
        fits = [r / (count + b) for r, b, count in both]
        for cell in (SMALLEST_ASKED, *(fit for fit in fits if READABLE <= fit < SMALLEST_ASKED)):
            most = [max(1, int(r / min(cell, fewest) - b + 1e-9)) for r, b, _ in both]
            made.append((-(-counts[0] // most[0]) * -(-counts[1] // most[1]), most[0], most[1]))
    return min(made)[1:]


def _leaf(pages: list[Window], number: int, view: View) -> Leaf | None:
    """Where a page lies among the others, as they are drawn."""
    if len(pages) == 1:
        return None
    columns = len({window.ends for window in pages})
    rows = len(pages) // columns
    row, column = divmod(number - 1, columns)
    if view.first == "left":
        return Leaf(number, columns, rows, column, rows - 1 - row)
    return Leaf(number, columns, rows, columns - 1 - column, row)


def windows(part: Window, most: int, along: int | None = None) -> list[Window]:
    """A part in pieces of at most so many ends (and picks, else as many), all about as large, pick by pick."""
    pieces = product(_cuts(part.picks, along or most), _cuts(part.ends, most))
    return [Window(ends, picks) for picks, ends in pieces]


def numbered(path: Path, number: int, count: int) -> Path:
    """The name of one of so many pages; of a single one the name itself."""
    return path if count == 1 else path.with_name(f"{path.stem}-{number:0{len(str(count))}}{path.suffix}")


def _cuts(span: tuple[int, int], most: int) -> list[tuple[int, int]]:
    low, high = span
    pieces = ceil((high - low) / most)
    size = ceil((high - low) / pieces)
    # pages begin at a tenth yarn, if that makes no more of them
    tens = min(most, -(-size // 10) * 10)
    if most >= 10 and ceil((high - low) / (tens // 10 * 10)) == pieces:
        size = tens // 10 * 10
    return [(begin, min(begin + size, high)) for begin in range(low, high, size)]
