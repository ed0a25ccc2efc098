"""Periodic curves: key values over a period, joined by a spline without a jump in value, speed or acceleration."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.ndimage import gaussian_filter1d, maximum_filter1d

from sim_core.body.joints import JOINTS
from sim_core.errors import SimCoreError

__all__ = ["ROOT", "Curve", "minimum_jerk", "spread"]

ROOT = "root"  # stands for the root's way where a curve names what it moves
WHOLE = 100.0  # per cent of a period
NEAREST = 0.01  # per cent between two values: below it a spline overshoots without bounds
MOST_DEGREES, MOST_METRES = 360.0, 10.0
Vector = tuple[float, float, float]
_AXES = "xyz"


def minimum_jerk(share: np.ndarray | float) -> np.ndarray:
    """The share of the way gone after a share of the time, 0 before and 1 after; speed and acceleration begin and end
    at nought (Flash and Hogan, J. Neurosci. 5 (1985) 1688-1703)."""
    t = np.clip(share, 0.0, 1.0)
    return t * t * t * (10.0 - 15.0 * t + 6.0 * t * t)


def spread(need: np.ndarray, frames: float) -> np.ndarray:
    """A smooth curve (T,) that is nowhere below `need`, for as short as it can be, over so many frames."""
    wide = max(1, round(frames))
    return np.maximum(gaussian_filter1d(maximum_filter1d(need, 4 * wide + 1), wide, mode="nearest"), need)


@dataclass(frozen=True)
class Curve:
    """What turns a joint about one axis, or moves the root along it, over a period.

    joint: of JOINTS, one without its side for both (the right one mirrored, a share `lag` of the period after the
    left), or "root"; at: percent of the period, rising; values: there, in degrees [m of the root], each times `scale`
    and `offset` added. Between them a periodic cubic spline. source: where the values are from.
    """

    joint: str
    axis: str
    at: tuple[float, ...]
    values: tuple[float, ...]
    scale: float = 1.0
    offset: float = 0.0
    lag: float = 0.5
    source: str = ""

    def __post_init__(self) -> None:
        if self.joint != ROOT and self.joint not in JOINTS and f"{self.joint}_l" not in JOINTS:
            sided = [name[:-2] for name in JOINTS if name.endswith("_l")]
            middle = [name for name in JOINTS if name[-2:] not in ("_l", "_r")]
            raise SimCoreError(
                f"joint: none called {self.joint!r} – there are {ROOT}, {', '.join((*middle, *sided))}, "
                "these also with _l or _r"
            )
        if len(self.at) != len(self.values) or len(self.at) < 2:
            raise SimCoreError(
                f"at: {len(self.at)} places for {len(self.values)} values – give as many, two or more"
            )
        if not all(b - a >= NEAREST for a, b in zip(self.at, self.at[1:], strict=False)):
            raise SimCoreError(f"at: {list(self.at)} – give percentages that rise by {NEAREST:g} or more")
        if self.at[0] < 0.0 or self.at[-1] >= WHOLE or self.at[0] + WHOLE - self.at[-1] < NEAREST:
            raise SimCoreError(
                f"at: {list(self.at)} – give 0 up to, but not with, 100: there it begins again"
            )
        name, most = ("metres", MOST_METRES) if self.joint == ROOT else ("degrees", MOST_DEGREES)
        for value in self.values:
            if not abs(self.scale * value + self.offset) <= most:
                told = f"{value:g} times {self.scale:g} and {self.offset:g}"
                raise SimCoreError(f"{name}: {told} – give what comes to {-most:g} to {most:g}")

    @cached_property
    def _spline(self) -> CubicSpline:
        at = np.r_[self.at, self.at[0] + WHOLE] / WHOLE
        values = self.scale * np.r_[self.values, self.values[0]] + self.offset
        return CubicSpline(at, values, bc_type="periodic")

    def turns(self, share: float) -> dict[str, Vector]:
        """Rotation vectors (3,) [degrees] by joint, or the root's way [m], after a share of the period."""
        if self.joint == ROOT or self.joint in JOINTS:
            return {self.joint: self._vector(share, 1.0)}
        sign = 1.0 if self.axis == "x" else -1.0  # a looking glass turns back turns about y and z
        return {
            f"{self.joint}_l": self._vector(share, 1.0),
            f"{self.joint}_r": self._vector(share - self.lag, sign),
        }

    def _vector(self, share: float, sign: float) -> Vector:
        angle = sign * float(self._spline(share))
        x, y, z = (angle if self.axis == axis else 0.0 for axis in _AXES)
        return x, y, z
