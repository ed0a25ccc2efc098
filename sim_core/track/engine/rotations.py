"""Rotations of many bones at once: by SVD, as quaternions (real part first), and along the shortest arc."""

from __future__ import annotations

import math

import numpy as np

__all__ = ["arcs", "column", "kabsch", "product", "quaternion_of", "square", "turned"]


def square(vectors):
    """Squared lengths (N,) of vectors (N, 3)."""
    return vectors[:, 0] ** 2 + vectors[:, 1] ** 2 + vectors[:, 2] ** 2


def column(values):
    """Values (N,) as a column (N, 1) that goes beside vectors."""
    return values.reshape(values.size, 1)


def kabsch(covariance):
    """The rotation (3, 3) that a covariance H (3, 3) = sum w b a' asks for, never a mirror image (Eq. 13-14)."""
    u, _, vh = np.linalg.svd(covariance)
    turn = np.dot(vh.T, u.T)
    if np.linalg.det(turn) < 0.0:
        vh[2] = -vh[2]
        turn = np.dot(vh.T, u.T)
    return turn


def product(a, b):
    """Products (N, 4) of quaternions (N, 4): the rotations b, then a."""
    aw, ax, ay, az = a[:, 0], a[:, 1], a[:, 2], a[:, 3]
    bw, bx, by, bz = b[:, 0], b[:, 1], b[:, 2], b[:, 3]
    out = np.zeros((len(b), 4))
    out[:, 0] = aw * bw - ax * bx - ay * by - az * bz
    out[:, 1] = aw * bx + ax * bw + ay * bz - az * by
    out[:, 2] = aw * by - ax * bz + ay * bw + az * bx
    out[:, 3] = aw * bz + ax * by - ay * bx + az * bw
    return out


def turned(q, v):
    """Vectors (N, 3) turned by unit quaternions (N, 4)."""
    w, x, y, z = q[:, 0], q[:, 1], q[:, 2], q[:, 3]
    a, b, c = v[:, 0], v[:, 1], v[:, 2]
    p = 2.0 * (y * c - z * b)
    r = 2.0 * (z * a - x * c)
    s = 2.0 * (x * b - y * a)
    out = np.zeros((len(v), 3))
    out[:, 0] = a + w * p + y * s - z * r
    out[:, 1] = b + w * r + z * p - x * s
    out[:, 2] = c + w * s + x * r - y * p
    return out


def arcs(a, b):
    """The shortest rotations (N, 4) from unit vectors a to unit vectors b, and 1 + cos of their angles (N,)."""
    out = np.zeros((len(a), 4))
    near = 1.0 + a[:, 0] * b[:, 0] + a[:, 1] * b[:, 1] + a[:, 2] * b[:, 2]
    out[:, 0] = near
    out[:, 1] = a[:, 1] * b[:, 2] - a[:, 2] * b[:, 1]
    out[:, 2] = a[:, 2] * b[:, 0] - a[:, 0] * b[:, 2]
    out[:, 3] = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    if near.min() < 1e-8:
        for k in np.flatnonzero(near < 1e-8):  # half a turn: about any axis across
            x, y, z = a[k, 0], a[k, 1], a[k, 2]
            out[k, 0] = 0.0
            if abs(x) < 0.7:
                out[k, 1], out[k, 2], out[k, 3] = 0.0, z, -y
            else:
                out[k, 1], out[k, 2], out[k, 3] = -z, 0.0, x
    return out / column(np.sqrt((out * out).sum(axis=1))), near


def quaternion_of(turn):
    """The unit quaternion (1, 4) of a rotation (3, 3), by its greatest component."""
    trace = turn[0, 0] + turn[1, 1] + turn[2, 2]
    out = np.zeros((1, 4))
    best = 0
    if trace < 0.0 or trace < max(turn[0, 0], turn[1, 1], turn[2, 2]):
        best = 1
        for k in range(1, 3):
            if turn[k, k] > turn[best - 1, best - 1]:
                best = k + 1
    if best == 0:
        out[0, 0] = 1.0 + trace
        out[0, 1], out[0, 2], out[0, 3] = (
            turn[2, 1] - turn[1, 2],
            turn[0, 2] - turn[2, 0],
            turn[1, 0] - turn[0, 1],
        )
    else:
        i = best - 1
        j, k = (i + 1) % 3, (i + 2) % 3
        out[0, 0] = turn[k, j] - turn[j, k]
        out[0, i + 1] = 1.0 + turn[i, i] - turn[j, j] - turn[k, k]
        out[0, j + 1], out[0, k + 1] = turn[i, j] + turn[j, i], turn[i, k] + turn[k, i]
    return out / math.sqrt((out * out).sum())
