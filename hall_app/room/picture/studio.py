"""The surroundings of close-ups: a plate on pale ground before a wall that catches the light."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hall_app.room.surface.palette import linear
from sim_core.gltf import GlbFile

__all__ = ["studio_glb"]

_UNLIT = "KHR_materials_unlit"
_WALL, _GLOW, _GROUND, _PLATE = "#8B8171", "#DED5C5", "#9A8F7D", "#AEA290"


def studio_glb(radius: float = 9.0) -> bytes:
    """A dome that is brightest behind the exhibit, ground that darkens away from it, a round plate with a soft rim."""
    glb = GlbFile()
    material = glb.material({"doubleSided": True, "extensions": {_UNLIT: {}}})
    for name, (vertices, faces, colours) in {
        "dome": _dome(radius),
        "ground": _rings([0.0, 1.4, 1.8, 2.6, 4.5, radius], _shadowed, -0.06),
        "plate": _rings([0.0, 1.2, 1.46, 1.5], _lit, 0.0, skirt=0.06),
    }.items():
        glb.mesh(name, vertices, faces, material, colours=colours)
    return glb.bytes("studio", [_UNLIT], "hall_app.room")


def _dome(radius: float) -> tuple[NDArray, NDArray, NDArray]:
    rings, sides = 18, 48
    angle = 2 * np.pi * np.arange(sides) / sides
    vertices, colours = [], []
    for share in np.linspace(-0.02, 1.0, rings):
        around = radius * np.cos(max(share, 0.0) * np.pi / 2)
        vertices.append(
            np.column_stack([around * np.cos(angle), np.full(sides, share * radius), around * np.sin(angle)])
        )
        glow = np.exp(-(((share - 0.12) / 0.30) ** 2))
        colours.append(np.broadcast_to(_mixed(_WALL, _GLOW, glow), (sides, 3)))
    faces = []
    for ring in range(rings - 1):
        for side in range(sides):
            a, b = ring * sides + side, ring * sides + (side + 1) % sides
            faces += [[a, a + sides, b], [b, a + sides, b + sides]]
    keep = np.array(faces, np.int32)
    points = np.concatenate(vertices)
    sides_of = points[keep]
    area = np.linalg.norm(np.cross(sides_of[:, 1] - sides_of[:, 0], sides_of[:, 2] - sides_of[:, 0]), axis=1)
    return points, keep[area > 1e-9], np.concatenate(colours)


def _rings(
    radii: list[float], paint, height: float, skirt: float = 0.0, sides: int = 64
) -> tuple[NDArray, NDArray, NDArray]:
    """Concentric rings at `height` [m]; skirt: how far the rim goes down."""
    angle = 2 * np.pi * np.arange(sides) / sides
    levels = [(r, height) for r in radii[1:]] + ([(radii[-1], height - skirt)] if skirt else [])
    vertices, colours = [np.array([[0, height, 0]])], [paint(0.0)[None]]
    for k, (r, y) in enumerate(levels):
        vertices.append(np.column_stack([r * np.sin(angle), np.full(sides, y), r * np.cos(angle)]))
        dim = 0.72 if skirt and k == len(levels) - 1 else 1.0
        colours.append(np.broadcast_to(paint(r) * dim, (sides, 3)))
    faces = [[0, 1 + s, 1 + (s + 1) % sides] for s in range(sides)]
    for k in range(len(levels) - 1):
        for s in range(sides):
            a, b = 1 + k * sides + s, 1 + k * sides + (s + 1) % sides
            faces += [[a, a + sides, b], [b, a + sides, b + sides]]
    return np.concatenate(vertices), np.array(faces, np.int32), np.concatenate(colours)


def _mixed(low: str, high: str, share: float) -> NDArray[np.float64]:
    return linear(low) + (linear(high) - linear(low)) * share


def _lit(radius: float) -> NDArray[np.float64]:
    """The plate: lighter in its middle."""
    return _mixed(_PLATE, "#C4B9A7", float(np.exp(-((radius / 0.9) ** 2))))


def _shadowed(radius: float) -> NDArray[np.float64]:
    """The ground: dark against the plate's rim, pale beyond, the wall's tone at the horizon."""
    near = float(np.exp(-(((radius - 1.4) / 0.35) ** 2)))
    far = min(radius / 9.0, 1.0)
    return _mixed(_GROUND, _WALL, far) * (1 - 0.35 * near)
