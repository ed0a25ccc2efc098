"""Meshes side by side that move by one clock: a GLB that holds them all, and the clip that moves it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sim_core.errors import SimCoreError
from sim_core.garment.clip import Clip, model_clip
from sim_core.gltf import GlbFile

__all__ = ["Side", "side_by_side_clip"]

APART = 1.05  # widths of the widest from one middle to the next
ROUGH = 0.8
SOLID = "#6b5d52"


@dataclass(frozen=True)
class Side:
    """One mesh: its name as a node, colour #rrggbb, frames (T, V, 3) [m], faces (F, 3)."""

    name: str
    colour: str
    frames: np.ndarray
    faces: np.ndarray


def side_by_side_clip(
    sides: Sequence[Side],
    rate: float,
    *,
    solid: tuple[np.ndarray, np.ndarray] | None = None,
) -> tuple[bytes, Clip]:
    """A GLB of the meshes from left to right, which stands as they are where one reaches lowest, and its clip.

    They keep their heights over each other, the lowest vertex of all frames at y = 0, the middle over the origin.
    solid: vertices (S, 3) [m] and faces of what each of them lies on, which stands still.
    Raises SimCoreError without a mesh, and as `Clip.of` does.
    """
    if not sides:
        raise SimCoreError("sides – give one mesh at least")
    everything = [side.frames.reshape(-1, 3) for side in sides] + ([solid[0]] if solid is not None else [])
    low = np.min([places.min(0) for places in everything], axis=0).astype(float)
    high = np.max([places.max(0) for places in everything], axis=0).astype(float)
    middle = np.array([0.5 * (low[0] + high[0]), low[1], 0.5 * (low[2] + high[2])])
    step = APART * (high[0] - low[0])
    shifts = [
        np.array([step * (number - 0.5 * (len(sides) - 1)), 0.0, 0.0]) - middle
        for number in range(len(sides))
    ]
    stands = int(np.argmin(np.min([side.frames[:, :, 1].min(1) for side in sides], axis=0)))
    glb, moved = GlbFile(), {}
    for side, shift in zip(sides, shifts, strict=True):
        frames = side.frames.astype(float) + shift
        moved[side.name] = np.concatenate([frames[stands : stands + 1], frames])
        glb.mesh(side.name, frames[stands], side.faces, _material(glb, side.name, side.colour))
    if solid is not None:
        glb.mesh("solid-1", solid[0] + shifts[0], solid[1], _material(glb, "solid", SOLID))
        for number, shift in enumerate(shifts[1:], 2):
            glb.copy(f"solid-{number}", len(sides), shift - shifts[0])
    model = glb.bytes("comparison", [], generator="sim_core.learn")
    return model, model_clip(model, moved, rate=rate, begin=1)


def _material(glb: GlbFile, name: str, colour: str) -> int:
    return glb.material(
        {
            "name": name,
            "doubleSided": True,
            "pbrMetallicRoughness": {
                "baseColorFactor": [*_linear(colour), 1.0],
                "metallicFactor": 0.0,
                "roughnessFactor": ROUGH,
            },
        }
    )


def _linear(colour: str) -> list[float]:
    """Shares of light of an sRGB colour #rrggbb."""
    shown = np.array([int(colour[k : k + 2], 16) for k in (1, 3, 5)]) / 255.0
    return np.where(shown <= 0.04045, shown / 12.92, ((shown + 0.055) / 1.055) ** 2.4).tolist()
