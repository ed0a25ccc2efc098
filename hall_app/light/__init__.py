"""Light of a room, computed by ourselves: charts, rays, bounces, one picture. README.md tells how."""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .model import LightError, LightMap, Spot, Surfaces

__all__ = ["LightError", "LightMap", "Spot", "Surfaces"]

_WHERE = {name: "model" for name in ("LightError", "LightMap", "Spot", "Surfaces")}


def __getattr__(name: str) -> object:
    """Hand out names lazily: the values come without the compiled kernels (PEP 562)."""
    if name not in _WHERE:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_WHERE[name]}"), name)
