"""Where a garment is pinned to the figure that wears it, as museums pin theirs, and how the pins go with it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import KDTree

from sim_core.body import Mannequin, Pose
from sim_core.garment.garment import Garment
from sim_core.track import align

__all__ = ["Pins"]

LIES = 0.03  # [m] from the skin that cloth is pinned to at most
ROUND = 0.02  # [m] about a spot that cloth is held in
SKIN = 0.04  # [m] about a spot whose skin says how the spot goes


@dataclass(frozen=True)
class _Spot:
    """Vertices (P,) of a garment that go together, where they are (P, 3) [m] on a figure whose vertices skin (S,) are
    at rest (S, 3) [m]."""

    vertices: np.ndarray
    places: np.ndarray
    skin: np.ndarray
    rest: np.ndarray


@dataclass(frozen=True)
class Pins:
    """Spots of a garment that are held on its wearer, each as one stiff piece: the rigid motion of the skin about it
    (SVD alignment, Eq. 13-14 of the paper)."""

    spots: tuple[_Spot, ...]

    @staticmethod
    def of(garment: Garment, wearer: Mannequin, pose: Pose) -> Pins:
        """On both shoulders, as far as the garment lies there; a skirt or a scarf has none."""
        marks, body = wearer.landmarks(pose), wearer.posed(pose)
        middles = [0.5 * (marks["neck"] + marks[f"shoulder_{side}"]) for side in "lr"]
        skin, cloth = KDTree(body), KDTree(garment.positions)
        corners = garment.positions[garment.faces]
        # Cloth of large triangles lies on a shoulder with their middles, too.
        lying = KDTree(
            np.concatenate([corners.mean(1), *(0.5 * (corners + np.roll(corners, 1, 1))).swapaxes(0, 1)])
        )
        spots: list[_Spot] = []
        for middle in middles:
            top = body[skin.query(middle)[1]]
            away, nearest = cloth.query(top)
            if min(away, lying.query(top)[0]) > LIES:
                continue
            held = np.array(sorted(cloth.query_ball_point(garment.positions[nearest], ROUND)), np.int64)
            held = np.setdiff1d(held, _held(spots))
            near = np.array(sorted(skin.query_ball_point(top, SKIN)), np.int64)
            spots.append(_Spot(held, garment.positions[held], near, body[near]))
        return Pins(tuple(spots))

    @property
    def vertices(self) -> np.ndarray:
        """The garment's vertices (P,) int64 that are held."""
        return _held(self.spots)

    def places(self, body: np.ndarray) -> np.ndarray:
        """Where they are (P, 3) [m] on the wearer's posed vertices (B, 3) [m]."""
        moved = [np.zeros((0, 3))]
        moved += [align(body[spot.skin], spot.rest).of(spot.places) for spot in self.spots]
        return np.concatenate(moved)


def _held(spots: Sequence[_Spot]) -> np.ndarray:
    return np.concatenate([np.zeros(0, np.int64), *(spot.vertices for spot in spots)])
