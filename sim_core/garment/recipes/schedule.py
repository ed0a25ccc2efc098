"""What happens to a robe on a figure, when: sewn, welded, hung with arms out, arms lowered, settled, at rest."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from sim_core.body.pose import Pose
from sim_core.cloth import MovingGrid, Phase
from sim_core.cloth.step import FRAME

__all__ = ["Schedule"]

GRAVITY = 9.81  # [m/s2]
LIMIT = 0.04  # strain at which the threads of a softened cloth have no more to give: edges are held there
SHELL = 0.003  # [m] that two layers of a robe keep; with more, what elbows and armpits squeeze is strained
UNTANGLE = 40  # steps after each frame in which cloth that passed through itself is taken apart again


@dataclass(frozen=True)
class Schedule:
    """Seconds of each phase, and the pose at the end.

    friction: of cloth on the figure in the end; slip: while it finds its place, as if a hand smoothed the sleeves;
    frames_per_key: film frames from one key pose to the next.
    """

    pose: Pose = Pose(45.0, 12.0)
    sew: float = 0.88
    hold: float = 0.16
    hang: float = 0.72
    lower: float = 1.92
    settle: float = 0.88
    release: float = 0.6
    rest: float = 3.0
    friction: float = 0.45
    slip: float = 0.1
    frames_per_key: int = 1
    at_rest: float = 7e-6  # [m] p99 of the displacement per frame at which it is called at rest

    def keys(self) -> int:
        """How many key poses the arms pass, first and last included."""
        return round(self.lower / FRAME / self.frames_per_key) + 1

    def pose_of(self, key: float) -> Pose:
        """The pose of a key; the arms start and stop gently."""
        t = key / (self.keys() - 1)
        eased = 0.35 * t + 0.65 * t * t * (3 - 2 * t)
        return Pose(self.pose.arm * eased, self.pose.elbow * eased)

    def body(
        self, origin: tuple[float, float, float], cell: float, values: Callable[[Pose], np.ndarray], name: str
    ) -> MovingGrid:
        """The moving figure, its distance fields made when they are needed."""
        identity = f"{name} {self.pose} {self.keys()}"
        return MovingGrid(origin, cell, self.keys(), lambda k: values(self.pose_of(k)), identity)

    def sewing(self) -> tuple[Phase, ...]:
        """Seams drawn together in the laid position, and held until they are still."""
        return (
            Phase(self.sew, (0.0, 1.5), 6.0, 0.0, "sewing", sewing=(1.0, 0.0)),
            Phase(self.hold, (1.5, 1.5), 8.0, 0.0, "sewing"),
        )

    def dressing(self, nape: tuple[int, ...]) -> tuple[Phase, ...]:
        """From the welded robe on outstretched arms to arms that are down; `nape`: vertices pinned meanwhile."""
        return (
            Phase(self.hang, (2.0, GRAVITY), 3.0, 0.15, "hanging"),
            Phase(
                self.lower,
                damping=2.5,
                friction=self.slip,
                label="arms down",
                pins=nape,
                body=(0.0, self._down()),
            ),
        )

    def settling(self, nape: tuple[int, ...]) -> tuple[Phase, ...]:
        """From arms that are down to rest; `nape`: vertices let go on the way."""
        down = self._down(), self._down()
        still = Phase(self.settle, damping=1.5, friction=self.slip, label="settling", pins=nape, body=down)
        return (
            still,
            replace(still, seconds=self.release, damping=5.0, friction=self.friction, pins=()),
            Phase(
                self.rest, damping=10.0, friction=self.friction, label="at rest", rest=self.at_rest, body=down
            ),
        )

    def _down(self) -> float:
        """The last key."""
        return float(self.keys() - 1)
