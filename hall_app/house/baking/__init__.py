"""Bakes beside the server.

queue: which of them runs; preparation: what is wanted, and the process that does it; retention: which are kept. Names
are handed out when they are asked for (PEP 562).
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hall_app.house.baking.preparation import ROOM, Preparation, forsake, stale_garments, wanted_bakes
    from hall_app.house.baking.queue import Bake, BakingQueue, Decision, decide
    from hall_app.house.baking.retention import tidy

__all__ = [
    "ROOM",
    "Bake",
    "BakingQueue",
    "Decision",
    "Preparation",
    "decide",
    "forsake",
    "stale_garments",
    "tidy",
    "wanted_bakes",
]

_HOME = {
    "ROOM": "preparation",
    "Bake": "queue",
    "BakingQueue": "queue",
    "Decision": "queue",
    "Preparation": "preparation",
    "decide": "queue",
    "forsake": "preparation",
    "stale_garments": "preparation",
    "tidy": "retention",
    "wanted_bakes": "preparation",
}


def __getattr__(name: str) -> object:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOME[name]}"), name)
