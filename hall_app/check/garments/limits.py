"""What a baked garment's measured figures may be, by what the garment is, and how they are written."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from hall_app.content.bakes.accessories import cloth_area, garment_at
from hall_app.content.bakes.steps import PATIENCE, PATIENCE_WHOLE

__all__ = ["Limit", "Worn", "limits_of", "writer"]

ON_STAND, ALONG_PATH = ("overbar", "folded"), "alongpath"
TRIANGLES = 11_000  # that the garment one comes to see has at least


@dataclass(frozen=True)
class Worn:
    """What a garment is: its name, the way it was placed, whether it has seams, whether some were sewn on the wearer,
    whether one half was dressed against its mirror image, whether others are worn over it, whether it hangs on a T-bar,
    where robes are placed as they are on a wearer, how much cloth it is of [m2], and whether its outfit calls it an
    accessory."""

    name: str
    way: str
    seams: bool = False
    sewn: bool = False
    half: bool = False
    beneath: bool = False
    spread: bool = False
    cloth: float = 1.0
    accessory: bool | None = None

    @staticmethod
    def of(garment: Any, *, beneath: bool) -> Worn:
        """What a `sim_core.garment.Garment` tells of itself; raises KeyError or TypeError where it does not."""
        kinds = {seam["kind"] for seam in garment.cut["seams"]}
        whole, way = garment.provenance["whole"], str(garment.provenance["way"])
        spread = way not in ON_STAND and "stand" in garment.provenance
        cloth = cloth_area(garment.pattern, garment.pattern_faces)
        told = garment.provenance.get("accessory")
        return Worn(garment.name, way, bool(kinds), "sewn" in kinds, not whole, beneath, spread, cloth, told)

    @property
    def on_stand(self) -> bool:
        """Whether it hangs on a stand, else on a wearer."""
        return self.spread or self.way in ON_STAND


@dataclass(frozen=True)
class Limit:
    """A measured figure of one garment and what it may be."""

    name: str
    most: float | None = None
    least: float | None = None

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


def limits_of(
    worn: Worn, deviation: float, outfit: Sequence[Worn] = (), *, moving: bool = False
) -> list[Limit]:
    """The limits asked of a garment, in the order in which they are told.

    deviation: how far (p99) its model in the hall may be from the close one [m]; outfit: all layers from the skin
    outwards, this one alone if none are given; moving: whether it goes through a motion, of whose frames the worst is
    told. Figures of what is worn beneath bear its name: robe_area_strain_max.
    """
    outfit = outfit or (worn,)
    found = [Limit(f"inside_{what}", 0) for what in ("vertices", "midpoints", "centroids", "edges")]
    if worn.sewn:
        found.append(Limit("seam_gap_sewn_m", 1e-3))
    if worn.seams:
        found.append(Limit("seam_gap_m", 1e-4))
    found += [Limit("area_strain_p95", 0.03), Limit("area_strain_max", 0.10)]
    found += [Limit("rest_p99_m", 1e-4 if worn.way in ON_STAND else 1e-5)]
    found += [Limit("self_intersections", _crossings(worn)), Limit("layer_order", 0)]
    if moving:
        found += [Limit("moving_deepest_m", 1e-3), Limit("moving_self_intersections", _crossings(worn))]
        found += [Limit("moving_layer_order", 0), Limit("moving_area_strain_p95", 0.04)]
        found += [Limit("moving_hall_hausdorff_p99", deviation)]
    if worn.half:
        found.append(Limit("asymmetry_m", 0.010))
    if (least := _least_triangles(worn, outfit)) is not None:
        found.append(Limit("triangles", least=least))
    if not worn.on_stand and not worn.beneath:
        found.append(Limit("hall_all_triangles", 6_000))
    found += [Limit("hall_hausdorff_mean"), Limit("hall_hausdorff_p99", deviation)]
    found += [Limit("hall_hausdorff_max")]
    if not worn.beneath:
        patience = PATIENCE_WHOLE if worn.sewn and not worn.half else PATIENCE
        found += [Limit("drape_s"), Limit("drape_cpu_s", patience * len(outfit))]
    before = f"{worn.name}_" if worn.beneath else ""
    return [Limit(before + limit.name, limit.most, limit.least) for limit in found]


def _least_triangles(worn: Worn, outfit: Sequence[Worn]) -> int | None:
    """Triangles asked of a garment on a wearer: of the one that one comes to see, and for their cloth as many of the
    accessories over it, so that none is coarser. None of what lies beneath."""
    at = garment_at([(each.cloth, each.accessory) for each in outfit])
    if worn.on_stand or worn in outfit[:at]:
        return None
    return math.ceil(TRIANGLES * min(1.0, worn.cloth / outfit[at].cloth))


def _crossings(worn: Worn) -> int:
    """Edges that may pass through faces: none, but in the stacked folds of a scarf that arms squeeze together."""
    return 25 if worn.way == ALONG_PATH else 0


def writer(name: str) -> Callable[[float], str]:
    """How the figure of that name is written."""
    if name.endswith(("_m", "hausdorff_mean", "hausdorff_p99", "hausdorff_max")):
        return lambda value: f"{value * 1000:.3f} mm"
    if "strain" in name:
        return lambda value: f"{value:.2%}"
    return (lambda value: f"{value:.1f} s") if name.endswith("_s") else (lambda value: f"{value:.0f}")
