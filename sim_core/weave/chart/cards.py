"""Peg plans and cards: one pixel a peg or a crossing, black where the warp is lifted, as looms and mills read them.

The lowest row is pick 1, the leftmost column shaft 1 or end 1.
"""

from __future__ import annotations

from pathlib import Path

from PIL import Image

from sim_core.weave.chart.sheets import MOST_DRAWN, numbered, windows
from sim_core.weave.chart.values import Window
from sim_core.weave.draft.algebra import lift_plan
from sim_core.weave.files.sources import Source

__all__ = ["write_cards", "write_pegs"]


def write_cards(source: Source, path: Path) -> list[Path]:
    """The lift as a PNG of one pixel a crossing; more than 4,000 ends or picks as strips FILE-1, FILE-2 …"""
    factors = source.factors
    pieces = windows(Window((0, factors.ends), (0, factors.picks)), MOST_DRAWN)
    written = []
    for number, piece in enumerate(pieces, 1):
        place = numbered(path, number, len(pieces))
        _save(factors.lift(slice(*piece.picks), slice(*piece.ends)), place)
        written.append(place)
    return written


def write_pegs(source: Source, path: Path) -> list[Path]:
    """The lift plan as a PNG of one pixel a shaft and pick; strips as of `write_cards`."""
    harness = source.harness
    pieces = windows(Window((0, harness.tieup.shape[0]), (0, len(harness.treadling))), MOST_DRAWN)
    written = []
    for number, piece in enumerate(pieces, 1):
        place = numbered(path, number, len(pieces))
        plan = lift_plan(harness.tieup, harness.treadling[slice(*piece.picks)])
        _save(plan[:, slice(*piece.ends)], place)
        written.append(place)
    return written


def _save(lifted, place: Path) -> None:
    Image.fromarray(~lifted[::-1]).save(place)
