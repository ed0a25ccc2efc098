"""Closest points of segments and of a point and a triangle, as compiled loops ask for them."""

from __future__ import annotations

from numba import njit


@njit(error_model="numpy", inline="always")
def at(x, i):
    """Row i of x (V, 3) as three numbers: a view would be counted, in loops that do little else."""
    return x[i, 0], x[i, 1], x[i, 2]


@njit(cache=True, error_model="numpy")
def segment_parameters(p1, q1, p2, q2):
    """Closest parameters (s, t) of the segments p1 q1 and p2 q2 (Ericson 2005, 5.1.9)."""
    d1x, d1y, d1z = q1[0] - p1[0], q1[1] - p1[1], q1[2] - p1[2]
    d2x, d2y, d2z = q2[0] - p2[0], q2[1] - p2[1], q2[2] - p2[2]
    rx, ry, rz = p1[0] - p2[0], p1[1] - p2[1], p1[2] - p2[2]
    a, e = d1x * d1x + d1y * d1y + d1z * d1z, d2x * d2x + d2y * d2y + d2z * d2z
    b, c = d1x * d2x + d1y * d2y + d1z * d2z, d1x * rx + d1y * ry + d1z * rz
    f = d2x * rx + d2y * ry + d2z * rz
    denominator = a * e - b * b
    s = 0.5
    if denominator > 1e-12 * a * e:
        s = min(1.0, max(0.0, (b * f - c * e) / denominator))
    t = (b * s + f) / e
    if t < 0.0:
        t, s = 0.0, min(1.0, max(0.0, -c / a))
    elif t > 1.0:
        t, s = 1.0, min(1.0, max(0.0, (b - c) / a))
    return s, t


@njit(cache=True, error_model="numpy")
def triangle_weights(p, a, b, c):
    """Barycentric weights of the point of triangle a b c closest to p (Ericson 2005, 5.1.5)."""
    abx, aby, abz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    acx, acy, acz = c[0] - a[0], c[1] - a[1], c[2] - a[2]
    x, y, z = p[0] - a[0], p[1] - a[1], p[2] - a[2]
    d1, d2 = abx * x + aby * y + abz * z, acx * x + acy * y + acz * z
    if d1 <= 0.0 and d2 <= 0.0:
        return 1.0, 0.0, 0.0
    x, y, z = p[0] - b[0], p[1] - b[1], p[2] - b[2]
    d3, d4 = abx * x + aby * y + abz * z, acx * x + acy * y + acz * z
    if d3 >= 0.0 and d4 <= d3:
        return 0.0, 1.0, 0.0
    vc = d1 * d4 - d3 * d2
    if vc <= 0.0 and d1 >= 0.0 and d3 <= 0.0:
        v = d1 / (d1 - d3)
        return 1.0 - v, v, 0.0
    x, y, z = p[0] - c[0], p[1] - c[1], p[2] - c[2]
    d5, d6 = abx * x + aby * y + abz * z, acx * x + acy * y + acz * z
    if d6 >= 0.0 and d5 <= d6:
        return 0.0, 0.0, 1.0
    vb = d5 * d2 - d1 * d6
    if vb <= 0.0 and d2 >= 0.0 and d6 <= 0.0:
        w = d2 / (d2 - d6)
        return 1.0 - w, 0.0, w
    va = d3 * d6 - d5 * d4
    if va <= 0.0 and d4 - d3 >= 0.0 and d5 - d6 >= 0.0:
        w = (d4 - d3) / ((d4 - d3) + (d5 - d6))
        return 0.0, 1.0 - w, w
    v, w = vb / (va + vb + vc), vc / (va + vb + vc)
    return 1.0 - v - w, v, w
