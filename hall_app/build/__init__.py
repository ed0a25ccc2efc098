"""From a pattern, a weave and a recipe to what the hall shows.

encoding, film: pictures to films; recipes: the ways to drape; garment: one bake from inputs to record; command: `hall
build`. Names are handed out when they are asked for (PEP 562).
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hall_app.build.encoding import SOUND_RATE, encode_film, film_possible
    from hall_app.build.garment import bake_garment, budget

__all__ = ["SOUND_RATE", "bake_garment", "budget", "encode_film", "film_possible"]

_HOME = {
    "SOUND_RATE": "encoding",
    "bake_garment": "garment",
    "budget": "garment",
    "encode_film": "encoding",
    "film_possible": "encoding",
}


def __getattr__(name: str) -> object:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOME[name]}"), name)
