"""From an outfit to what the hall shows.

encoding, film: pictures to films; look: what they and the models show of an outfit; trails: how what is worn beneath
moved; motion: the clip of an outfit that moves; outfit: one bake from inputs to record; command: `hall build`.
Names are handed out when they are asked for (PEP 562).
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hall_app.build.encoding import SOUND_RATE, encode_film, film_possible
    from hall_app.build.motion import play, write_motion
    from hall_app.build.outfit import bake_outfit, budget, refuse_disorder
    from hall_app.build.trails import TrailLostError, Trails

__all__ = [
    "SOUND_RATE",
    "TrailLostError",
    "Trails",
    "bake_outfit",
    "budget",
    "encode_film",
    "film_possible",
    "play",
    "refuse_disorder",
    "write_motion",
]

_HOME = {
    "SOUND_RATE": "encoding",
    "TrailLostError": "trails",
    "Trails": "trails",
    "bake_outfit": "outfit",
    "budget": "outfit",
    "encode_film": "encoding",
    "film_possible": "encoding",
    "play": "motion",
    "refuse_disorder": "outfit",
    "write_motion": "motion",
}


def __getattr__(name: str) -> object:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOME[name]}"), name)
