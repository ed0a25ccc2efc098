"""What one frame of a cloth is under."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

_NO_PULL = (np.zeros(0, np.int64), np.zeros((0, 3)))


@dataclass(frozen=True)
class Conditions:
    """What one frame is under: gravity (3,) [m/s2], damping [1/s], friction, speed limit [m/s], sewing, body, wind.

    pulls: vertices (P,) and the forces (P, 3) [N] on them; led: pinned vertices (L,) and where they are by the frame's
    end (L, 3) [m]; wind (2, 3) [m/s] at its begin and end.
    """

    gravity: np.ndarray
    damping: float
    friction: float
    speed_limit: float
    sewing: tuple[float, float] = (0.0, 0.0)
    body: tuple[float, float] = (0.0, 0.0)
    wind: np.ndarray | None = None
    press: float = 0.0
    pulls: tuple[np.ndarray, np.ndarray] = _NO_PULL
    led: tuple[np.ndarray, np.ndarray] = _NO_PULL

    @property
    def quiet(self) -> bool:
        """Nothing from outside does work on the cloth but gravity and a wind that only brakes."""
        still = self.sewing[0] == self.sewing[1] and self.body[0] == self.body[1]
        return (
            still
            and not len(self.pulls[0])
            and not len(self.led[0])
            and (self.press == 0.0 or not np.any(self.wind))
        )
