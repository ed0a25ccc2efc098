"""Simulation core: weave, mesh, cloth and garment. Arrays in, arrays out; SI units; y up.

Names are handed out lazily (PEP 562): `import sim_core` costs milliseconds, and only the room whose name
is asked for is loaded. Type checkers see more when they import from the rooms, e.g. `sim_core.weave`.
"""

from importlib import import_module
from typing import Any

_ROOMS = {
    "errors": ("FileProblem", "OutlineError", "SimCoreError", "WeaveError"),
    "weave": (
        "ClothParameters",
        "Draft",
        "SurfaceMaps",
        "Weave",
        "Yarn",
        "YarnGeometry",
        "parameters_of",
        "plain",
        "relax",
        "satin",
        "solve",
        "surface_maps",
        "twill",
    ),
    "mesh": ("MeshReport", "PanelMesh", "panel_mesh"),
    "cloth": ("Drape", "Material", "drape"),
    "garment": (
        "Clip",
        "Garment",
        "Outfit",
        "Pattern",
        "Stand",
        "choose_detail",
        "dress",
        "load_outfit",
        "write_glb",
    ),
    "metrics": ("Distances", "hausdorff"),
    "picture": ("render",),
}
_HOME = {name: room for room, names in _ROOMS.items() for name in names}

__all__ = sorted(_HOME)  # pyright: ignore[reportUnsupportedDunderAll]


def __getattr__(name: str) -> Any:
    """Load the room that holds `name` and return the name (PEP 562)."""
    room = _HOME.get(name)
    if room is None:
        raise AttributeError(f"module 'sim_core' has no attribute {name!r}; it has {', '.join(__all__)}")
    return getattr(import_module(f"sim_core.{room}"), name)


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])
