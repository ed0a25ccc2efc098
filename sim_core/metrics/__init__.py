"""The one place where a published number is computed: distances between surfaces, strain, penetration, crossings."""

from sim_core.metrics.compile_time import CompileClock, compile_clock
from sim_core.metrics.components import components
from sim_core.metrics.nearest import Surface
from sim_core.metrics.surfaces import (
    FAR,
    Distances,
    Penetration,
    area_strain,
    hausdorff,
    intersections,
    penetration,
    sample_surface,
    surface_distance,
)
from sim_core.metrics.triangles import winding

__all__ = [
    "FAR",
    "CompileClock",
    "Distances",
    "Penetration",
    "Surface",
    "area_strain",
    "compile_clock",
    "components",
    "hausdorff",
    "intersections",
    "penetration",
    "sample_surface",
    "surface_distance",
    "winding",
]
