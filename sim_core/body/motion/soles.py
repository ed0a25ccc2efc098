"""Feet on a floor: the profile of a sole, and how far a foot goes that rolls over it without sliding.

Perry's three rockers (Gait Analysis, 1992): a foot strikes on its heel and rolls over it, lies flat while the shank
goes over it, and rolls on over its ball. A convex profile that rolls without sliding carries a point of the foot along
by the integral of its height over the angle, whatever the profile.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.spatial import ConvexHull

from sim_core.body.joints import JOINTS
from sim_core.body.mannequin import Mannequin
from sim_core.errors import SimCoreError

__all__ = ["Sole", "sole_of"]

STIFF = 0.99  # least weight of ankle and toe of a vertex that goes with the foot as one piece
SOFT = 4e-4  # [m] by which the profile's corners are rounded
STEEPEST = 80.0  # [degrees] up and down
ANGLES = 1601


@dataclass(frozen=True)
class Sole:
    """One foot seen from its side. vertices (N,) of the figure that may touch a floor; height, way: of its ankle above
    and along the floor [m] at a pitch [rad], toes down positive, as it rolls."""

    vertices: np.ndarray
    height: CubicSpline
    way: CubicSpline


def sole_of(figure: Mannequin, side: str) -> Sole:
    """The sole of a figure's left ("l") or right ("r") foot. Raises SimCoreError where it has no foot."""
    ankle, toe = (JOINTS.index(f"{joint}_{side}") for joint in ("ankle", "toe"))
    head = figure.heads[ankle]
    rigid = figure.weights[:, ankle] + figure.weights[:, toe] > STIFF
    chosen = np.flatnonzero(rigid & (figure.vertices[:, 1] < head[1]))
    if len(chosen) < 4:
        raise SimCoreError(f"figure {figure.name}: no foot on side {side!r} – give one with feet")
    points = figure.vertices[chosen] - head
    points = points[ConvexHull(points[:, 1:]).vertices]
    pitch = np.radians(np.linspace(-STEEPEST, STEEPEST, ANGLES))
    # Height of each point below the ankle when the foot is pitched: y' = y cos p - z sin p.
    below = -(np.outer(np.cos(pitch), points[:, 1]) - np.outer(np.sin(pitch), points[:, 2]))
    most = below.max(1)
    height = most + SOFT * np.log(np.exp((below - most[:, None]) / SOFT).sum(1))
    # Softened corners stand a little high; none of it may lift a foot that lies flat.
    height -= float(np.interp(0.0, pitch, height) - np.interp(0.0, pitch, most))
    spline = CubicSpline(pitch, height)
    way = spline.antiderivative()
    shift = float(way(0.0))
    return Sole(chosen, spline, CubicSpline(pitch, way(pitch) - shift))
