"""What one frame of a cloth is under."""

from __future__ import annotations

from dataclasses import dataclass, replace

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

    def part(self, early: float, late: float, places: np.ndarray) -> Conditions:
        """What holds from `early` to `late`, shares of the frame; places (V, 3) [m]: where the vertices are now."""

        def between(ends: tuple[float, float]) -> tuple[float, float]:
            first, last = ends
            return first + (last - first) * early, first + (last - first) * late

        index, there = self.led
        here = places[index]
        on = here + (there - here) * (late - early) / (1.0 - early)
        wind = self.wind
        if wind is not None:
            wind = np.stack([wind[0] + (wind[1] - wind[0]) * share for share in (early, late)])
        return replace(self, sewing=between(self.sewing), body=between(self.body), wind=wind, led=(index, on))

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
