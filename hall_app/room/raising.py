"""From the plan to the room: every patch, the sheet of writings, the spots over the exhibits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from .ceiling import ceilings, floor
from .furniture import furniture
from .hangings import hangings
from .lettering import Sheet, write
from .patch import Patch
from .regions import Regions
from .signs import boards_of, signs
from .timber import timber
from .walls import walls

if TYPE_CHECKING:
    from ..content.folder import Exhibit
    from ..content.models import Bilingual, PlanFile

__all__ = ["Room", "raise_room"]


@dataclass(frozen=True)
class Room:
    """A hall ready to be lit and drawn."""

    patches: tuple[Patch, ...]
    sheet: Sheet

    @property
    def triangles(self) -> int:
        return sum(len(patch.faces) for patch in self.patches)


def raise_room(
    plan: PlanFile, title: Bilingual, exhibits: Sequence[Exhibit] = (), *, blank: bool = False
) -> Room:
    """The room of `plan` with labels for `exhibits`.

    blank: leave the letters out, on a machine without the font; else raises MissingFontError there.
    """
    regions = Regions(plan)
    boards = boards_of(plan, regions, title, exhibits)
    sheet = write([board.writing for board in boards], blank=blank)
    patches = [
        *floor(plan, regions),
        *ceilings(plan, regions),
        *walls(plan, regions),
        *timber(plan, regions),
        *furniture(plan),
        *hangings(plan, regions),
        *signs(boards, sheet),
    ]
    return Room(tuple(patches), sheet)
