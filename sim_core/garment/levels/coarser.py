"""Levels of detail: the drape thinned where it is flat, as far as what is seen of it allows."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from typing import Any

import numpy as np

from sim_core import metrics
from sim_core.cloth import Solid
from sim_core.cloth.contact import Push, collide_samples, collide_vertices, contact_samples
from sim_core.cloth.sheet.sheet import face_edge_table
from sim_core.garment.garment import Garment
from sim_core.garment.levels.thinning import Thinning, moment_of
from sim_core.garment.pattern.pattern import Pattern

SHARES = tuple(
    float(share) for share in np.geomspace(0.6, 0.05, 24).round(3)
)  # of the triangles, tried in turn
STRIDE = 4
FITTED = 7  # moments from one that a mesh is fitted to, on to the next
TRIED = slice(
    3, None, 14
)  # moments between these that tell of a level that is tried; of the chosen one all do
MIRRORED = np.array([-1.0, 1.0, 1.0])
_SPACING = 0.006  # [m] of the samples that measure the distance of two levels
_TRYING = 0.016  # [m] the same while levels are tried; a seventh of the samples


@dataclass(frozen=True)
class _Level:
    """A thinned garment, and which vertices (V,) of the fine one it has kept."""

    garment: Garment
    kept: np.ndarray


def thinned(garment: Garment, counts: Sequence[int], moments: Sequence[np.ndarray] = ()) -> Iterator[_Level]:
    """The garment with about each of `counts` triangles, the largest first.

    Triangles go where the drape is flat (see `thinning`), and stays so in `moments`, where its vertices (V, 3) [m] are
    at other times; what stays keeps place and texture coordinates. Of a garment whose halves are cut alike one
    is thinned and mirrored, as it moves on either side. The last one may come again when nothing more can go.
    """
    pattern = Pattern.from_dict(garment.cut) if garment.cut else None
    twice = 2 if pattern is not None and pattern.alike else 1
    vertices, faces = len(garment.pattern) // twice, len(garment.pattern_faces) // twice
    own, weld = np.unique(garment.weld[:vertices], return_inverse=True)
    moved = [places[own] for places in moments]
    if twice == 2:
        across = np.zeros(len(garment.positions), np.int64)
        across[garment.weld[:vertices]] = garment.weld[vertices:]
        moved += [places[across[own]] * MIRRORED for places in moments]
    mesh = Thinning(
        garment.positions[own],
        garment.pattern_faces[:faces],
        weld.reshape(-1),
        garment.pattern[:vertices],
        moments=moved,
    )
    for count in sorted(counts, reverse=True):
        mesh.to(count // twice)
        left, index = mesh.faces(), mesh.numbers()
        if twice == 2:
            left = np.concatenate([left, left[:, [0, 2, 1]] + vertices])
            index = np.concatenate([index, index + faces])
        yield _kept(garment, left.astype(np.int32), garment.panel[index])


def _kept(garment: Garment, faces: np.ndarray, panel: np.ndarray) -> _Level:
    """The garment with these faces of its pattern vertices alone."""
    used, new = np.unique(faces, return_inverse=True)
    own, weld = np.unique(garment.weld[used], return_inverse=True)
    level = replace(
        garment,
        pattern=garment.pattern[used],
        pattern_faces=new.reshape(-1, 3).astype(np.int32),
        weld=weld.reshape(-1).astype(np.int32),
        panel=panel,
        positions=garment.positions[own],
    )
    return _Level(level, own)


def _measured(garment: Garment, level: _Level, spacing: float, moments: Sequence[np.ndarray]) -> _Level:
    """The level with its size and its distance from the garment noted, as it stands and as it moves."""
    coarse = level.garment
    apart = metrics.hausdorff(
        garment.positions, garment.faces, coarse.positions, coarse.faces, spacing=spacing
    )
    errors = {"mean_m": apart.mean, "p99_m": apart.p99, "max_m": apart.max}
    detail: dict[str, Any] = {"triangles": len(coarse.faces), "hausdorff": errors}
    if len(moments):
        detail["moving_p99_m"] = max(
            metrics.hausdorff(x, garment.faces, x[level.kept], coarse.faces, spacing=2 * spacing).p99
            for x in moments
        )
    return replace(level, garment=coarse.noted(detail=detail))


def _off(level: _Level) -> float:
    """How far (p99) a measured level is from the garment [m], at its worst."""
    detail = level.garment.provenance["detail"]
    return max(detail["hausdorff"]["p99_m"], detail.get("moving_p99_m", 0.0))


def choose_detail(
    garment: Garment, budget: float, *, solid: Solid | None = None, moments: Sequence[np.ndarray] = ()
) -> Garment:
    """The cheapest level whose measured distance (p99) stays under `budget` [m], e.g. one pixel at the nearest view.

    moments: where the vertices (V, 3) [m] of a garment that moves are, frame by frame: it stays under it in all of
    them, though of more than seven only every seventh is what the mesh is fitted to.

    The garment is thinned by steps, of which every STRIDE-th is measured until one fails, and then those between it and
    the last that did not, halving what is left. Levels are tried on few samples and the chosen one is measured again on
    many; where it fails then, the level before it is taken. The garment itself is returned when none will do. Where a
    chord would cut into the stand, or into `solid`, the mesh is moved out. The choice and all that was tried go into
    the provenance. Raises SimCoreError for a moment of other vertices, or not finite.
    """
    counts = [round(len(garment.faces) * share) for share in SHARES]
    moments = [moment_of(number, places, len(garment.positions)) for number, places in enumerate(moments)]
    fitted = moments[::FITTED] if len(moments) > FITTED else moments
    thinner, levels = thinned(garment, counts, fitted), list[_Level]()
    if solid is None and garment.settled is not None and garment.settled.beneath.stand is not None:
        solid = garment.settled.beneath.solid()
    tried: list[dict[str, float]] = []
    fits, fails = -1, len(counts)
    while fails - fits > 1:
        number = (fits + fails) // 2 if fails < len(counts) else min(fits + STRIDE, fails - 1)
        levels.extend(islice(thinner, max(0, number + 1 - len(levels))))
        levels[number] = _measured(
            garment, _cleared(levels[number], solid), _TRYING, moments[TRIED] or moments
        )
        tried.append({"triangles": len(levels[number].garment.faces), "p99_m": _off(levels[number])})
        if tried[-1]["p99_m"] > budget:
            fails = number
        else:
            fits = number
    tried.sort(key=lambda one: -one["triangles"])
    for coarse in reversed(levels[: fits + 1]):
        best = _measured(garment, _cleared(coarse, solid), _SPACING, moments)
        if _off(best) <= budget:
            chosen = best.garment.provenance["detail"]
            return best.garment.noted(detail={**chosen, "budget_m": budget, "tried": tried})
    itself: dict[str, Any] = {"triangles": len(garment.faces), "budget_m": budget, "tried": tried}
    return garment.noted(detail=itself | ({"moving_p99_m": 0.0} if len(moments) else {}))


def _cleared(level: _Level, solid: Solid | None) -> _Level:
    """Its mesh moved off the solid until vertices, midpoints and centroids are 1 mm away; few vertices move."""
    if solid is None:
        return level
    garment = level.garment
    x, v = garment.positions.copy(), np.zeros_like(garment.positions)
    edges, _ = face_edge_table(garment.faces)
    vertices, middles = contact_samples(edges, garment.faces, len(x))
    packed, free = solid.packed(), np.ones(len(x))
    push = Push(clearance=0.001, cap=0.0005, friction=0.0, dt=1.0)
    for _ in range(60):
        collide_samples(packed, free, x, v, middles, push)
        collide_vertices(packed, free, x, v, vertices, push)
        v[:] = 0.0
    return replace(level, garment=replace(garment, positions=x))
