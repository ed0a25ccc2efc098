"""The figures a visitor may be told of a dressed garment, all from `sim_core.metrics`, both halves together."""

from __future__ import annotations

from typing import Any

import numpy as np

from sim_core import metrics
from sim_core.body import Beneath
from sim_core.cloth import Drape
from sim_core.cloth.run import RESTED
from sim_core.garment.dressing.order import layer_order
from sim_core.garment.garment import Garment
from sim_core.garment.outfit import Layer
from sim_core.garment.pattern import SIDES, Cloth, Pattern

__all__ = ["mass", "measured", "seam_gap", "unrest"]


def unrest(run: Drape) -> dict[str, float]:
    """How far [m] cloth moves in a frame at the end of a run: the worst of the frames that were to be at rest."""
    p99, most = np.max(run.trace[-RESTED:], axis=0)
    return {"rest_p99_m": float(p99), "rest_max_m": float(most)}


def measured(garment: Garment, layer: Layer) -> dict[str, Any]:
    """Inside of what lies beneath, strain, crossings of itself and of the wrong order, seams' gap and greatest ease,
    how halves differ."""
    assert garment.settled is not None
    found = [
        metrics.penetration(garment.positions, garment.faces, *solid)
        for solid in _solids(garment.settled.beneath)
    ]
    strain = np.abs(metrics.area_strain(garment.rest_corners(), garment.positions, garment.faces))
    errors: dict[str, Any] = {
        "inside_vertices": sum(f.vertices for f in found),
        "inside_midpoints": sum(f.midpoints for f in found),
        "inside_centroids": sum(f.centroids for f in found),
        "inside_edges": sum(f.edges for f in found),
        "clearance_m": [min(f.clearance[k] for f in found) for k in range(3)],
        "area_strain_p95": float(np.percentile(strain, 95)),
        "area_strain_max": float(strain.max()),
        "self_intersections": metrics.intersections(garment.positions, garment.faces),
        "layer_order": layer_order(garment, layer.place),
    }
    if garment.settled.beneath.floor:
        errors["inside_vertices"] += int((garment.positions[:, 1] < 0.0).sum())
    errors["mass_kg"] = mass(garment)
    if layer.pattern.seams:
        errors["seam_gap_m"] = seam_gap(garment, layer.cloth)
        errors["seam_ease"] = max((fit.ease for fit in layer.cut.fits), default=0.0)
    if layer.pattern.alike:
        worn = garment.worn()
        half = len(worn) // 2
        away = np.linalg.norm(worn[half:] - worn[:half] * [-1.0, 1.0, 1.0], axis=1)
        errors["asymmetry_m"] = float(away.max())
    return errors


def mass(garment: Garment) -> float:
    """Of the cut cloth [kg]: area of its panels times what their material weighs."""
    kinds, panels = garment.material["kinds"], garment.material["panels"]
    names = [panel["name"] for panel in garment.cut.get("panels") or [{"name": "cloth"}]]
    density = np.array([float(kinds[panels[name]]["density"]) for name in names])
    a, b = (garment.rest_corners()[:, k] - garment.rest_corners()[:, 0] for k in (1, 2))
    area = 0.5 * np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
    return float(area @ density[garment.panel % len(names)])


def _solids(beneath: Beneath) -> list[tuple[np.ndarray, np.ndarray]]:
    """Closed meshes that the cloth lies on, as they are shown."""
    if beneath.stand is not None:
        return [beneath.stand.mesh(48)]
    return [(surface.vertices, surface.faces) for surface in beneath.surfaces]


def seam_gap(garment: Garment, cloth: Cloth) -> float:
    """Largest distance [m] between the two sides of any seam, as draped, of a garment of this whole cloth."""
    pattern = Pattern.from_dict(garment.cut)
    sides = SIDES if pattern.mirror else ("",)
    worn, gaps = garment.worn(), [0.0]
    for seam in pattern.seams:
        panels = pattern.panel(seam.a.panel), pattern.panel((seam.b or seam.a).panel)
        own = [side for side in sides if all(panel.is_of(side.strip() or panel.side) for panel in panels)]
        first = [cloth.along(seam.a, panels[0], side) for side in own]
        second = first[::-1] if seam.b is None else [cloth.along(seam.b, panels[1], side) for side in own]
        gaps += [
            float(np.linalg.norm(worn[a] - worn[b], axis=1).max()) for a, b in zip(first, second, strict=True)
        ]
    return max(gaps)
