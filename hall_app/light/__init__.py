"""Light of a room, computed by ourselves: charts, rays, bounces, one picture. README.md tells how."""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hall_app.light.baking import bake_light
    from hall_app.light.encode import light_jpeg
    from hall_app.light.model import LightError, LightMap, Spot, Surfaces

__all__ = ["LightError", "LightMap", "Spot", "Surfaces", "bake_light", "light_jpeg"]

_WHERE = {
    "LightError": "model",
    "LightMap": "model",
    "Spot": "model",
    "Surfaces": "model",
    "bake_light": "baking",
    "light_jpeg": "encode",
}


def __getattr__(name: str) -> object:
    """Hand out names lazily: the values come without the compiled kernels (PEP 562)."""
    if name not in _WHERE:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_WHERE[name]}"), name)
