"""How an outfit moves: its wearer goes through its motion, its garments follow, and both models play it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from hall_app.build.points import write_points
from hall_app.content.files import BAKED, CLOSE_MOTION, MOTION

if TYPE_CHECKING:
    from sim_core.garment import Garment, Outfit, Played

__all__ = ["play", "write_motion"]

Progress = Callable[[float, str], None]
RATE = 25.0  # frames a second of `move`
OUT = 0.01  # [m] that a thinned layer may have been moved out of those beneath
CLIPS = {"hall.glb": MOTION, "close.glb": CLOSE_MOTION}  # what moves each model


def play(outfit: Outfit, garments: Sequence[Garment], progress: Progress) -> Played | None:
    """The outfit's motion as `move` plays it; None where it names none. Raises what `move` raises."""
    from sim_core.garment import move

    if outfit.motion is None or outfit.wearer is None:
        return None
    return move(outfit, garments, progress=progress)


def write_motion(
    outfit: Outfit, garments: Sequence[Garment], played: Played, folder: Path, progress: Progress
) -> dict[str, float]:
    """Writes a clip beside each model in `folder`, for its vertices, and motion.points, what is tracked of the wearer;
    returns the worst of all frames by the names of the record: moving_deepest_m, of what is worn beneath
    robe_moving_deepest_m.

    Raises what `Clip` raises.
    """
    from sim_core.garment import moving_errors
    from sim_core.garment.clip import model_clip
    from sim_core.garment.levels import BASE

    assert outfit.wearer is not None
    layers = enumerate(zip(garments, played.frames, strict=True), 1)
    moved = {f"{number} {g.name}": np.concatenate([g.positions[None], x]) for number, (g, x) in layers}
    poses = (outfit.pose, *played.poses)
    for model, clip in CLIPS.items():
        model_clip(
            (folder / model).read_bytes(),
            moved,
            figure=(outfit.wearer, poses),
            begin=1,
            lift=BASE[1],
            near=OUT if len(garments) > 1 else 1e-4,
            rate=RATE,
            loop=played.loop,
        ).save(folder / clip.removeprefix(BAKED))
    write_points(outfit.wearer, poses, moved, folder, rate=RATE, loop=played.loop, begin=1)
    worst = moving_errors(outfit, garments, played, progress=progress)
    errors: dict[str, float] = {}
    for number, (garment, told) in enumerate(zip(garments, worst, strict=True), 1):
        before = "" if number == len(garments) else f"{garment.name}_"
        errors |= {f"{before}moving_{name}": value for name, value in told.items()}
    return errors | {"moving_frames": len(played.poses)}
