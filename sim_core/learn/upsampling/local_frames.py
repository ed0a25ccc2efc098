"""What the biharmonic base leaves, regressed on the coarse neighbourhood in local tangent frames, in closed form.

Every fine vertex belongs to the coarse vertex nearest at rest. Its residual against the base is turned into that
vertex's frame and regressed on where the coarse vertices of two rings lie in the same frame, so that a cloth moved or
turned as a whole comes out moved and turned. Each fine vertex has weights of its own (one set for all, or one for each
of a few kinds, does worse: a fine vertex's place in its coarse face decides its weights); ridge keeps them from
learning the frames by heart, and is relative to how much the neighbourhood moves.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numba import njit
from scipy.sparse import csr_array
from scipy.spatial import KDTree

from sim_core.errors import SimCoreError
from sim_core.learn.convolution import FREE_ORDER, spirals
from sim_core.learn.topology import checked_sheet, rings
from sim_core.learn.upsampling.weighted_sums import weighted_sums
from sim_core.validation import coordinates, finite, integer, numeric_array

__all__ = ["LocalFrames", "LocalFramesFit", "TangentFrames", "tangent_frames"]

BLOCK = 16  # frames that are taken in at a time
TWO_RINGS = 19  # a vertex, six neighbours and their twelve


@dataclass(frozen=True)
class TangentFrames:
    """along, across (K, K): the derivatives of a map at the coarse vertices along x and y of the rest plane."""

    along: csr_array
    across: csr_array

    def of(self, coarse: np.ndarray) -> np.ndarray:
        """Frames (K, 3, 3) of coarse positions (K, 3), in columns: along x of the cloth, across, normal.

        Where the derivatives lie in line a cloth has no tangent plane, and the frame is 0.
        """
        out = np.zeros((len(coarse), 3, 3))
        _frames(weighted_sums(self.along, coarse), weighted_sums(self.across, coarse), out)
        return out


@njit(cache=True)
def _frames(along, across, out):
    for i in range(len(out)):
        x, y, z = _unit(along[i, 0], along[i, 1], along[i, 2])
        u, v, w = across[i, 0], across[i, 1], across[i, 2]
        a, b, c = _unit(y * w - z * v, z * u - x * w, x * v - y * u)
        if a == 0.0 and b == 0.0 and c == 0.0:
            continue
        out[i, 0, 0], out[i, 1, 0], out[i, 2, 0] = x, y, z
        out[i, 0, 1], out[i, 1, 1], out[i, 2, 1] = b * z - c * y, c * x - a * z, a * y - b * x
        out[i, 0, 2], out[i, 1, 2], out[i, 2, 2] = a, b, c


@njit(cache=True)
def _unit(x, y, z):
    size = math.sqrt(x * x + y * y + z * z)
    if size > 1e-9:
        return x / size, y / size, z / size
    return 0.0, 0.0, 0.0


def tangent_frames(rest: np.ndarray, faces: np.ndarray) -> TangentFrames:
    """Frames of a coarse mesh, rest (K, 2) [m], faces (G, 3), by least squares over the ring of each vertex.

    Raises SimCoreError for arrays of other shapes, and a vertex whose neighbours lie in line with it.
    """
    rest, faces = checked_sheet(rest, faces)
    start, items = rings(faces, len(rest))
    vertex = np.repeat(np.arange(len(rest)), np.diff(start))
    offset = rest[items] - rest[vertex]
    weight = 1.0 / (offset**2).sum(1)
    moments = np.zeros((len(rest), 2, 2))
    np.add.at(moments, vertex, weight[:, None, None] * offset[:, :, None] * offset[:, None, :])
    bad = np.flatnonzero(np.linalg.det(moments) < 1e-9)  # of a ring of unit directions
    if len(bad):
        raise SimCoreError(f"faces: coarse vertex {bad[0]} has no two neighbours in different directions")
    gradient = np.einsum("nij,nj->ni", np.linalg.inv(moments)[vertex], weight[:, None] * offset)
    made = []
    for axis in range(2):
        own = -np.bincount(vertex, gradient[:, axis], len(rest))
        rows, columns = (
            np.concatenate([vertex, np.arange(len(rest))]),
            np.concatenate([items, np.arange(len(rest))]),
        )
        values = np.concatenate([gradient[:, axis], own])
        made.append(csr_array((values, (rows, columns)), shape=(len(rest), len(rest))))
    return TangentFrames(made[0], made[1])


@dataclass(frozen=True)
class LocalFrames:
    """The fitted model: fine = base @ coarse + frame @ (features @ weights + bias).

    base: (V, K); frames; near: (K, L) int32, whose places are features, itself first; anchor: (V,) the coarse vertex of
    each fine one; length [m] that features are divided by; weights: (V, 3 L - 3, 3) [m]; bias: (V, 3) [m].
    """

    base: csr_array
    frames: TangentFrames
    near: np.ndarray
    anchor: np.ndarray
    length: float
    weights: np.ndarray
    bias: np.ndarray

    def predict(self, coarse: np.ndarray) -> np.ndarray:
        """Fine positions (V, 3) [m] of coarse ones (K, 3) [m]. Raises SimCoreError for another shape or NaN."""
        coarse = coordinates("coarse", coarse, (len(self.near), 3))
        turn = self.frames.of(coarse)
        feature = _features(coarse, turn, self.near, self.length)
        out = weighted_sums(self.base, coarse)
        _mend(feature, turn, self.anchor, self.weights, self.bias, out)
        return out


@njit(cache=True, fastmath=FREE_ORDER)
def _mend(feature, turn, anchor, weights, bias, out):
    """Adds to out (V, 3) what its anchor's features (K, D) say by weights (V, D, 3) and bias (V, 3), in its frame."""
    for v in range(len(out)):
        k = anchor[v]
        a, b, n = bias[v, 0], bias[v, 1], bias[v, 2]
        for d in range(feature.shape[1]):
            f = feature[k, d]
            a, b, n = a + f * weights[v, d, 0], b + f * weights[v, d, 1], n + f * weights[v, d, 2]
        for c in range(3):
            out[v, c] += turn[k, c, 0] * a + turn[k, c, 1] * b + turn[k, c, 2] * n


