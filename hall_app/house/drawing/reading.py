"""A drawing written anew in a process of its own (`beside`), to which refusals do not travel as they are raised."""

from __future__ import annotations

from hall_app.house.drawing.elements import redrawn
from hall_app.house.drawing.raster import drawn_anew
from hall_app.house.people import PeopleError
from hall_app.house.recording import Refused

__all__ = ["redrawn_or_refused"]


def redrawn_or_refused(name: str, data: bytes, most: int) -> tuple[bytes, str] | Refused:
    """As `redrawn`, its pictures `drawn_anew`."""
    try:
        return redrawn(name, data, drawn_anew, most)
    except PeopleError as error:
        return Refused(error.key, error.figures)
