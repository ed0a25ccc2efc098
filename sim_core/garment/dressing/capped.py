"""A worn garment as a solid: its openings capped, so that what lies over it has an inside and an outside."""

from __future__ import annotations

import numpy as np

from sim_core.errors import SimCoreError

__all__ = ["capped"]


def capped(vertices: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (V + L, 3) and faces of a mesh whose L border loops are closed by fans about their middles.

    Raises SimCoreError where the border is no set of loops.
    """
    ahead = faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2).astype(np.int64)
    key = ahead[:, 0] * len(vertices) + ahead[:, 1]
    free = ahead[~np.isin(key, ahead[:, 1] * len(vertices) + ahead[:, 0])]
    following = dict(zip(free[:, 0].tolist(), free[:, 1].tolist(), strict=True))
    if len(following) != len(free):
        raise SimCoreError("capped: the border touches itself – weld the garment first")
    middles, fans = [], []
    while following:
        first, at = next(iter(following.items()))
        loop = [first]
        del following[first]
        while at != first:
            loop.append(at)
            if at not in following:
                raise SimCoreError("capped: the border ends – the faces are wound unevenly")
            at = following.pop(at)
        centre = len(vertices) + len(middles)
        middles.append(vertices[loop].mean(0))
        ring = np.array(loop)
        fans.append(np.column_stack([np.roll(ring, -1), ring, np.full(len(ring), centre)]))
    if not middles:
        return vertices, faces
    return np.concatenate([vertices, middles]), np.concatenate([faces, *fans]).astype(np.int32)
