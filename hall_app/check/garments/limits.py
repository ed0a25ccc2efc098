"""What a baked garment's measured figures may be, and how they are written."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

__all__ = ["LIMITS", "PIBO", "ROBE", "SCARF", "Limit", "limits_of", "writer"]

ROBE, SCARF, PIBO = "robe_on_figure", "scarf_on_stand", "pibo_on_figure"


@dataclass(frozen=True)
class Limit:
    """A measured figure and what it may be; recipes: which it is asked of (empty: all)."""

    name: str
    most: float | None = None
    least: float | None = None
    recipes: tuple[str, ...] = ()

    def keeps(self, value: float) -> bool:
        """Whether the value lies within the limit; what is no number does not."""
        return value == value and not (
            (self.most is not None and value > self.most) or (self.least is not None and value < self.least)
        )

    def words(self) -> str:
        """The limit as it is told, "" where there is none."""
        write = writer(self.name)
        if self.most is not None:
            return f"at most {write(self.most)}"
        return f"at least {write(self.least)}" if self.least is not None else ""


LIMITS = (
    Limit("inside_vertices", 0),
    Limit("inside_midpoints", 0),
    Limit("inside_centroids", 0),
    Limit("seam_gap_sewn_m", 1e-3, recipes=(ROBE,)),
    Limit("seam_gap_m", 1e-4, recipes=(ROBE,)),
    Limit("area_strain_p95", 0.03),
    Limit("area_strain_max", 0.10),
    Limit("rest_p99_m", 1e-5, recipes=(ROBE, PIBO)),
    Limit("rest_p99_m", 1e-4, recipes=(SCARF,)),
    Limit("self_intersections", 0, recipes=(SCARF,)),
    Limit("self_intersections", 25, recipes=(ROBE,)),
    Limit("self_intersections", 300, recipes=(PIBO,)),
    Limit("asymmetry_m", 0.010, recipes=(ROBE, PIBO)),
    # The robe under the scarf is a robe as any other.
    Limit("robe_inside_vertices", 0, recipes=(PIBO,)),
    Limit("robe_inside_midpoints", 0, recipes=(PIBO,)),
    Limit("robe_inside_centroids", 0, recipes=(PIBO,)),
    Limit("robe_seam_gap_sewn_m", 1e-3, recipes=(PIBO,)),
    Limit("robe_seam_gap_m", 1e-4, recipes=(PIBO,)),
    Limit("robe_area_strain_p95", 0.03, recipes=(PIBO,)),
    Limit("robe_area_strain_max", 0.10, recipes=(PIBO,)),
    Limit("robe_rest_p99_m", 1e-5, recipes=(PIBO,)),
    Limit("robe_self_intersections", 25, recipes=(PIBO,)),
    Limit("robe_asymmetry_m", 0.010, recipes=(PIBO,)),
    Limit("triangles", least=11_000, recipes=(ROBE, PIBO)),
    Limit("hall_all_triangles", 6_000, recipes=(ROBE, PIBO)),
    Limit("hall_hausdorff_mean"),
    Limit("hall_hausdorff_p99"),
    Limit("hall_hausdorff_max"),
    Limit("robe_hall_hausdorff_mean", recipes=(PIBO,)),
    Limit("robe_hall_hausdorff_p99", recipes=(PIBO,)),
    Limit("robe_hall_hausdorff_max", recipes=(PIBO,)),
    Limit("drape_s", 180),
    Limit("drape_cpu_s", recipes=(ROBE,)),
)


def limits_of(recipe: str) -> list[Limit]:
    """The limits asked of a recipe's garments, in the order of the table."""
    return [limit for limit in LIMITS if not limit.recipes or recipe in limit.recipes]


def writer(name: str) -> Callable[[float], str]:
    """How the figure of that name is written."""
    if name.endswith(("_m", "hausdorff_mean", "hausdorff_p99", "hausdorff_max")):
        return lambda value: f"{value * 1000:.3f} mm"
    if "strain" in name:
        return lambda value: f"{value:.2%}"
    return (lambda value: f"{value:.1f} s") if name.endswith("_s") else (lambda value: f"{value:.0f}")
