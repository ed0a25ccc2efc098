"""A limb that moves while cloth lies on it: a round-ended closed mesh, frame by frame, as `moving_mesh` takes it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sim_core.cloth.step.frame import FRAME

AROUND, TO_POLE = 24, 6  # vertices of a ring, rings from the middle of an end to its pole


def limb_mesh(length: float, radius: float) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (V, 3) [m] and faces (F, 3) of a limb along x from the origin, rounded at both ends."""
    up = np.linspace(0, np.pi / 2, TO_POLE + 1)[:-1]
    along = np.r_[-radius * np.sin(up[::-1]), length + radius * np.sin(up)]
    wide = radius * np.r_[np.cos(up[::-1]), np.cos(up)]
    angle = 2 * np.pi * np.arange(AROUND) / AROUND
    rings = np.stack(
        np.broadcast_arrays(along[:, None], np.outer(wide, np.cos(angle)), np.outer(wide, np.sin(angle))), -1
    )
    vertices = np.concatenate([rings.reshape(-1, 3), [[-radius, 0, 0], [length + radius, 0, 0]]])
    here, last = np.arange(AROUND), AROUND * (len(along) - 1)
    there, poles = (here + 1) % AROUND, len(vertices) - np.array([2, 1])
    faces = [np.column_stack([np.full(AROUND, poles[0]), there, here])]
    for ring in range(0, last, AROUND):
        a, b, c, d = ring + here, ring + there, ring + AROUND + here, ring + AROUND + there
        faces += [np.column_stack([a, b, c]), np.column_stack([b, d, c])]
    faces.append(np.column_stack([np.full(AROUND, poles[1]), last + here, last + there]))
    return vertices, np.concatenate(faces).astype(np.int32)


def limb_film(
    length: float,
    radius: float,
    *,
    swing: Sequence[float],
    turn: float,
    period: float,
    still: float,
    frames: int,
) -> tuple[np.ndarray, np.ndarray]:
    """The limb's vertices (frames + 1, V, 3) [m] at the start and after each frame, and its faces (F, 3).

    After `still` [s] it goes to and fro by swing (3,) [m], and is raised and lowered about its end at the origin by
    turn [degrees], once in a period [s]; it starts and stops gently.
    """
    vertices, faces = limb_mesh(length, radius)
    seconds = np.maximum(0.0, FRAME * np.arange(frames + 1) - still)
    share = 0.5 - 0.5 * np.cos(2 * np.pi * seconds / period)
    angle = np.radians(turn) * share
    c, s, x, y = np.cos(angle)[:, None], np.sin(angle)[:, None], vertices[:, 0], vertices[:, 1]
    turned = np.stack(
        [c * x - s * y, s * x + c * y, np.broadcast_to(vertices[:, 2], (len(share), len(x)))], -1
    )
    return turned + share[:, None, None] * np.asarray(swing, float), faces
