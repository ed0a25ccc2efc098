"""Global alignment of corresponding points, A = R B + T (Eq. 13-14), and what may be wrong with them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim_core.errors import SimCoreError
from sim_core.track.engine import kabsch
from sim_core.validation import finite, numeric_array

__all__ = ["Alignment", "align"]

SLIGHT = 1e-9  # of a prior that decides nothing but the twist
FLAT = 1e-6  # of the greatest extent: below, a direction counts as none


@dataclass(frozen=True)
class Alignment:
    """rotation (3, 3) and translation (3,) [m] that take B to A; rms [m] of what is left.

    kind: "solid", "coplanar", "collinear" (the twist about the line is free), "coincident" (the rotation is) or "few"
    (fewer than 3 points of weight). mirrored: the points would rather be mirrored, and the rotation is the best there
    is without.
    """

    rotation: np.ndarray
    translation: np.ndarray
    rms: float
    kind: str
    mirrored: bool

    def of(self, points: np.ndarray) -> np.ndarray:
        """Points (N, 3) moved."""
        return points @ self.rotation.T + self.translation


def align(
    target: np.ndarray,
    source: np.ndarray,
    weights: np.ndarray | None = None,
    *,
    previous: np.ndarray | None = None,
    prior: float = 1e-3,
) -> Alignment:
    """The rigid motion that takes source B (N, 3) to target A (N, 3), by SVD of their weighted, centred covariance.

    weights (N,), 0 or more (None: all alike). previous (3, 3): the last rotation; H + prior tr(B) R' then decides
    what the points leave open, as the twist of collinear ones, and fewer than three or coincident points return it
    (without it: no rotation). Raises SimCoreError for arrays of other shapes, NaN, or weights below 0.
    """
    a, b = _points("target", target), _points("source", source)
    if a.shape != b.shape:
        raise SimCoreError(f"source: shape {b.shape} – the target has {a.shape}, a point for each")
    weight = _weights(weights, len(a))
    before = np.eye(3) if previous is None else numeric_array("previous", previous, "a rotation (3, 3)")
    if before.shape != (3, 3) or not np.isfinite(before).all():
        raise SimCoreError(f"previous: shape {before.shape} – a rotation (3, 3) of finite numbers is meant")
    prior = finite("prior", prior, least=0.0)
    total = weight.sum()
    if total <= 0.0:
        raise SimCoreError("weights: all are 0 – give one point weight at least")
    weight = weight / total
    middle, centre = _mean(weight, a), _mean(weight, b)
    there, shape = a - middle, b - centre
    scale_a, scale_b = np.abs(there).max(initial=0.0), np.abs(shape).max(initial=0.0)
    kind = _kind(weight, shape, scale_b, np.abs(b).max(initial=0.0))
    mirrored = False
    if kind in ("few", "coincident") or scale_a == 0.0:
        turn = np.array(before, float)
    else:
        covariance = (shape / scale_b).T @ (weight[:, None] * (there / scale_a))
        mirrored = kind == "solid" and bool(np.linalg.det(covariance) < 0.0)
        size = float(weight @ ((shape / scale_b) ** 2).sum(1))
        if kind == "collinear":  # a prior for what is left open alone; from its own answer it draws no more
            turn = kabsch(covariance + SLIGHT * size * kabsch(covariance + SLIGHT * size * before.T).T)
        else:
            turn = kabsch(covariance if previous is None else covariance + prior * size * before.T)
    left = there - shape @ turn.T
    rms = float(np.sqrt(weight @ (left**2).sum(1)))
    return Alignment(turn, middle - turn @ centre, rms, kind, mirrored)


def _points(name: str, value: object) -> np.ndarray:
    array = np.array(numeric_array(name, value, "points (N, 3) are meant"), float)
    if array.ndim != 2 or array.shape[1] != 3 or not len(array):
        raise SimCoreError(f"{name}: shape {array.shape} – points (N, 3) are meant, one or more")
    if not np.isfinite(array).all():
        row = int(np.flatnonzero(~np.isfinite(array).all(1))[0])
        raise SimCoreError(
            f"{name}: point {row} is not finite – leave it out, or give it weight 0 and a place"
        )
    return array


def _weights(weights: object, count: int) -> np.ndarray:
    if weights is None:
        return np.ones(count)
    array = np.array(numeric_array("weights", weights, "one number a point"), float)
    if array.shape != (count,) or not (np.isfinite(array) & (array >= 0.0)).all():
        raise SimCoreError(f"weights: {count} finite numbers of 0 or more are meant, one a point")
    top = array.max(initial=0.0)
    return array / top if top > 0.0 else array


def _mean(weight: np.ndarray, points: np.ndarray) -> np.ndarray:
    """The weighted mean (3,), the second time about the first, so that far points lose no digits."""
    first = weight @ points
    return first + weight @ (points - first)


def _kind(weight: np.ndarray, shape: np.ndarray, scale: float, size: float) -> str:
    """What the points span."""
    if np.count_nonzero(weight) < 3:
        return "few"
    if scale <= 1e-15 * size or scale == 0.0:
        return "coincident"
    spans = np.linalg.svd(np.sqrt(weight)[:, None] * shape / scale, compute_uv=False)
    if spans[1] <= FLAT * spans[0]:
        return "collinear"
    return "coplanar" if spans[2] <= FLAT * spans[0] else "solid"
