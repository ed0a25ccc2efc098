"""A pattern sheet as a value: its pieces, and what of it is no piece."""

from dataclasses import dataclass, field
from typing import Literal

import numpy as np

__all__ = ["Piece", "Sheet", "Which"]

Which = Literal["cut", "sew"]


@dataclass(frozen=True)
class Piece:
    """One piece of a pattern.

    cut, sew: the line it is cut along and the line it is sewn along, (n, 2) [m], y down, not closed; None where the
    sheet does not draw it.  layer: of the outline (SVG: its class).  holes, lines: closed and open lines inside,
    (n, 2) [m].  notches: (k, 2) [m].  grain: both ends of the grain line, (2, 2) [m].  fold: both ends of the line that
    half a piece is mirrored about, (2, 2) [m].
    """

    name: str
    layer: str
    cut: np.ndarray | None
    sew: np.ndarray | None
    holes: tuple[np.ndarray, ...] = ()
    lines: tuple[np.ndarray, ...] = ()
    notches: np.ndarray = field(default_factory=lambda: np.zeros((0, 2)))
    grain: np.ndarray | None = None
    fold: np.ndarray | None = None

    @property
    def outline(self) -> np.ndarray:
        """The outermost line that is drawn, (n, 2) [m]."""
        found = self.cut if self.cut is not None else self.sew
        assert found is not None
        return found


@dataclass(frozen=True)
class Sheet:
    """pieces: in the order of the file.  left_out: what is no part of a piece, by name, and how often.  remarks: what
    was changed or guessed.  notes: what is as drawn but worth a look, such as a unit that the sheet does not say."""

    pieces: tuple[Piece, ...]
    left_out: dict[str, int] = field(default_factory=dict)
    remarks: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
