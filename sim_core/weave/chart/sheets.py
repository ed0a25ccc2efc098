"""Drawings written: one page, a part, or as many pages as a large draft needs."""

from __future__ import annotations

from itertools import product
from math import ceil
from pathlib import Path

from sim_core.errors import WeaveError
from sim_core.weave.chart.layout import View, Window, chart_of
from sim_core.weave.chart.paper import free_page, page_of
from sim_core.weave.chart.png import picture_of
from sim_core.weave.chart.svg import svg_of
from sim_core.weave.sources import Source

__all__ = ["numbered", "windows", "write_draft"]

MOST_PRINTED = 500  # ends or picks of a page to print
MOST_DRAWN = 4000  # of a PNG
MOST_PAGES = 100
LONGEST, FINEST = 6000, 24  # pixels of a PNG about, and of a cell at most


def write_draft(source: Source, path: Path, view: View, part: Window | None = None) -> list[Path]:
    """The draft, or a part of it, as SVG or PNG by the name of the file. Returns what was written.

    Pages of a larger draft are FILE-1, FILE-2 …, from end and pick 1 on.  Raises WeaveError where there would be more
    than a hundred, or the part is not within the draft.
    """
    factors = source.factors
    part = part or Window((0, factors.ends), (0, factors.picks))
    for what, (low, high), most in (("ends", part.ends, factors.ends), ("picks", part.picks, factors.picks)):
        if not 0 <= low < high <= most:
            raise WeaveError(f"{what} {low + 1} to {high}: no such part – the draft has {most:,} {what}")
    vector = path.suffix.lower() == ".svg"
    pages = windows(part, MOST_PRINTED if vector else MOST_DRAWN)
    if len(pages) > MOST_PAGES:
        raise WeaveError(f"{path}: {len(pages)} pages – at most {MOST_PAGES}; draw a part of it with --part")
    written = []
    for number, window in enumerate(pages, 1):
        chart = chart_of(source, view, window)
        place = numbered(path, number, len(pages))
        if vector:
            place.write_text(svg_of(chart, page_of(chart)), "utf-8")
        else:
            page = free_page(chart, max(page_of(chart).cell, 1.0))
            pixels = max(2, min(FINEST, int(LONGEST / max(chart.width, chart.height))))
            picture = picture_of(chart, page, pixels)
            picture.save(place, dpi=picture.info["dpi"])
        written.append(place)
    return written


def windows(part: Window, most: int) -> list[Window]:
    """A part in pieces of at most so many ends and picks, all about as large, pick by pick."""
    return [Window(ends, picks) for picks, ends in product(_cuts(part.picks, most), _cuts(part.ends, most))]


def numbered(path: Path, number: int, count: int) -> Path:
    """The name of one of so many pages; of a single one the name itself."""
    return path if count == 1 else path.with_name(f"{path.stem}-{number:0{len(str(count))}}{path.suffix}")


def _cuts(span: tuple[int, int], most: int) -> list[tuple[int, int]]:
    low, high = span
    pieces = ceil((high - low) / most)
    size = ceil((high - low) / pieces)
    size = min(most, -(-size // 10) * 10)  # pages begin at a tenth yarn
    return [(begin, min(begin + size, high)) for begin in range(low, high, size)]
