"""Levels of detail: the drape thinned where it is flat, or its pattern meshed again, coarser, and sampled."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from scipy.spatial import KDTree

from sim_core import metrics
from sim_core.cloth import Solid
from sim_core.cloth.contact import Push, collide_samples, collide_vertices, contact_samples
from sim_core.cloth.sheet.sheet import face_edge_table
from sim_core.errors import SimCoreError
from sim_core.garment.garment import Garment
from sim_core.garment.levels.thinning import Thinning
from sim_core.garment.pattern.pattern import Pattern

SHARES = tuple(
    float(share) for share in np.geomspace(0.6, 0.05, 24).round(3)
)  # of the triangles, tried in turn
_SPACING = 0.006  # [m] of the samples that measure the distance of two levels
_TRYING = 0.016  # [m] the same while levels are tried; a seventh of the samples


def detail(
    garment: Garment, edge: float, *, solid: Solid | None = None, spacing: float = _SPACING
) -> Garment:
    """The garment on a mesh of step `edge` [m]; its distance from the original, measured every `spacing` [m], is noted.

    Texture coordinates and outlines stay exact, and twins on a welded seam stay in one place. Where a chord of the
    coarser mesh would cut into the stand, or into `solid`, the mesh is moved out. Raises SimCoreError where the
    garment does not tell how it was cut.
    """
    if not garment.cut:
        raise SimCoreError(f"garment {garment.name}: does not tell how it was cut – bake it again")
    coarse = _sampled(garment, Pattern.from_dict(garment.cut), edge)
    if solid is None and garment.settled is not None and garment.settled.beneath.stand is not None:
        solid = garment.settled.beneath.solid()
    if solid is not None:
        coarse = replace(coarse, positions=_cleared(coarse.positions, coarse.faces, solid))
    return _measured(garment, coarse, spacing, edge=edge)


def _sampled(garment: Garment, pattern: Pattern, edge: float) -> Garment:
    """The pattern meshed again; every new point where the drape has it, twins at their mean."""
    cloth = pattern.whole(pattern.cloth(edge))
    vertices, faces, panel = cloth.vertices, cloth.faces, cloth.panel
    owner, weld = cloth.panel_of, cloth.closed
    worn, out = garment.worn(), np.zeros((len(vertices), 3))
    for number in range(len(garment.panels)):
        own = garment.pattern_faces[garment.panel == number]
        new = np.flatnonzero(owner == number)
        face, weight = locate(vertices[new], garment.pattern, own)
        out[new] = np.einsum("nk,nkc->nc", weight, worn[own[face]])
    count = np.bincount(weld)
    mean = np.stack([np.bincount(weld, out[:, c]) / count for c in range(3)], axis=1)
    return replace(garment, pattern=vertices, pattern_faces=faces, weld=weld, panel=panel, positions=mean)


def thinned(
    garment: Garment, counts: Sequence[int], *, solid: Solid | None = None, spacing: float = _SPACING
) -> Iterator[Garment]:
    """The garment with about each of `counts` triangles, the largest first, its distance measured every `spacing` [m].

    Triangles go where the drape is flat (see `thinning`); what stays keeps place and texture coordinates. Of a
    mirrored garment one half is thinned and mirrored. The last one may come again when nothing more can go.
    """
    pattern = Pattern.from_dict(garment.cut) if garment.cut else None
    twice = 2 if pattern is not None and pattern.mirror else 1
    vertices, faces = len(garment.pattern) // twice, len(garment.pattern_faces) // twice
    own, weld = np.unique(garment.weld[:vertices], return_inverse=True)
    mesh = Thinning(
        garment.positions[own], garment.pattern_faces[:faces], weld.reshape(-1), garment.pattern[:vertices]
    )
    if solid is None and garment.settled is not None and garment.settled.beneath.stand is not None:
        solid = garment.settled.beneath.solid()
    for count in sorted(counts, reverse=True):
        mesh.to(count // twice)
        left, index = mesh.faces(), mesh.numbers()
        if twice == 2:
            left = np.concatenate([left, left[:, [0, 2, 1]] + vertices])
            index = np.concatenate([index, index + faces])
        coarse = _kept(garment, left.astype(np.int32), garment.panel[index], solid)
        yield _measured(garment, coarse, spacing)


def _kept(garment: Garment, faces: np.ndarray, panel: np.ndarray, solid: Solid | None) -> Garment:
    """The garment with these faces of its pattern vertices alone."""
    used, new = np.unique(faces, return_inverse=True)
    own, weld = np.unique(garment.weld[used], return_inverse=True)
    coarse = replace(
        garment,
        pattern=garment.pattern[used],
        pattern_faces=new.reshape(-1, 3).astype(np.int32),
        weld=weld.reshape(-1).astype(np.int32),
        panel=panel,
        positions=garment.positions[own],
    )
    if solid is not None:
        coarse = replace(coarse, positions=_cleared(coarse.positions, coarse.faces, solid))
    return coarse


def _measured(garment: Garment, coarse: Garment, spacing: float, **facts: float) -> Garment:
    """The coarse level with its size and its distance from the garment noted."""
    apart = metrics.hausdorff(
        garment.positions, garment.faces, coarse.positions, coarse.faces, spacing=spacing
    )
    errors = {"mean_m": apart.mean, "p99_m": apart.p99, "max_m": apart.max}
    return coarse.noted(detail={**facts, "triangles": len(coarse.faces), "hausdorff": errors})


def choose_detail(
    garment: Garment,
    budget: float,
    *,
    edges: Sequence[float] | None = None,
    solid: Solid | None = None,
) -> Garment:
    """The cheapest level whose measured distance (p99) stays under `budget` [m], e.g. one pixel at the nearest view.

    The garment is thinned by steps until it fails; with `edges`, mesh steps [m], it is meshed again instead, finest
    first. Levels are tried on few samples and the chosen one is measured again on many; where it fails then, the
    level before it is taken. The garment itself is returned when none will do. The choice and all that was tried go
    into the provenance.
    """
    if edges is None:
        counts = [round(len(garment.faces) * share) for share in SHARES]
        levels = thinned(garment, counts, solid=solid, spacing=_TRYING)
    else:
        levels = (detail(garment, float(edge), solid=solid, spacing=_TRYING) for edge in sorted(edges))
    tried: list[dict[str, float]] = []
    fitting: list[Garment] = []
    for coarse in levels:
        facts = coarse.provenance["detail"]
        p99 = facts["hausdorff"]["p99_m"]
        tried.append({**{k: v for k, v in facts.items() if k != "hausdorff"}, "p99_m": p99})
        if p99 > budget:
            break
        fitting.append(coarse)
    for coarse in reversed(fitting):
        facts = dict(coarse.provenance["detail"])
        edge = {"edge": facts["edge"]} if "edge" in facts else {}
        best = _measured(garment, coarse, _SPACING, **edge)
        if best.provenance["detail"]["hausdorff"]["p99_m"] <= budget:
            chosen = best.provenance["detail"]
            return best.noted(detail={**chosen, "budget_m": budget, "tried": tried})
    return garment.noted(detail={"triangles": len(garment.faces), "budget_m": budget, "tried": tried})


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


def _cleared(positions: np.ndarray, faces: np.ndarray, solid: Solid) -> np.ndarray:
    """Moves a mesh off the solid until vertices, midpoints and centroids are 1 mm away; few vertices move."""
    x, v = positions.copy(), np.zeros_like(positions)
    edges, _ = face_edge_table(faces)
    vertices, middles = contact_samples(edges, faces, len(x))
    packed, free = solid.packed(), np.ones(len(x))
    push = Push(clearance=0.001, cap=0.0005, friction=0.0, dt=1.0)
    for _ in range(60):
        collide_samples(packed, free, x, v, middles, push)
        collide_vertices(packed, free, x, v, vertices, push)
        v[:] = 0.0
    return x
