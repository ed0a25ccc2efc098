"""What a figure wears by its outfit without being dressed in it: a bodice, trousers, a petticoat.

What is worn beneath a garment that shall be seen, and hardly moves by itself, need not be simulated: a dress form is
covered, and what lies over it meets the cover.
"""

from __future__ import annotations

from dataclasses import dataclass

from sim_core.body.cover.on_skin import on_skin
from sim_core.body.cover.petticoat import Petticoat, in_petticoat
from sim_core.body.mannequin import Colour, Mannequin

__all__ = ["Cover", "covered"]


@dataclass(frozen=True)
class Cover:
    """Colours (sRGB, 0 to 1) of what a figure wears on its skin, and the petticoat that skirts hang over; None: it does
    not."""

    bodice: Colour | None = None
    trousers: Colour | None = None
    petticoat: Petticoat | None = None


def covered(figure: Mannequin, cover: Cover) -> Mannequin:
    """The figure in its cover; joints and marks are the same.

    Raises SimCoreError for a petticoat that it cannot wear.
    """
    worn = on_skin(figure, cover.bodice, cover.trousers) if cover.bodice or cover.trousers else figure
    return worn if cover.petticoat is None else in_petticoat(worn, cover.petticoat)
