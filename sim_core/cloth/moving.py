"""A body that moves while cloth lies on it: sampled distance fields, one per key pose, blended in time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from sim_core.cloth.collider import GRID, MOVING, Packed
from sim_core.errors import SimCoreError

_WIDTH = 20


@dataclass(frozen=True)
class MovingGrid:
    """Distance fields on one grid: key(k) gives the values (nx, ny, nz) [m] of pose k, 0 <= k < count.

    origin (3,), cell [m]; name identifies all poses (a hash of what they are made from) for checkpoints. Between two
    keys the distance is blended linearly, so a limb should move less than half its thickness from key to key.
    """

    origin: tuple[float, float, float]
    cell: float
    count: int
    key: Callable[[int], np.ndarray] = field(repr=False)
    name: str = ""
    _kept: dict[int, np.ndarray] = field(default_factory=dict, repr=False, compare=False)

    def packed(self, early: float, late: float) -> tuple[Packed, tuple[float, float]]:
        """The arrays for a frame in which the body goes from `early` to `late` (in keys), and both within its keys.

        Raises SimCoreError when a frame would pass a key, or leave them.
        """
        low, high = min(early, late), max(early, late)
        if low < -1e-9 or high > self.count - 1 + 1e-9:
            raise SimCoreError(f"body: keys {early:.2f} to {late:.2f} – there are 0 to {self.count - 1}")
        if high - low < 1e-9 and abs(low - round(low)) < 1e-9:
            return self._pack(GRID, round(low), round(low)), (0.0, 0.0)
        k = min(int(low + 1e-9), self.count - 2)
        if high > k + 1 + 1e-9:
            raise SimCoreError(
                f"body: a frame goes from key {early:.2f} to {late:.2f} – at most to the next key"
            )
        return self._pack(MOVING, k, k + 1), (early - k, late - k)

    def _pack(self, kind: int, first: int, second: int) -> Packed:
        for k in [k for k in self._kept if k not in (first, second)]:
            del self._kept[k]
        for k in (first, second):
            if k not in self._kept:
                self._kept[k] = np.ascontiguousarray(self.key(k), np.float32)
        data = np.zeros((1, _WIDTH))
        data[0, :3], data[0, 3], data[0, 19] = self.origin, self.cell, -1.0
        return Packed(np.array([kind]), data, self._kept[first], self._kept[second], np.zeros(2))
