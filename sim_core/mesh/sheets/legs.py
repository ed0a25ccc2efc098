"""An outline as legs between corners, straight or cubic: what pattern files and GarmentCode are written in."""

from typing import NamedTuple

import numpy as np

from sim_core.mesh.geometry.curves import bezier_points
from sim_core.mesh.outline.contours import CORNER_DEGREES, outline_turning

__all__ = ["Leg", "cubic_through", "legs_of"]

OFF = 2e-4  # [m] most between a leg and the line it stands for
DEEPEST = 6  # halvings of a leg
SPREAD = 33  # points along a leg at least


class Leg(NamedTuple):
    """From `start` (2,) [m] to the next leg's; controls: two points (2, 2) [m] of a cubic curve, or None."""

    start: np.ndarray
    controls: np.ndarray | None


def legs_of(outline: np.ndarray) -> list[Leg]:
    """The legs of a closed outline (n, 2) [m]: cut at its corners (> 20 degrees), each within 0.2 mm of the line."""
    corners = np.flatnonzero(outline_turning(outline) > CORNER_DEGREES)
    if len(corners) < 3:
        corners = np.unique([*corners, *np.linspace(0, len(outline), 4, endpoint=False).astype(int)])
    turned = np.roll(outline, -corners[0], axis=0)
    marks = [*(corners - corners[0]).tolist(), len(outline)]
    closed = np.vstack([turned, turned[:1]])
    chains = [_dense(closed[a : b + 1]) for a, b in zip(marks[:-1], marks[1:], strict=True)]
    return [leg for chain in chains for leg in _fitted(chain, DEEPEST)]


def _dense(chain: np.ndarray) -> np.ndarray:
    """A polyline with points between those of long steps, so that a leg is held to them too."""
    arc = np.r_[0.0, np.cumsum(np.hypot(*np.diff(chain, axis=0).T))]
    at = np.unique(np.r_[arc, np.linspace(0, arc[-1], SPREAD)])
    return np.column_stack([np.interp(at, arc, chain[:, k]) for k in range(2)])


def _fitted(chain: np.ndarray, depth: int) -> list[Leg]:
    """A straight leg, a curve, or those of both halves."""
    arc = np.r_[0.0, np.cumsum(np.hypot(*np.diff(chain, axis=0).T))]
    t = arc / arc[-1]
    straight = chain[0] + t[:, None] * (chain[-1] - chain[0])
    if np.hypot(*(chain - straight).T).max() <= OFF:
        return [Leg(chain[0], None)]
    for _ in range(4):  # places along the curve follow its own pace
        controls = cubic_through(chain, t)
        drawn = np.vstack([chain[0], *bezier_points([chain[0], *controls, chain[-1]])])
        pace = np.r_[0.0, np.cumsum(np.hypot(*np.diff(drawn, axis=0).T))]
        t = np.interp(arc / arc[-1], pace / pace[-1], np.linspace(0, 1, len(drawn)))
    if depth == 0 or len(chain) < 4 or _off(chain, drawn) <= OFF:
        return [Leg(chain[0], controls)]
    half = int(np.clip(np.searchsorted(arc, arc[-1] / 2), 1, len(chain) - 2))
    return [*_fitted(chain[: half + 1], depth - 1), *_fitted(chain[half:], depth - 1)]


def cubic_through(chain: np.ndarray, t: np.ndarray) -> np.ndarray:
    """The control points (2, 2) of the cubic through both ends that is nearest to chain (n, 2) at t (n,)."""
    s = 1 - t
    rest = chain - s[:, None] ** 3 * chain[0] - t[:, None] ** 3 * chain[-1]
    return np.linalg.lstsq(np.column_stack([3 * s * s * t, 3 * s * t * t]), rest, rcond=None)[0]


def _off(chain: np.ndarray, drawn: np.ndarray) -> float:
    """Farthest a point of a chain lies from a polyline."""
    a, u = drawn[:-1], np.diff(drawn, axis=0)
    square = np.maximum((u * u).sum(axis=1), 1e-300)
    worst = 0.0
    for point in chain:
        t = np.clip(((point - a) * u).sum(axis=1) / square, 0, 1)
        worst = max(worst, float(np.hypot(*(point - a - t[:, None] * u).T).min()))
    return worst
