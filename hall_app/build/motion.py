"""How an outfit moves: its wearer goes through its motion, its garments follow, and the hall's model plays it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from hall_app.build.points import write_points
from hall_app.content.files import BAKED, MOTION

if TYPE_CHECKING:
    from sim_core.garment import Garment, Outfit

__all__ = ["write_motion"]

Progress = Callable[[float, str], None]
RATE = 25.0  # frames a second of `move`
OUT = 0.01  # [m] that a thinned layer may have been moved out of those beneath


def write_motion(outfit: Outfit, garments: Sequence[Garment], folder: Path, progress: Progress) -> bool:
    """Writes motion.clip and motion.points beside hall.glb, for its vertices; whether the outfit names a motion.

    A motion that ends in the pose it begins with is a loop. Raises what `move` and `Clip` raise.
    """
    from sim_core.garment import move
    from sim_core.garment.clip import model_clip
    from sim_core.garment.levels import BASE

    if outfit.motion is None or outfit.wearer is None:
        return False
    _, gone = move(outfit, garments, progress=progress)
    poses = outfit.poses()
    loop = len(poses) > 1 and poses[-1] == poses[0]
    count = len(poses) - loop  # the first frame follows the last but one
    moved = {
        f"{number} {g.name}": x[:count] for number, (g, x) in enumerate(zip(garments, gone, strict=True), 1)
    }
    clip = model_clip(
        (folder / "hall.glb").read_bytes(),
        moved,
        figure=(outfit.wearer, poses[:count]),
        lift=BASE[1],
        near=OUT if len(garments) > 1 else 1e-4,
        rate=RATE,
        loop=loop,
    )
    clip.save(folder / MOTION.removeprefix(BAKED))
    write_points(outfit.wearer, poses[:count], moved, folder, rate=RATE, loop=loop)
    return True
