"""The cheap figures of a baked garment measured again from the files that are shipped, whatever its record says."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hall_app.content.models.glb import accessor, open_glb, read_glb
from hall_app.content.schema.exhibit import GarmentRecipe

if TYPE_CHECKING:
    from sim_core.garment import Garment

__all__ = ["Cloth", "Measured", "cloth_in", "cloth_figures", "measured_again", "thinned_figures"]

Floats = NDArray[np.float64]
Solid = tuple[Floats, NDArray[np.int32]]
FINE, COARSE = (
    0.006,
    0.016,
)  # [m] between the samples of two levels: as the bake measures, and a seventh of them
SHOWN = 1e-5  # [m] what single precision may move a vertex


@dataclass(frozen=True)
class Cloth:
    """A welded cloth: positions (V, 3) [m], faces (F, 3) int32, rest (F, 3, 2) [m], the flat corners of each face."""

    positions: Floats
    faces: NDArray[np.int32]
    rest: Floats


@dataclass(frozen=True)
class Measured:
    """digest: of the simulated garment's arrays; figures: name -> value; faults: what the files contradict each
    other in, in words."""

    digest: str
    figures: dict[str, float]
    faults: tuple[str, ...]


def cloth_in(path: Path, name: str) -> Cloth:
    """The cloth of that name in a model (its nodes `name`, `name 2`, …), twins on seams welded by their place.

    Raises ValueError where the model has none; GlbError, KeyError, IndexError or TypeError where it is broken.
    """
    document, binary = open_glb(path)
    places, faces, flat, count = [], [], [], 0
    for node in document["nodes"]:
        if "mesh" not in node or not _named(str(node.get("name", "")), name):
            continue
        for part in document["meshes"][node["mesh"]]["primitives"]:
            own = accessor(document, binary, part["attributes"]["POSITION"])
            places.append(own)
            faces.append(accessor(document, binary, part["indices"]).astype(int).reshape(-1, 3) + count)
            flat.append(accessor(document, binary, part["attributes"]["TEXCOORD_0"]) / 1000)
            count += len(own)
    if not places:
        raise ValueError(f"{path.name} holds no {name!r}")
    positions, weld = np.unique(np.concatenate(places), axis=0, return_inverse=True)
    corners = np.concatenate(faces)
    return Cloth(
        positions, weld.reshape(-1)[corners].astype(np.int32), np.concatenate(flat)[corners].astype(float)
    )


def _named(node: str, name: str) -> bool:
    return node == name or (node.startswith(f"{name} ") and node.removeprefix(f"{name} ").isdigit())


def cloth_figures(cloth: Cloth, solids: list[Solid], *, mirrored: bool) -> dict[str, float]:
    """What any cloth is asked: inside solids, strain, self-intersections; of a mirrored one, how its halves differ."""
    from scipy.spatial import KDTree

    from sim_core import metrics

    found = [metrics.penetration(cloth.positions, cloth.faces, *solid) for solid in solids]
    strain = np.abs(metrics.area_strain(cloth.rest, cloth.positions, cloth.faces))
    figures: dict[str, float] = {
        f"inside_{what}": sum(getattr(one, what) for one in found)
        for what in ("vertices", "midpoints", "centroids")
    }
    figures["area_strain_p95"] = float(np.percentile(strain, 95))
    figures["area_strain_max"] = float(strain.max())
    figures["self_intersections"] = metrics.intersections(cloth.positions, cloth.faces)
    if mirrored:
        away, _ = KDTree(cloth.positions).query(cloth.positions * [-1.0, 1.0, 1.0])
        figures["asymmetry_m"] = float(np.max(away))
    return figures


def thinned_figures(close: Cloth, hall: Cloth, *, spacing: float = FINE) -> dict[str, float]:
    """Distance [m] of a cloth's hall model from its close one, sampled every `spacing` [m]: mean, p99, max."""
    from sim_core import metrics

    apart = metrics.hausdorff(close.positions, close.faces, hall.positions, hall.faces, spacing=spacing)
    return {f"hall_hausdorff_{name}": getattr(apart, name) for name in ("mean", "p99", "max")}


def robe_beneath(folder: Path, robe: str, lift: float, body: Solid) -> tuple[dict[str, float], Cloth]:
    """Figures of the robe a scarf lies on, named robe_…, and the robe as simulated (its models stand `lift` [m] up)."""
    close, hall = cloth_in(folder / "close.glb", robe), cloth_in(folder / "hall.glb", robe)
    worn = Cloth(close.positions - [0.0, lift, 0.0], close.faces, close.rest)
    figures = cloth_figures(worn, [body], mirrored=True) | thinned_figures(close, hall)
    return {f"robe_{name}": value for name, value in figures.items()}, worn


def measured_again(root: Path, table: GarmentRecipe, folder: Path) -> Measured:
    """Measure the bake in `folder` of the recipe `table`, whose files lie under `root`.

    Raises SimCoreError, GlbError, ValueError, KeyError, IndexError, TypeError or OSError for files that cannot be read.
    """
    from sim_core.garment import Garment
    from sim_core.garment.levels.figure import BASE

    garment = Garment.load(folder / "garment.npz")
    cloth = Cloth(garment.positions, garment.faces, garment.rest_corners())
    solids, under = _solids(root, table, garment), {}
    lift = BASE[1] if table.mannequin else 0.0
    if table.robe_pattern is not None:
        from sim_core.garment import Pattern
        from sim_core.garment.recipes.worn_solid import capped

        name = Pattern.load(root / table.robe_pattern).name
        under, robe = robe_beneath(folder, name, lift, solids[0])
        solids.append(capped(robe.positions, robe.faces))
    figures = cloth_figures(cloth, solids, mirrored=bool(garment.cut.get("mirror"))) | under
    shown, hall = cloth_in(folder / "close.glb", garment.name), cloth_in(folder / "hall.glb", garment.name)
    figures |= thinned_figures(shown, hall, spacing=COARSE)
    figures["triangles"], figures["vertices"] = len(garment.faces), len(garment.positions)
    figures["hall_triangles"] = len(hall.faces)
    figures["hall_all_triangles"] = read_glb(folder / "hall.glb").triangles
    return Measured(garment.digest(), figures, _contradictions(garment, shown, lift))


def _solids(root: Path, table: GarmentRecipe, garment: Garment) -> list[Solid]:
    """What the cloth hangs on: the posed figure, or the stand."""
    if table.mannequin is not None:
        from sim_core.body.mannequin import Mannequin
        from sim_core.body.pose import Pose

        figure = Mannequin.load(root / table.mannequin)
        return [(figure.posed(Pose.arms(table.arm, table.elbow)), figure.faces)]
    from sim_core.garment import Stand

    return [Stand(**garment.provenance["stand"]).mesh(48)]


def _contradictions(garment: Garment, shown: Cloth, lift: float) -> tuple[str, ...]:
    """Whether the close model shows the simulated garment, vertex by vertex."""
    from scipy.spatial import KDTree

    away, _ = KDTree(garment.positions + [0.0, lift, 0.0]).query(shown.positions)
    if len(shown.faces) == len(garment.faces) and float(np.max(away)) < SHOWN:
        return ()
    return (
        f"close.glb shows another cloth than garment.npz (up to {1000 * float(np.max(away)):.1f} mm away)",
    )
