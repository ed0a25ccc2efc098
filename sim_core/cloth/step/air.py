"""Still air, wind and gusts: what presses on a face that moves through it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sim_core.cloth.step.frame import FRAME
from sim_core.validation import FURTHEST, finite, integer, vector3

_TONES = 6  # sine waves a gust is made of


@dataclass(frozen=True)
class Air:
    """wind (x, y, z) [m/s]; density [kg/m3]; drag coefficient Cd; gusts: share of the wind's speed they add, rms.

    Gusts blow along the wind and vary over some `gust_seconds`, seeded; the whole cloth feels the same wind.
    A face takes 1/2 density Cd A |s| s n, s the wind's speed against it along its normal n.
    Raises SimCoreError on a value without meaning.
    """

    wind: tuple[float, float, float] = (0.0, 0.0, 0.0)
    density: float = 1.2
    drag: float = 1.0
    gusts: float = 0.0
    gust_seconds: float = 1.0
    seed: int = 0

    def __post_init__(self) -> None:
        object.__setattr__(self, "wind", vector3("air.wind", self.wind, "in m/s"))
        for name in ("density", "drag", "gusts"):
            finite(f"air.{name}", getattr(self, name), least=0, most=FURTHEST)
        finite("air.gust_seconds", self.gust_seconds, above=0)
        integer("air.seed", self.seed, 0, "a whole number of 0 or more", most=2**63)

    @property
    def press(self) -> float:
        """density Cd / 12 [kg/m3]: what the compiled loop takes."""
        return float(self.density * self.drag / 12)

    def over(self, seconds: float) -> np.ndarray:
        """The wind (2, 3) [m/s] at the begin and end of the frame that starts at a time [s]."""
        return np.stack([self.at(seconds), self.at(seconds + FRAME)])

    def blowing(self, wind: Sequence[float]) -> Air:
        """The same air with another wind (x, y, z) [m/s]."""
        return replace(self, wind=vector3("air.wind", wind, "in m/s"))

    def at(self, seconds: float) -> np.ndarray:
        """The wind (3,) [m/s] at a time [s]."""
        seconds, wind = finite("seconds", seconds), np.asarray(self.wind, float)
        if self.gusts == 0:
            return wind
        rng = np.random.default_rng(self.seed)
        rate = rng.uniform(0.3, 2.0, _TONES) / self.gust_seconds
        phase = rng.uniform(0, 2 * np.pi, _TONES)
        swing = np.sin(2 * np.pi * rate * seconds + phase).sum() / np.sqrt(_TONES / 2)
        return wind * (1 + self.gusts * swing)
