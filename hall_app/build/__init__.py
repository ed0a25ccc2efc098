"""From an outfit to what the hall shows.

encoding, film: pictures to films; look: what they and the models show of an outfit; trails: how what is worn beneath
moved; motion: the clip of an outfit that moves; points: what is
tracked of its wearer; outfit: one bake from inputs to record; beside: several at once; command: `hall build`.
Names are handed out when they are asked for (PEP 562).
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hall_app.build.beside import Job, bake_beside
    from hall_app.build.encoding import SOUND_RATE, encode_film, film_possible
    from hall_app.build.film import Look, Part, Piece, filming
    from hall_app.build.look import Wardrobe
    from hall_app.build.motion import play, write_motion
    from hall_app.build.outfit import bake_outfit, budget, refuse_disorder
    from hall_app.build.points import limb_bones, sensed, write_points
    from hall_app.build.trails import TrailLostError, Trails

__all__ = [
    "SOUND_RATE",
    "Job",
    "Look",
    "Part",
    "Piece",
    "TrailLostError",
    "Trails",
    "Wardrobe",
    "bake_beside",
    "bake_outfit",
    "budget",
    "encode_film",
    "film_possible",
    "filming",
    "limb_bones",
    "play",
    "refuse_disorder",
    "sensed",
    "write_motion",
    "write_points",
]

_HOME = {
    "Job": "beside",
    "Look": "film",
    "Part": "film",
    "Piece": "film",
    "SOUND_RATE": "encoding",
    "TrailLostError": "trails",
    "Trails": "trails",
    "Wardrobe": "look",
    "bake_beside": "beside",
    "bake_outfit": "outfit",
    "budget": "outfit",
    "encode_film": "encoding",
    "film_possible": "encoding",
    "filming": "film",
    "play": "motion",
    "refuse_disorder": "outfit",
    "limb_bones": "points",
    "sensed": "points",
    "write_motion": "motion",
    "write_points": "points",
}


def __getattr__(name: str) -> object:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOME[name]}"), name)
