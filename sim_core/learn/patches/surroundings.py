"""What a coarse vertex sees: its two rings in its own tangent frame, and how it goes."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numba import njit

from sim_core.learn.convolution import spirals
from sim_core.learn.topology import border_vertices, checked_sheet, unsigned
from sim_core.learn.upsampling import TangentFrames, tangent_frames
from sim_core.validation import coordinates, vertex_indices

__all__ = ["SEEN", "TWO_RINGS", "Surroundings"]

TWO_RINGS = 19  # a vertex, six neighbours and their twelve
FLAGS = 3
SEEN = 3 * (TWO_RINGS - 1) + 6 + FLAGS  # numbers of a vertex
USUAL = 0.03  # [m] a coarse edge; what its logarithm is told against


@dataclass(frozen=True)
class Surroundings:
    """Of a coarse sheet of C vertices. near: (C, TWO_RINGS) int32 spirals; flags: (C, FLAGS) float32, pinned, on the
    border, and the logarithm of the edges' length, of which a sheet knows nothing else."""

    near: np.ndarray
    flags: np.ndarray
    length: float
    _away: np.ndarray  # (C, TWO_RINGS, 2) places of the spiral at rest, in lengths
    _frames: TangentFrames

    @staticmethod
    def of(rest: np.ndarray, faces: np.ndarray, pins: tuple[int, ...]) -> Surroundings:
        """From a sheet at rest, (C, 2) [m], its faces (G, 3) and pins. Raises SimCoreError for what is none."""
        flat, faces = checked_sheet(rest, faces)
        length = float(np.sqrt(np.prod(np.ptp(flat, axis=0)) / len(flat)))
        near = spirals(faces, TWO_RINGS, flat)
        pinned = np.zeros(len(flat))
        pinned[list(vertex_indices("pins", pins, len(flat)))] = 1.0
        scale = np.full(len(flat), math.log(length / USUAL))
        flags = np.column_stack([pinned, border_vertices(faces, len(flat)), scale]).astype(np.float32)
        away = (flat[near] - flat[:, None]) / length
        return Surroundings(near, flags, length, away, tangent_frames(flat, faces))

    def seen(
        self, coarse: np.ndarray, before: np.ndarray, earlier: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Tangent frames (C, 3, 3) float32, in columns, and what each vertex sees (C, SEEN) float32, in lengths.

        coarse, before, earlier: (C, 3) [m], now and one and two frames ago. Where the sheet is moved or turned as a
        whole, frames turn along and nothing that is seen changes. Raises SimCoreError for other shapes or NaN.
        """
        shape = (len(self.near), 3)
        now, last, first = (
            coordinates(name, array, shape)
            for name, array in (("coarse", coarse), ("before", before), ("earlier", earlier))
        )
        turn, out = self._frames.of(now), np.zeros((len(self.near), SEEN), np.float32)
        _seen((now, last, first), turn, (unsigned(self.near), self._away, self.length), out)
        out[:, -FLAGS:] = self.flags
        return turn.astype(np.float32), out


@njit(cache=True, error_model="numpy")
def _seen(films, turn, sheet, out):
    (x, before, earlier), (near, away, length) = films, sheet
    for i in range(len(x)):
        a = turn[i, 0, 0], turn[i, 1, 0], turn[i, 2, 0]
        c = turn[i, 0, 1], turn[i, 1, 1], turn[i, 2, 1]
        n = turn[i, 0, 2], turn[i, 1, 2], turn[i, 2, 2]
        place = 0
        for k in range(1, near.shape[1]):
            j = near[i, k]
            d = (x[j, 0] - x[i, 0]) / length, (x[j, 1] - x[i, 1]) / length, (x[j, 2] - x[i, 2]) / length
            out[i, place] = a[0] * d[0] + a[1] * d[1] + a[2] * d[2] - away[i, k, 0]
            out[i, place + 1] = c[0] * d[0] + c[1] * d[1] + c[2] * d[2] - away[i, k, 1]
            out[i, place + 2] = n[0] * d[0] + n[1] * d[1] + n[2] * d[2]
            place += 3
        went = x[i, 0] - before[i, 0], x[i, 1] - before[i, 1], x[i, 2] - before[i, 2]
        had = before[i, 0] - earlier[i, 0], before[i, 1] - earlier[i, 1], before[i, 2] - earlier[i, 2]
        for move in (went, (went[0] - had[0], went[1] - had[1], went[2] - had[2])):
            d = move[0] / length, move[1] / length, move[2] / length
            out[i, place] = a[0] * d[0] + a[1] * d[1] + a[2] * d[2]
            out[i, place + 1] = c[0] * d[0] + c[1] * d[1] + c[2] * d[2]
            out[i, place + 2] = n[0] * d[0] + n[1] * d[1] + n[2] * d[2]
            place += 3
