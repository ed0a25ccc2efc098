"""How layers that are dressed already moved with the wearer: the film of the next one shows them in its poses."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from sim_core.body.pose import Pose
    from sim_core.garment import Frame

__all__ = ["TrailLostError", "Trails"]


class TrailLostError(RuntimeError):
    """A layer beneath was dressed by an earlier, interrupted run that did not note how it moved."""


class Trails:
    """Positions of each layer by the wearer's pose, in the order they were heard; kept in `folder` layer by layer."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._heard: dict[int, list[tuple[np.ndarray, NDArray[np.floating]]]] = {}
        self._noted: dict[int, tuple[np.ndarray, np.ndarray]] = {}
        self._now: set[int] = set()

    def hear(self, frame: Frame) -> None:
        """Notes one frame; of frames in one pose the last counts."""
        self._now.add(frame.layer)
        pose, own = frame.pose.quaternions(), self._heard.setdefault(frame.layer, [])
        if own and np.array_equal(own[-1][0], pose):
            own.pop()
        own.append((pose, np.asarray(frame.positions, np.float32)))

    def heard_now(self, layer: int) -> bool:
        """Whether this run heard that layer's frames, not an earlier one alone."""
        return layer in self._now

    def beneath(self, layer: int, pose: Pose) -> list[np.ndarray]:
        """Positions (P, 3) float32 [m] of the layers under `layer` when the wearer was nearest to `pose`, last first.

        Raises TrailLostError where one of them has not been heard, in this run or an earlier one.
        """
        at, found = pose.quaternions(), []
        for number in reversed(range(layer)):
            poses, positions = self._trail(number)
            away = np.abs(poses - at).sum((1, 2))
            found.append(positions[len(away) - 1 - int(np.argmin(away[::-1]))])
        return found

    def _trail(self, layer: int) -> tuple[np.ndarray, np.ndarray]:
        """Poses (T, 21, 4) and positions (T, P, 3) of a layer whose dressing has come to its end."""
        file = self._folder / f"trail-{layer}.npz"
        if layer not in self._noted and layer in self._heard:
            poses, positions = (np.stack(part) for part in zip(*self._heard.pop(layer), strict=True))
            self._noted[layer] = poses, positions
            partial = file.with_name(f".{file.name}")
            np.savez(partial, poses=poses, positions=positions)
            partial.replace(file)
        elif layer not in self._noted:
            try:
                with np.load(file) as kept:
                    self._noted[layer] = kept["poses"], kept["positions"]
            except FileNotFoundError as error:
                raise TrailLostError(f"layer {layer + 1}") from error
        return self._noted[layer]
