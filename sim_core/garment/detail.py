"""Levels of detail: the pattern meshed again, coarser, and the drape sampled where the new points lie."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.spatial import KDTree

from sim_core import metrics
from sim_core.cloth.contact import collide_samples, collide_vertices, contact_samples
from sim_core.cloth.sheet import face_edge_table
from sim_core.errors import SimCoreError
from sim_core.garment.model import Garment
from sim_core.garment.stand import Stand
from sim_core.mesh import panel_mesh

_SPACING = 0.006  # [m] of the samples that measure the distance of two levels


def detail(garment: Garment, edge: float) -> Garment:
    """The garment on a mesh of step `edge` [m], its distance from the original measured in the provenance.

    Texture coordinates and outline stay exact. Where a chord of the coarser mesh would cut into the stand,
    the mesh is moved out. Raises SimCoreError if the garment has seams (the pattern is meshed as one panel).
    """
    if len(garment.seams):
        raise SimCoreError(f"garment {garment.name}: has seams – levels of detail know single panels only")
    panel = panel_mesh(garment.outline, edge=edge)
    face, weight = locate(panel.vertices, garment.rest, garment.faces)
    positions = np.einsum("nk,nkc->nc", weight, garment.positions[garment.faces[face]])
    faces = panel.faces.astype(np.int32)
    if "stand" in garment.provenance:
        positions = _cleared(positions, faces, Stand(**garment.provenance["stand"]))
    apart = metrics.hausdorff(garment.positions, garment.faces, positions, faces, spacing=_SPACING)
    coarse = replace(garment, rest=panel.vertices, faces=faces, positions=positions)
    errors = {"mean_m": apart.mean, "p99_m": apart.p99, "max_m": apart.max}
    return coarse.noted(detail={"edge": edge, "triangles": len(faces), "hausdorff": errors})


def choose_detail(garment: Garment, budget: float, *, edges: Sequence[float] | None = None) -> Garment:
    """The cheapest level whose measured distance (p99) stays under `budget` [m], e.g. one pixel at the nearest view.

    edges: mesh steps to try, finest first until one fails (by default 1.25 to 4 times the garment's own).
    The garment itself is returned when none will do. The choice and all that was tried go into the provenance.
    """
    own = float(garment.provenance.get("edge", 0.0)) or _mean_edge(garment)
    tried: list[dict[str, float]] = []
    best, chosen = garment, {"edge": own, "triangles": len(garment.faces)}
    for edge in sorted(edges or own * np.array([1.25, 1.5, 1.8, 2.2, 2.7, 3.3, 4.0])):
        coarse = detail(garment, float(edge))
        facts = coarse.provenance["detail"]
        p99 = facts["hausdorff"]["p99_m"]
        tried.append({"edge": float(edge), "triangles": facts["triangles"], "p99_m": p99})
        if p99 > budget:
            break
        best, chosen = coarse, facts
    return best.noted(detail={**chosen, "budget_m": budget, "tried": tried})


def locate(points: np.ndarray, rest: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Face (N,) and barycentric weights (N, 3) of points (N, 2) in a flat mesh; nearest face at the border."""
    corner = rest[faces]
    tree = KDTree(corner.mean(1))
    count = min(24, len(faces))
    _, near = tree.query(points, k=count)
    near = near.reshape(len(points), count)
    a, b, c = (corner[near, k] for k in range(3))
    area = _cross(b - a, c - a)
    p = points[:, None]
    weight = (
        np.stack([_cross(b - p, c - p), _cross(c - p, a - p), _cross(a - p, b - p)], axis=-1)
        / area[..., None]
    )
    best = weight.min(-1).argmax(1)
    rows = np.arange(len(points))
    chosen = np.clip(weight[rows, best], 0.0, 1.0)
    return near[rows, best], chosen / chosen.sum(1, keepdims=True)


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def _mean_edge(garment: Garment) -> float:
    side = garment.rest[garment.faces] - garment.rest[np.roll(garment.faces, 1, axis=1)]
    return float(np.sqrt((side**2).sum(2)).mean())


def _cleared(positions: np.ndarray, faces: np.ndarray, stand: Stand) -> np.ndarray:
    """Moves a mesh off the stand until vertices, midpoints and centroids are 1 mm away; few vertices move."""
    x, v = positions.copy(), np.zeros_like(positions)
    edges, _ = face_edge_table(faces)
    vertices, middles = contact_samples(edges, faces, len(x))
    packed, free = stand.collider().packed(), np.ones(len(x))
    for _ in range(60):
        collide_samples(packed, free, x, v, middles, 0.001, 0.0005)
        collide_vertices(packed, free, x, v, vertices, 0.001, 1.0, 0.0, 0.0005)
        v[:] = 0.0
    return x
