"""From the plan to the room: every patch, the sheet of writings, the spots over the exhibits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from hall_app.room.parts.ceiling import ceilings_of, floor_of
from hall_app.room.parts.furniture import furniture_of
from hall_app.room.parts.hangings import hangings_of
from hall_app.room.parts.signs import boards_of, signs_of
from hall_app.room.parts.timber import timber_of
from hall_app.room.parts.walls import walls_of
from hall_app.room.patch import Patch
from hall_app.room.structure.regions import Regions
from hall_app.room.surface.lettering import Sheet, write

if TYPE_CHECKING:
    from hall_app.content.folder import Exhibit
    from hall_app.content.schema import Bilingual, PlanFile

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
    plan: PlanFile,
    title: Bilingual,
    exhibits: Sequence[Exhibit] = (),
    *,
    folder: Path = Path(),
    blank: bool = False,
) -> Room:
    """The room of `plan` with labels for `exhibits`.

    folder: where the pictures lie that hang in it; blank: leave the letters out, on a machine without the font; else
    raises MissingFontError there.
    """
    regions = Regions(plan)
    boards = boards_of(plan, regions, title, exhibits, folder)
    sheet = write([board.writing for board in boards], blank=blank)
    patches = [
        *floor_of(plan, regions),
        *ceilings_of(plan, regions),
        *walls_of(plan, regions),
        *timber_of(plan, regions),
        *furniture_of(plan),
        *hangings_of(plan, regions),
        *signs_of(boards, sheet),
    ]
    return Room(tuple(patches), sheet)
