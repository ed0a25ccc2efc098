"""Light of a room, computed by ourselves: charts, rays, bounces, one picture. README.md tells how.

model: what is taken and given; atlas: charts in one picture; rays: what they meet; lamps, gather, spots: light at
places; encode: the picture; checkpoint: the state between passes; baking: all passes. The values come without the
compiled kernels: names are handed out when they are asked for (PEP 562).
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hall_app.light.baking import bake_light
    from hall_app.light.encode import SHOULDER, WALL, light_jpeg, show
    from hall_app.light.model import LightError, LightMap, Sampling, Spot, Surfaces

__all__ = [
    "SHOULDER",
    "WALL",
    "LightError",
    "LightMap",
    "Sampling",
    "Spot",
    "Surfaces",
    "bake_light",
    "light_jpeg",
    "show",
]

_HOME = {
    "SHOULDER": "encode",
    "WALL": "encode",
    "LightError": "model",
    "LightMap": "model",
    "Sampling": "model",
    "Spot": "model",
    "Surfaces": "model",
    "bake_light": "baking",
    "light_jpeg": "encode",
    "show": "encode",
}


def __getattr__(name: str) -> object:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOME[name]}"), name)
