"""Two selections to compare with: vertices at random, and each the farthest from those before it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sim_core.learn.pooling.pooled import Pooled, joined, protected_vertices, staying
from sim_core.learn.topology import checked_sheet

__all__ = ["farthest_points", "random_points"]


def random_points(
    rest: np.ndarray,
    faces: np.ndarray,
    share: float,
    seed: int | np.random.Generator,
    *,
    pins: Sequence[int] = (),
    border: bool = True,
) -> Pooled:
    """Border, pins and others at random, together less than a share of the vertices.

    rest: (V, 2) [m]; faces: (F, 3). Raises SimCoreError where border and pins alone are more.
    """
    rest, faces = checked_sheet(rest, faces)
    kept = protected_vertices(faces, len(rest), pins, border)
    most = staying(len(rest), share, kept)
    drawn = np.random.default_rng(seed).permutation(np.flatnonzero(~kept))
    kept[drawn[: most - kept.sum()]] = True
    return joined(rest, faces, kept)


def farthest_points(
    rest: np.ndarray, faces: np.ndarray, share: float, *, pins: Sequence[int] = (), border: bool = True
) -> Pooled:
    """Border, pins and then, one by one, the vertex that at rest is farthest from all kept (Gonzalez 1985).

    Without border and pins the first is the one farthest from the middle. Arguments and errors as of `random_points`.
    """
    rest, faces = checked_sheet(rest, faces)
    kept = protected_vertices(faces, len(rest), pins, border)
    most = staying(len(rest), share, kept)
    if not kept.any():
        kept[np.argmax(((rest - rest.mean(0)) ** 2).sum(1))] = True
    apart = np.full(len(rest), np.inf)
    for vertex in np.flatnonzero(kept):
        np.minimum(apart, ((rest - rest[vertex]) ** 2).sum(1), out=apart)
    while kept.sum() < most:
        vertex = int(np.argmax(apart))
        kept[vertex] = True
        np.minimum(apart, ((rest - rest[vertex]) ** 2).sum(1), out=apart)
    return joined(rest, faces, kept)
