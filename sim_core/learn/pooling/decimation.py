"""The published pooling: the flattest local domains lose their middle vertex, pass after pass.

The paper (III.A) says: "only the vertices of the local domains with the smallest K-value are extracted until the
number of vertices is less than 60% of the original number of vertices", and "only one K-value calculation is performed
for each local domain". Its source (Jin et al. 2024) calls this decimation, so "extracted" is read as taken out: flat
vertices go and curved ones stay. (Keeping the smallest K instead leaves errors of 26 to 48 mm.) A local domain is a
vertex and its ring, and K belongs to the domain: the angle defect over its area, |K| meaned over the frames of
training, computed once, on the fine mesh. The domains of a pass have no vertex in common, "those with the smallest
K-value" are the flatter half of them, and after the pass the vertices that stand are joined anew. Border and pins are
never taken. Disjoint domains, the half and the joining anew are ours, since the paper does not say.

The half matters: with all domains of a pass every place is thinned alike and curvature hardly counts; the fewer go at
a time, the more a cloth that bends in places is spared there, and the worse one that bends everywhere comes off.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numba import njit

from sim_core.errors import SimCoreError
from sim_core.learn.pooling.pooled import Pooled, joined, protected_vertices, staying
from sim_core.learn.topology import checked_sheet, rings
from sim_core.validation import finite

__all__ = ["decimate"]


def decimate(
    rest: np.ndarray,
    faces: np.ndarray,
    curvature: np.ndarray,
    share: float = 0.6,
    *,
    pins: Sequence[int] = (),
    part: float = 0.5,
) -> Pooled:
    """The paper's pooling: less than a share of the vertices stays, border and pins among them.

    rest: (V, 2) [m]; faces: (F, 3); curvature: (V,) of `mean_absolute_curvature`. part: of the domains of a pass that
    lose their vertex, the flattest; equals go by their number. Every vertex that is taken out keeps a neighbour of its
    fine ring, as long as there are vertices to be had so; at a share of 0.6 there are. Raises SimCoreError where border
    and pins alone are more than the share.
    """
    rest, faces = checked_sheet(rest, faces)
    flatness = np.abs(np.asarray(curvature, float))
    if flatness.shape != (len(rest),) or not np.isfinite(flatness).all():
        raise SimCoreError(
            f"curvature: shape {flatness.shape} – one finite number for each of {len(rest)} vertices"
        )
    part = finite("part", part, above=0.0, most=1.0)
    protected = protected_vertices(faces, len(rest), pins, border=True)
    most = staying(len(rest), share, protected)
    order = np.argsort(flatness, kind="stable")
    order = order[~protected[order]]
    fine = rings(faces, len(rest))
    kept, covered = np.ones(len(rest), bool), True
    pooled = joined(rest, faces, kept)
    while kept.sum() > most:
        now = rings(pooled.kept[pooled.faces], len(rest))
        domains = _domains(order, kept, now, fine, covered)
        if len(domains):
            taken = max(1, min(round(part * len(domains)), int(kept.sum()) - most))
            kept[domains[:taken]] = False
            pooled = joined(rest, faces, kept)
        else:
            covered = False
    return pooled


@njit(cache=True)
def _domains(order, kept, now, fine, covered):
    """The middles of domains with no vertex in common, in order; `covered`: those alone that leave each a neighbour."""
    claimed, left = np.zeros(len(kept), np.bool_), kept.copy()
    found, count = np.zeros(len(order), np.int64), 0
    for v in order:
        alone = kept[v] and not claimed[v]
        for n in now.items[now.start[v] : now.start[v + 1]]:
            alone = alone and not claimed[n]
        if not alone or (covered and not _leaves_cover(v, left, fine)):
            continue
        claimed[v], left[v] = True, False
        claimed[now.items[now.start[v] : now.start[v + 1]]] = True
        found[count] = v
        count += 1
    return found[:count].copy()


@njit(cache=True)
def _leaves_cover(v, kept, fine):
    """Has v a kept neighbour, and has each of its neighbours that are gone another one than v?"""
    own = False
    for n in fine.items[fine.start[v] : fine.start[v + 1]]:
        if kept[n]:
            own = True
            continue
        other = False
        for m in fine.items[fine.start[n] : fine.start[n + 1]]:
            other = other or (m != v and kept[m])
        if not other:
            return False
    return own
