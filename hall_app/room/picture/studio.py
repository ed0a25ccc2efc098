"""The surroundings of close-ups: one ground that curves up into a dome, with a pool of light and a soft shadow in it.

No line parts ground and wall, from wherever a visitor looks: tones follow the way along the profile without a step.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hall_app.room.surface.palette import linear
from sim_core.gltf import GlbFile

__all__ = ["studio_glb"]

_UNLIT = "KHR_materials_unlit"
_POOL, _GROUND, _GLOW, _ABOVE = "#C6BBA9", "#A99E8C", "#DDD4C4", "#857B6B"
_FLAT = 0.36  # share of the radius that is level ground
_STEPS, _SIDES = 56, 32
_SHADE = 0.5  # of the ground's light, right under an exhibit
_UNDER = 0.42  # [m] over which that shade fades


def studio_glb(radius: float = 9.0) -> bytes:
    """Ground and dome as one surface of revolution, coloured at its corners."""
    glb = GlbFile()
    material = glb.material({"doubleSided": True, "extensions": {_UNLIT: {}}})
    around, height = _profile(radius)
    angle = 2 * np.pi * np.arange(_SIDES) / _SIDES
    vertices = np.stack(
        np.broadcast_arrays(
            around[:, None] * np.sin(angle), height[:, None], around[:, None] * np.cos(angle)
        ),
        axis=-1,
    ).reshape(-1, 3)
    step, side = (one.ravel() for one in np.mgrid[: len(around) - 1, :_SIDES])
    a, b = step * _SIDES + side, step * _SIDES + (side + 1) % _SIDES
    quads = np.stack([a, a + _SIDES, b, b, a + _SIDES, b + _SIDES], axis=1).reshape(-1, 3)
    corners = vertices[quads]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    colours = np.repeat(_tones(around, height, radius), _SIDES, axis=0)
    glb.mesh("studio", vertices, quads[area > 1e-9].astype(np.int32), material, colours=colours)
    return glb.bytes("studio", [_UNLIT], "hall_app.room")


def _profile(radius: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Distance from the axis and height (N,) [m], from the middle of the ground to the top of the dome."""
    flat = _FLAT * radius
    ground = flat * np.linspace(0.0, 1.0, _STEPS // 2, endpoint=False) ** 1.5  # closer where the shadow fades
    bend = np.linspace(
        -np.pi / 2, np.pi / 2, _STEPS
    )  # a half ellipse beside the axis: level ground, wall, ceiling
    wall = flat + (radius - flat) * np.cos(bend)
    wall = np.where(bend > 0.0, radius * np.cos(bend), wall)
    return np.concatenate([ground, wall]), np.concatenate(
        [np.zeros(len(ground)), 0.5 * radius * (1 + np.sin(bend))]
    )


def _tones(around: NDArray, height: NDArray, radius: float) -> NDArray[np.float64]:
    """Linear colours (N, 3): a pool of light that fades outwards, a glow at the height of what is shown, dusk above."""
    way = np.cumsum(np.hypot(np.diff(around, prepend=0.0), np.diff(height, prepend=0.0)))
    pool = np.exp(-((way / (0.24 * radius)) ** 2))
    glow = np.exp(-(((height / radius - 0.24) / 0.17) ** 2))
    dusk = _smooth((height / radius - 0.3) / 0.5)
    tone = _mixed(linear(_GROUND), linear(_POOL), pool)
    tone = _mixed(tone, linear(_GLOW), glow)
    tone = _mixed(tone, linear(_ABOVE), dusk)
    under = np.exp(-((way / _UNDER) ** 2))
    return tone * (1 - _SHADE * under)[:, None]


def _mixed(low: NDArray, high: NDArray, share: NDArray) -> NDArray[np.float64]:
    return low + (high - low) * share[:, None]


def _smooth(share: NDArray) -> NDArray[np.float64]:
    """0 to 1 without a kink at either end."""
    inside = np.clip(share, 0.0, 1.0)
    return inside * inside * (3 - 2 * inside)
