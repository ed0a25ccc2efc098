"""The running hall, kept in step with its content.

background: slow work beside the event loop; beside: work in a process of its own; signals: Ctrl-C at the right moment;
floor_grid: the clearance grid; baking: what is baked when; people: accounts, roles, the journal; house: content, floor,
scene and visitors together; edits: shown, baked, tidied up after; drafts: the collection edited; drawing: pictures
that were brought; recording: film and sound.
Names are handed out when they are asked for (PEP 562): a command's --help needs no scene.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hall_app.house.background import Latest, in_thread
    from hall_app.house.beside import end_all
    from hall_app.house.edits import Following
    from hall_app.house.floor_grid import grid_beside, ready_grid
    from hall_app.house.house import House

__all__ = ["Following", "House", "Latest", "end_all", "grid_beside", "in_thread", "ready_grid"]

_HOME = {
    "Following": "edits",
    "House": "house",
    "Latest": "background",
    "end_all": "beside",
    "grid_beside": "floor_grid",
    "in_thread": "background",
    "ready_grid": "floor_grid",
}


def __getattr__(name: str) -> object:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOME[name]}"), name)
