"""The cheap figures of a baked garment measured again from the files that are shipped, whatever its record says."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hall_app.check.garments.limits import Worn
from hall_app.content.bakes.store import layer_files
from hall_app.content.models.glb import open_glb, read_glb

if TYPE_CHECKING:
    from sim_core.body import Beneath
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
    """digests: of the simulated garments' arrays, from the skin outwards; worn: what they are; figures: name -> value;
    faults: what the files contradict each other in, in words."""

    digests: tuple[str, ...]
    worn: tuple[Worn, ...]
    figures: dict[str, float]
    faults: tuple[str, ...]


def cloth_in(path: Path, name: str) -> Cloth:
    """The cloth of that name in a model (its nodes `name`, `name 2`, …), twins on seams welded by their place.

    Raises ValueError where the model has none; GlbError, KeyError, IndexError or TypeError where it is broken.
    """
    parts = open_glb(path)
    document = parts.document
    places, faces, flat, count = [], [], [], 0
    for node in document["nodes"]:
        if "mesh" not in node or not _named(str(node.get("name", "")), name):
            continue
        for part in document["meshes"][node["mesh"]]["primitives"]:
            own = parts.numbers(part["attributes"]["POSITION"])
            places.append(own)
            faces.append(parts.numbers(part["indices"]).astype(int).reshape(-1, 3) + count)
            flat.append(parts.numbers(part["attributes"]["TEXCOORD_0"]) / 1000)
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


def cloth_figures(cloth: Cloth, solids: list[Solid], *, half: bool) -> dict[str, float]:
    """What any cloth is asked: inside solids, strain, crossings; of one half and its image, how they differ."""
    from scipy.spatial import KDTree

    from sim_core import metrics

    found = [metrics.penetration(cloth.positions, cloth.faces, *solid) for solid in solids]
    strain = np.abs(metrics.area_strain(cloth.rest, cloth.positions, cloth.faces))
    figures: dict[str, float] = {
        f"inside_{what}": sum(getattr(one, what) for one in found)
        for what in ("vertices", "midpoints", "centroids", "edges")
    }
    figures["area_strain_p95"] = float(np.percentile(strain, 95))
    figures["area_strain_max"] = float(strain.max())
    figures["self_intersections"] = metrics.intersections(cloth.positions, cloth.faces)
    if half:
        away, _ = KDTree(cloth.positions).query(cloth.positions * [-1.0, 1.0, 1.0])
        figures["asymmetry_m"] = float(np.max(away))
    return figures


def thinned_figures(close: Cloth, hall: Cloth, *, spacing: float = FINE) -> dict[str, float]:
    """Distance [m] of a cloth's hall model from its close one, sampled every `spacing` [m]: mean, p99, max."""
    from sim_core import metrics

    apart = metrics.hausdorff(close.positions, close.faces, hall.positions, hall.faces, spacing=spacing)
    return {f"hall_hausdorff_{name}": getattr(apart, name) for name in ("mean", "p99", "max")}


def measured_again(folder: Path, count: int) -> Measured:
    """Measure the bake in `folder` of an outfit of `count` layers, from the garments and models that are shipped.

    Figures of what is worn beneath bear its name: robe_self_intersections. Raises SimCoreError, GlbError, ValueError,
    KeyError, IndexError, TypeError or OSError for files that cannot be read.
    """
    from sim_core.garment import Garment

    garments = [Garment.load(folder / name) for name in layer_files(count)]
    figures: dict[str, float] = {}
    worn: list[Worn] = []
    faults: list[str] = []
    for number, garment in enumerate(garments, 1):
        beneath = number < count
        worn.append(Worn.of(garment, beneath=beneath))
        own, fault = _layer_figures(folder, garment, worn[-1])
        figures |= {f"{garment.name}_{name}" if beneath else name: value for name, value in own.items()}
        faults += fault
    hall = read_glb(folder / "hall.glb")
    figures["hall_all_triangles"] = hall.triangles - hall.afar
    return Measured(tuple(g.digest() for g in garments), tuple(worn), figures, tuple(faults))


def _layer_figures(folder: Path, garment: Garment, worn: Worn) -> tuple[dict[str, float], tuple[str, ...]]:
    """The figures of one garment, and where its models contradict it."""
    from sim_core.garment.levels.figure import BASE

    if garment.settled is None:
        raise ValueError(f"{garment.name} does not say what it lies on")
    cloth = Cloth(garment.positions, garment.faces, garment.rest_corners())
    figures = cloth_figures(cloth, _solids(garment.settled.beneath), half=worn.half)
    shown, hall = (cloth_in(folder / name, garment.name) for name in ("close.glb", "hall.glb"))
    figures |= thinned_figures(shown, hall, spacing=FINE if worn.beneath else COARSE)
    figures["triangles"], figures["vertices"] = len(garment.faces), len(garment.positions)
    figures["hall_triangles"] = len(hall.faces)
    return figures, _contradictions(garment, shown, 0.0 if worn.on_stand else BASE[1])


def _solids(beneath: Beneath) -> list[Solid]:
    """What the cloth lies on: the stand, or the posed figure and what it wears already."""
    if beneath.stand is not None:
        return [beneath.stand.mesh(48)]
    return [(surface.vertices, surface.faces) for surface in beneath.surfaces]


def _contradictions(garment: Garment, shown: Cloth, lift: float) -> tuple[str, ...]:
    """Whether the close model shows the simulated garment, vertex by vertex."""
    from scipy.spatial import KDTree

    away, _ = KDTree(garment.positions + [0.0, lift, 0.0]).query(shown.positions)
    if len(shown.faces) == len(garment.faces) and float(np.max(away)) < SHOWN:
        return ()
    what = (
        f"another cloth than {garment.name!r} was simulated (up to {1000 * float(np.max(away)):.1f} mm away)"
    )
    return (f"close.glb shows {what}",)
