"""What tests and bench make clips of: a sheet that waves, a coat that ripples, a figure that strides in place."""

from pathlib import Path

import numpy as np

from sim_core.body import Pose
from sim_core.cloth.scenes import equilateral_sheet
from sim_core.garment import Garment
from sim_core.garment.clip import Moved
from sim_core.garment.levels import Thinning

ROOT = Path(__file__).parents[2]


def waving(size: float = 1.0, edge: float = 0.02, frames: int = 12, noise: float = 0.0) -> Moved:
    """A sheet that waves once in its frames, as large and fine as asked for."""
    rest, faces = equilateral_sheet(1.0, 1.0, edge)
    phase = 2 * np.pi * np.arange(frames)[:, None] / frames
    x = np.broadcast_to(rest[:, 0], (frames, len(rest)))
    z = 0.1 * np.sin(7 * rest[:, 0] + phase) * np.cos(5 * rest[:, 1])
    positions = size * np.stack([x, np.broadcast_to(rest[:, 1], x.shape), z], axis=2)
    positions += np.random.default_rng(1).normal(0, noise, positions.shape) if noise else 0.0
    return Moved("sheet", positions, faces)


def striding(frames: int) -> list[Pose]:
    """Poses of legs, arms and trunk that swing, the root going to and fro."""
    swing = np.sin(2 * np.pi * np.arange(frames) / max(frames, 2))
    return [
        Pose.from_rotvecs(
            {
                "pelvis": (0.0, 9 * s, 0.0),
                "spine_2": (0.0, -7 * s, 2 * s),
                "hip_l": (-15 * s, 0.0, 0.0),
                "hip_r": (15 * s, 0.0, 0.0),
                "knee_l": (20 + 20 * s, 0.0, 0.0),
                "shoulder_l": (0.0, 20 * s, -60.0),
                "shoulder_r": (0.0, 20 * s, 60.0),
                "elbow_l": (0.0, -30 - 20 * s, 0.0),
                "elbow_r": (0.0, 30 - 20 * s, 0.0),
                "wrist_r": (10 * s, 0.0, 0.0),
            },
            (0.02 * s, 0.03 * s, 0.0),
        )
        for s in swing
    ]


def coat(frames: int, vertices: int) -> Moved:
    """The shipped coat, thinned to about so many vertices, with a ripple running down it."""
    garment = Garment.load(ROOT / "assets" / "exhibits" / "beizi" / "baked" / "garment.npz")
    mesh = Thinning(garment.positions, garment.faces, np.arange(len(garment.positions)))
    mesh.to(2 * vertices)
    used, index = np.unique(mesh.faces(), return_inverse=True)
    rest = garment.positions[used]
    phase = 2 * np.pi * np.arange(frames)[:, None] / frames
    ripple = 0.03 * np.sin(9 * rest[:, 1] - phase) * (1.5 - rest[:, 1])
    positions = np.repeat(rest[None], frames, axis=0)
    positions[:, :, 2] += ripple
    positions[:, :, 0] += 0.5 * ripple
    return Moved("beizi", positions, index.reshape(-1, 3).astype(np.int32))
