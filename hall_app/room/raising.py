"""From the plan to the room: every patch, the sheet of writings, the spots over the exhibits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from hall_app.room.ceiling import ceilings, floor
from hall_app.room.furniture import furniture
from hall_app.room.hangings import hangings
from hall_app.room.lettering import Sheet, write
from hall_app.room.patch import Patch
from hall_app.room.regions import Regions
from hall_app.room.signs import boards_of, signs
from hall_app.room.timber import timber
from hall_app.room.walls import walls

if TYPE_CHECKING:
    from hall_app.content.folder import Exhibit
    from hall_app.content.models import Bilingual, PlanFile

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
