"""What is drawn on a pattern sheet before anyone says what it is: lines with the names that stand around them."""

from collections import Counter
from dataclasses import dataclass, field

import numpy as np

from sim_core.validation.svg import MOST_VISITED

__all__ = ["Drawn", "Stroke", "visited"]


@dataclass(frozen=True)
class Stroke:
    """One line of a drawing.

    points: (n, 2) [m], y down; n = 1 is a mark.  closed: the first point is not repeated.  layer: the DXF layer, or
    the SVG class.  groups: names of the groups or the block around it, outermost first.  words: what its classes,
    names and layers say, lower case.  filled: an area without a line
    around it.  dashed: not drawn through.  name: its own.  told: those of the groups that a text calls a piece.
    """

    points: np.ndarray
    closed: bool
    layer: str = ""
    groups: tuple[str, ...] = ()
    words: tuple[str, ...] = ()
    filled: bool = False
    dashed: bool = False
    name: str = ""
    told: tuple[str, ...] = ()


@dataclass(frozen=True)
class Drawn:
    """What a reader found: lines, what it left out (name: how often); remarks and notes as in `Sheet`.

    apparel: its texts say that layers are those of AAMA or ASTM.
    """

    strokes: list[Stroke]
    left_out: Counter[str] = field(default_factory=Counter)
    remarks: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    apparel: bool = False


def visited(before: int) -> int:
    """One element more; raises ValueError where a drawing multiplies itself beyond bearing."""
    if before >= MOST_VISITED:
        raise ValueError(f"it draws more than {MOST_VISITED} elements")
    return before + 1
