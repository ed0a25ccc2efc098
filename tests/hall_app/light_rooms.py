"""Small rooms with known light."""

import numpy as np

from hall_app.light import Surfaces

SIDES = (  # corners of a unit box, counter-clockwise from outside
    ((0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)),
    ((1, 0, 0), (0, 0, 0), (0, 1, 0), (1, 1, 0)),
    ((0, 0, 0), (0, 0, 1), (0, 1, 1), (0, 1, 0)),
    ((1, 0, 1), (1, 0, 0), (1, 1, 0), (1, 1, 1)),
    ((0, 1, 1), (1, 1, 1), (1, 1, 0), (0, 1, 0)),
    ((0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1)),
)


def quads(corners, *, albedo=0.0, emission=0.0, density=10.0, two_sided=False, charted=True) -> Surfaces:
    """Rectangles (Q, 4, 3) with a chart each; the options one value for all or one a rectangle."""
    corners = np.asarray(corners, float)
    count = len(corners)
    each = lambda value: np.broadcast_to(np.asarray(value), (count,))  # noqa: E731
    wide = np.linalg.norm(corners[:, 1] - corners[:, 0], axis=1)
    high = np.linalg.norm(corners[:, 3] - corners[:, 0], axis=1)
    zero = np.zeros(count)
    flat = np.stack([np.c_[zero, zero], np.c_[wide, zero], np.c_[wide, high], np.c_[zero, high]], 1)
    pick = np.array([[0, 1, 2], [0, 2, 3]])
    faces = (pick[None] + 4 * np.arange(count)[:, None, None]).reshape(-1, 3)
    kept = each(charted)
    numbers = np.where(kept, np.cumsum(kept) - 1, -1)
    grey = lambda value: np.repeat(np.repeat(each(value), 2)[:, None], 3, 1).astype(np.float32)  # noqa: E731
    return Surfaces(
        vertices=corners.reshape(-1, 3),
        faces=faces.astype(np.int32),
        chart=np.repeat(numbers, 2).astype(np.int32),
        chart_uv=flat[:, pick].reshape(-1, 3, 2),
        density=each(density)[kept].astype(float),
        albedo=grey(albedo),
        emission=grey(emission),
        two_sided=each(two_sided)[kept].astype(bool),
    )


def box(low, high, *, inward=False):
    """(6, 4, 3) sides of a box."""
    low, high = np.asarray(low, float), np.asarray(high, float)
    sides = low + np.array(SIDES, float) * (high - low)
    return sides[:, ::-1] if inward else sides


def level(x0, x1, z0, z1, y, *, up=True):
    """(4, 3) a level rectangle."""
    corners = np.array([[x0, y, z1], [x1, y, z1], [x1, y, z0], [x0, y, z0]], float)
    return corners if up else corners[::-1]
