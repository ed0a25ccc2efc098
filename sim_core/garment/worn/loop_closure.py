"""How a garment that has gone round comes back to where it was: drawn there by forces, the rest blended away."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim_core.body.motion import RATE, minimum_jerk
from sim_core.cloth import Live
from sim_core.cloth.step import FRAME
from sim_core.garment.garment import Garment

__all__ = ["CLOSING", "Lengths", "closed", "draw"]

CLOSING = 0.5  # [s] at the end of a round in which cloth is drawn to where it was at that of the round before
DRAW = 0.9  # share of what it is away that it is drawn in a frame
GENTLY = 0.15  # [s] in which that is reached, and in which what is left is blended away
RELAXED = 10  # times that edges of blended cloth are led back to their lengths
FURTHER = 1.6  # times as far as an edge by itself asks for, shared by all of a vertex


def draw(live: Live, before: np.ndarray, there: np.ndarray, number: int) -> np.ndarray:
    """Accelerations (V, 3) [m/s2] in the frame of that number that draw a cloth to one which goes from `before` to
    `there` (V, 3) [m] in it: critically damped, from nothing on."""
    share = DRAW * float(minimum_jerk(number * FRAME / GENTLY))
    away, faster = live.positions - before, live.velocities - (there - before) / FRAME
    return -(share * away / FRAME + 1.6 * np.sqrt(share) * faster) / FRAME


@dataclass(frozen=True)
class Lengths:
    """Edges (E, 2) of a garment, their lengths (E,) [m] as cut, how many each vertex has (V,), and which vertices are
    held."""

    edges: np.ndarray
    rest: np.ndarray
    count: np.ndarray
    held: np.ndarray

    @staticmethod
    def of(garment: Garment, held: np.ndarray) -> Lengths:
        """Where two panels meet an edge is as long as both are on average."""
        faces, corners = garment.faces, garment.rest_corners()
        sides = ((0, 1), (1, 2), (2, 0))
        ends = np.sort(np.concatenate([faces[:, side] for side in sides]), axis=1)
        long = np.concatenate([np.linalg.norm(corners[:, a] - corners[:, b], axis=1) for a, b in sides])
        edges, number = np.unique(ends, axis=0, return_inverse=True)
        number = number.reshape(-1)
        rest = np.bincount(number, long) / np.bincount(number)
        return Lengths(edges, rest, np.bincount(edges.ravel(), minlength=len(garment.positions)), held)

    def relaxed(self, x: np.ndarray) -> np.ndarray:
        """Positions (V, 3) [m] led towards these lengths, by a few steps of all edges at once: what lies between two
        states of a cloth is shorter than either."""
        x, (i, j) = x.astype(float), self.edges.T
        for _ in range(RELAXED):
            way = x[j] - x[i]
            long = np.maximum(np.linalg.norm(way, axis=1), 1e-9)
            half = (0.5 * (long - self.rest) / long)[:, None] * way
            move = np.zeros_like(x)
            np.add.at(move, i, half)
            np.add.at(move, j, -half)
            move *= (FURTHER / self.count)[:, None]
            move[self.held] = 0.0
            x += move
        return x


def closed(frames: np.ndarray, again: int, lengths: Lengths) -> tuple[np.ndarray, float]:
    """Frames (T, V, 3) float32 [m] whose last is that of a round, `again` frames, before, and how far from there it was
    [m]: blended over the last frames, whose edges are led back to their lengths, half-way most."""
    away = float(np.linalg.norm(frames[-1] - frames[-1 - again], axis=1).max())
    count = min(again, round(RATE * GENTLY))
    for k in range(1, count + 1):
        at, share = len(frames) - 1 - count + k, float(minimum_jerk(k / count))
        blended = frames[at] + np.float32(share) * (frames[at - again] - frames[at])
        if k < count:
            blended += np.float32(4.0 * share * (1.0 - share)) * (lengths.relaxed(blended) - blended)
        frames[at] = blended
    return frames, away
