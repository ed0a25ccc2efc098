"""Where a garment is pinned to the figure that wears it, as museums pin theirs, and how the pins go with it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import KDTree

from sim_core.body import Mannequin, Pose
from sim_core.garment.garment import Garment

__all__ = ["Pins"]

LIES = 0.015  # [m] from the skin that cloth is pinned to at most
ROUND = 0.02  # [m] about a spot that cloth is held in


@dataclass(frozen=True)
class Pins:
    """vertices (P,) int64 of the garment that are held; corners (P, 3) int32: the face of the wearer each goes with;
    ways (P, 3) [m]: how far it lies along two sides of that face, as shares of them, and off it."""

    vertices: np.ndarray
    corners: np.ndarray
    ways: np.ndarray

    @staticmethod
    def of(garment: Garment, wearer: Mannequin, pose: Pose) -> Pins:
        """At the nape and on both shoulders, as far as the garment lies there; a skirt or a scarf has none."""
        marks, body = wearer.landmarks(pose), wearer.posed(pose)
        spots = [marks["nape"], *(0.5 * (marks["neck"] + marks[f"shoulder_{side}"]) for side in "lr")]
        skin, cloth = KDTree(body), KDTree(garment.positions)
        held: list[int] = []
        for spot in spots:
            _, top = skin.query(spot)
            away, nearest = cloth.query(body[top])
            if away <= LIES:
                held += cloth.query_ball_point(garment.positions[nearest], ROUND)
        vertices = np.unique(np.array(held, np.int64))
        _, under = skin.query(garment.positions[vertices].reshape(-1, 3))
        first = np.full(len(body), -1)
        first[wearer.faces[::-1]] = np.arange(len(wearer.faces))[::-1, None]
        corners = wearer.faces[first[under]].astype(np.int32)
        origin, *sides = _frames(body, corners)
        away = garment.positions[vertices] - origin
        ways = np.linalg.solve(np.stack(sides, axis=2), away[:, :, None])[:, :, 0]
        return Pins(vertices, corners, ways)

    def places(self, body: np.ndarray) -> np.ndarray:
        """Where they are (P, 3) [m] on the wearer's posed vertices (B, 3) [m]."""
        origin, *sides = _frames(body, self.corners)
        return origin + np.einsum("pk,kpi->pi", self.ways, np.stack(sides))


def _frames(body: np.ndarray, corners: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """First corner (P, 3) of each face, its two sides from there, and its unit normal."""
    a, b, c = (body[corners[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    return a, b - a, c - a, normal / np.linalg.norm(normal, axis=1, keepdims=True)
