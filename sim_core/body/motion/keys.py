"""How a wearer moves: poses and the time from each to the next, played at 25 frames a second."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from sim_core.body.pose import Pose

__all__ = ["RATE", "Motion", "eased"]

RATE = 25  # poses a second


def eased(t: float) -> float:
    """Limbs start and stop gently: the share of the way gone after the share t of the time."""
    return 0.35 * t + 0.65 * t * t * (3 - 2 * t)


@dataclass(frozen=True)
class Motion:
    """keys: seconds and the pose that is reached after them, each key from the one before; the first begins where the
    wearer stands."""

    keys: tuple[tuple[float, Pose], ...]

    def poses(self, start: Pose) -> tuple[Pose, ...]:
        """The wearer's pose at the begin and at the end of every frame; joints go by the shortest turn, gently.

        Raises SimCoreError, naming the key, where a joint would be turned beyond its limit on the way.
        """
        out = [start]
        for number, (seconds, end) in enumerate(self.keys, 1):
            begin, count = out[-1], max(1, round(seconds * RATE))
            for frame in range(1, count + 1):
                pose = begin.towards(end, eased(frame / count))
                pose.check(f"motion.{number}")
                out.append(pose)
        return tuple(out)

    def table(self) -> list[dict[str, Any]]:
        """As plain values."""
        return [{"seconds": seconds, "pose": pose.table()} for seconds, pose in self.keys]
