"""Exact predicates on a snapped grid of 2^26 steps across the longest extent (15 nm on one metre).

Snapped coordinates are whole numbers of at most 26 bits kept in float64. Products of two differences then fit the
53 bits of a float64 exactly, so `orient` needs no filter. `incircle` multiplies two such products: a static error
bound decides almost every call, and the rest is settled in integers with the digits split at 28 bits.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

__all__ = ["Frame", "incircle", "orient", "snap_frame"]

BITS = 26
_MASK = (1 << 28) - 1


class Frame(NamedTuple):
    """Where the grid lies: snapped = round((x - x0, y0 - y) * scale); y is turned up, so areas are positive."""

    x0: float
    y0: float
    scale: float

    def snap(self, points: np.ndarray) -> np.ndarray:
        """points: (n, 2) float64 [m], y down -> (n, 2) float64 holding whole numbers, y up."""
        snapped = np.zeros((len(points), 2))
        snapped[:, 0] = np.rint((points[:, 0] - self.x0) * self.scale)
        snapped[:, 1] = np.rint((self.y0 - points[:, 1]) * self.scale)
        return snapped


def snap_frame(points: np.ndarray) -> Frame:
    """The frame whose grid spans the bounding box of points: (n, 2) [m]; scale is a power of two."""
    low, high = points.min(axis=0), points.max(axis=0)
    extent = float((high - low).max())
    exponent = BITS - int(np.ceil(np.log2(extent))) if extent > 0 else 0
    return Frame(float(low[0]), float(high[1]), float(2.0**exponent))


@njit(cache=True)
def orient(ax, ay, bx, by, cx, cy):
    """Twice the signed area of a, b, c: > 0 where c lies left of a -> b. Exact for snapped coordinates."""
    return (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)


@njit(cache=True)
def incircle(ax, ay, bx, by, cx, cy, dx, dy):
    """Sign of d against the circle through a, b, c (counter-clockwise): 1 inside, 0 on it, -1 outside. Exact."""
    adx, ady, bdx, bdy, cdx, cdy = ax - dx, ay - dy, bx - dx, by - dy, cx - dx, cy - dy
    m1, s1 = bdx * cdy - bdy * cdx, adx * adx + ady * ady
    m2, s2 = cdx * ady - cdy * adx, bdx * bdx + bdy * bdy
    m3, s3 = adx * bdy - ady * bdx, cdx * cdx + cdy * cdy
    p1, p2, p3 = m1 * s1, m2 * s2, m3 * s3
    total = p1 + p2 + p3
    bound = 1e-15 * (abs(p1) + abs(p2) + abs(p3))  # three roundings of 1.1e-16 each, with room
    if total > bound:
        return 1
    if total < -bound:
        return -1
    return _exact_sign(m1, s1, m2, s2, m3, s3)


@njit(cache=True)
def _exact_sign(m1, s1, m2, s2, m3, s3):
    """Sign of m1 s1 + m2 s2 + m3 s3 for whole numbers below 2^55: schoolbook product in digits of 28 bits."""
    high, middle, low = np.int64(0), np.int64(0), np.int64(0)
    for m, s in ((m1, s1), (m2, s2), (m3, s3)):
        a, b = np.int64(m), np.int64(s)
        ah, al = a >> 28, a & _MASK
        bh, bl = b >> 28, b & _MASK
        high += ah * bh
        middle += ah * bl + al * bh
        low += al * bl
    middle += low >> 28
    low &= _MASK
    high += middle >> 28
    middle &= _MASK
    if high != 0:
        return 1 if high > 0 else -1
    return 1 if middle != 0 or low != 0 else 0
