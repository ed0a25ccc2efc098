"""Closed triangle meshes of the analytic solids, faces counter-clockwise from outside."""

from __future__ import annotations

import numpy as np

from sim_core.cloth.contact.solids import Box, Capsule, Cylinder, Solid
from sim_core.errors import SimCoreError

Mesh = tuple[np.ndarray, np.ndarray]


def solid_mesh(solid: Solid, segments: int = 28) -> Mesh:
    """Vertices (V, 3) [m] and faces (F, 3) of a capsule, cylinder or box; `segments` around a full circle.

    Raises SimCoreError for solids that have no closed surface of their own.
    """
    if isinstance(solid, Capsule):
        return _capsule(solid, segments)
    if isinstance(solid, Cylinder):
        return _cylinder(solid, segments)
    if isinstance(solid, Box):
        return _box(solid, max(1, segments // 8))
    raise SimCoreError(f"{type(solid).__name__}: has no display mesh – use capsules, cylinders and boxes")


def _lathe(profile: np.ndarray, start: np.ndarray, axis: np.ndarray, segments: int) -> Mesh:
    """Turns profile (P, 2) of (radius, height along axis), from the lower to the upper pole, about the axis."""
    helper = np.array([1.0, 0.0, 0.0]) if abs(axis[0]) < 0.9 else np.array([0.0, 0.0, 1.0])
    side = np.cross(axis, helper)
    side /= np.linalg.norm(side)
    other = np.cross(axis, side)
    angle = 2 * np.pi * np.arange(segments) / segments
    spoke = np.cos(angle)[:, None] * side + np.sin(angle)[:, None] * other
    inner = profile[1:-1]
    rings = inner[:, 0, None, None] * spoke + (start + inner[:, 1, None] * axis)[:, None]
    poles = start + profile[[0, -1], 1, None] * axis
    vertices = np.concatenate([rings.reshape(-1, 3), poles])
    ring, step = np.arange(segments), np.roll(np.arange(segments), -1)
    faces = [np.stack([np.full(segments, len(vertices) - 2), step, ring], axis=1)]
    for k in range(len(inner) - 1):
        low, high = k * segments, (k + 1) * segments
        faces += [np.stack([low + ring, low + step, high + step], axis=1)]
        faces += [np.stack([low + ring, high + step, high + ring], axis=1)]
    top = (len(inner) - 1) * segments
    faces.append(np.stack([top + ring, top + step, np.full(segments, len(vertices) - 1)], axis=1))
    return vertices, np.concatenate(faces).astype(np.int32)


def _axis(
    start: tuple[float, float, float], end: tuple[float, float, float]
) -> tuple[np.ndarray, np.ndarray, float]:
    a, b = np.asarray(start, float), np.asarray(end, float)
    length = float(np.linalg.norm(b - a))
    return a, (b - a) / length if length else np.array([0.0, 1.0, 0.0]), length


def _capsule(solid: Capsule, segments: int) -> Mesh:
    start, axis, length = _axis(solid.start, solid.end)
    angle = np.linspace(0, np.pi / 2, segments // 4 + 1)
    low = np.stack([np.sin(angle), -np.cos(angle)], axis=1) * solid.radius
    high = np.stack([np.cos(angle), np.sin(angle)], axis=1) * solid.radius + [0, length]
    profile = np.concatenate([low, high if length else high[1:]])
    return _lathe(profile, start, axis, segments)


def _cylinder(solid: Cylinder, segments: int) -> Mesh:
    start, axis, length = _axis(solid.start, solid.end)
    r, flat = solid.rounding, solid.radius - solid.rounding
    angle = np.linspace(0, np.pi / 2, max(2, segments // 6)) if r > 0 else np.zeros(1)
    low = np.stack([flat + r * np.sin(angle), r - r * np.cos(angle)], axis=1)
    high = np.stack([flat + r * np.cos(angle), length - r + r * np.sin(angle)], axis=1)
    profile = np.concatenate([[[0.0, 0.0]], low, high, [[0.0, length]]])
    keep = np.r_[True, (np.abs(np.diff(profile, axis=0)) > 1e-9).any(1)]
    return _lathe(profile[keep], start, axis, segments)


def _box(solid: Box, corner: int) -> Mesh:
    """A cube's faces, finely divided near the edges, pulled onto the rounded surface."""
    half = np.asarray(solid.size, float) / 2
    inner = half - solid.rounding
    bend = np.linspace(0, 1, corner + 1) if solid.rounding > 0 else np.array([0.0])
    vertices, faces, count = [], [], 0
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for side in (-1.0, 1.0):
            lines = [
                np.concatenate([-inner[k] - solid.rounding * bend[::-1], inner[k] + solid.rounding * bend])
                for k in (u, v)
            ]
            a, b = np.meshgrid(*lines, indexing="ij")
            cube = np.zeros((a.size, 3))
            cube[:, u], cube[:, v], cube[:, axis] = a.ravel(), b.ravel(), side * half[axis]
            core = np.clip(cube, -inner, inner)
            away = cube - core
            size = np.linalg.norm(away, axis=1, keepdims=True)
            vertices.append(
                core + solid.rounding * away / np.where(size > 0, size, 1) if solid.rounding else cube
            )
            i = (
                np.arange(len(lines[0]) - 1)[:, None] * len(lines[1]) + np.arange(len(lines[1]) - 1)
            ).ravel() + count
            w = len(lines[1])
            quads = np.concatenate([np.stack([i, i + w, i + w + 1], 1), np.stack([i, i + w + 1, i + 1], 1)])
            faces.append(quads if side > 0 else quads[:, ::-1])
            count += a.size
    v, f = _welded(np.concatenate(vertices), np.concatenate(faces))
    c, s = np.cos(solid.yaw), np.sin(solid.yaw)
    turn = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    return v @ turn.T + np.asarray(solid.centre, float), f.astype(np.int32)


def _welded(vertices: np.ndarray, faces: np.ndarray) -> Mesh:
    _, first, index = np.unique(np.round(vertices, 9), axis=0, return_index=True, return_inverse=True)
    faces = index.reshape(-1)[faces]
    solid = (faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])
    return vertices[first], faces[solid]