class LocalFramesFit:
    """Normal equations that frames of training are added to, block by block; `solve` gives the model."""

    def __init__(
        self,
        rest_coarse: np.ndarray,
        faces_coarse: np.ndarray,
        rest_fine: np.ndarray,
        base: csr_array,
        *,
        neighbours: int = TWO_RINGS,
    ) -> None:
        """rest_coarse: (K, 2) [m]; faces_coarse: (G, 3); rest_fine: (V, 2) [m]; base: (V, K) of `biharmonic`.

        neighbours: of each coarse vertex in the order of its spiral, itself included. Raises SimCoreError for arrays
        that do not fit each other.
        """
        rest, faces = checked_sheet(rest_coarse, faces_coarse)
        fine = coordinates("rest_fine", rest_fine)
        if fine.ndim != 2 or fine.shape[1] != 2 or base.shape != (len(fine), len(rest)):
            raise SimCoreError(
                f"base: shape {base.shape} – it must lead from {len(rest)} coarse to {len(fine)} fine vertices"
            )
        integer("neighbours", neighbours, 2, "give 2 to 100 vertices", 100)
        self._base, self._frames = base, tangent_frames(rest, faces)
        self._near = spirals(faces, neighbours, rest)
        self._anchor = np.asarray(KDTree(rest).query(fine)[1], np.int64)
        self._length = float(np.sqrt(np.prod(np.ptp(rest, axis=0)) / len(rest)))
        size = 3 * neighbours - 3
        self._count = 0
        self._feature = np.zeros((len(rest), size))
        self._square = np.zeros((len(rest), size, size))
        self._target = np.zeros((len(fine), 3))
        self._mixed = np.zeros((len(fine), size, 3))

    def add(self, coarse: np.ndarray, fine: np.ndarray) -> None:
        """Frames of training: coarse (T, K, 3) and fine (T, V, 3) [m]. Raises SimCoreError for other shapes or NaN."""
        coarse, fine = (
            numeric_array(name, x, "(T, …, 3) [m]") for name, x in (("coarse", coarse), ("fine", fine))
        )
        wanted = ((len(coarse), len(self._near), 3), (len(coarse), len(self._anchor), 3))
        if (coarse.shape, fine.shape) != wanted:
            raise SimCoreError(
                f"coarse, fine: shapes {coarse.shape}, {fine.shape} – {wanted[0]}, {wanted[1]} are meant"
            )
        if not (np.isfinite(coarse).all() and np.isfinite(fine).all()):
            raise SimCoreError("coarse, fine: positions that are not finite")
        for begin in range(0, len(coarse), BLOCK):
            self._add(
                np.asarray(coarse[begin : begin + BLOCK], float),
                np.asarray(fine[begin : begin + BLOCK], float),
            )

    def _add(self, coarse: np.ndarray, fine: np.ndarray) -> None:
        """A few frames at once, so that the sums of products are products of matrices."""
        feature = np.zeros((len(self._near), self._feature.shape[1], len(coarse)))
        local = np.zeros((len(self._anchor), len(coarse), 3))
        for k, (place, truth) in enumerate(zip(coarse, fine, strict=True)):
            turn = self._frames.of(place)
            feature[:, :, k] = _features(place, turn, self._near, self._length)
            local[:, k] = np.einsum("vji,vj->vi", turn[self._anchor], truth - self._base @ place)
        self._feature += feature.sum(2)
        self._target += local.sum(1)
        self._square += feature @ feature.transpose(0, 2, 1)
        self._mixed += feature[self._anchor] @ local
        self._count += len(coarse)

    def solve(self, ridge: float = 1e-3) -> LocalFrames:
        """The model of all frames so far, features centred; ridge: in units of a feature's mean variance there.

        Raises SimCoreError where there is no frame yet.
        """
        ridge = finite("ridge", ridge, above=0.0)
        if not self._count:
            raise SimCoreError("frames: there are none – add some before")
        mean, middle = self._feature / self._count, self._target / self._count
        size = mean.shape[1]
        square = self._square / self._count - mean[:, :, None] * mean[:, None, :]
        variance = np.trace(square, axis1=1, axis2=2) / size
        square += np.maximum(ridge * variance, 1e-12)[:, None, None] * np.eye(size)
        mixed = self._mixed / self._count - mean[self._anchor][:, :, None] * middle[:, None, :]
        weights = np.linalg.inv(square)[self._anchor] @ mixed
        bias = middle - np.matmul(mean[self._anchor][:, None], weights)[:, 0]
        return LocalFrames(self._base, self._frames, self._near, self._anchor, self._length, weights, bias)


def _features(coarse: np.ndarray, turn: np.ndarray, near: np.ndarray, length: float) -> np.ndarray:
    """Where the neighbours lie in each vertex's frame (K, 3 L - 3), in lengths; 0 for what fills a spiral."""
    away = (coarse[near[:, 1:]] - coarse[:, None]) / length
    return np.matmul(away, turn).reshape(len(coarse), -1)
