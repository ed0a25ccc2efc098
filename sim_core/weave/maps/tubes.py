"""Yarn curves as tubes: GLB (tubes) and PLY (axes as points and edges), for the closest zoom."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from sim_core.errors import WeaveError
from sim_core.weave.yarns.geometry import Strands

__all__ = ["coloured_stretches", "tube_mesh", "write_yarns"]

ROUND = 12  # vertices round a yarn


def tube_mesh(
    points: np.ndarray,
    half_width: np.ndarray | float,
    half_height: np.ndarray | float,
    sides: int = ROUND,
    *,
    around=None,
):
    """Open tube round an axis with an elliptic section. points: (n, 3) [m], z up; half_width, half_height: (n,) or one
    [m]; returns vertices and faces.

    around: the point before the first and the one after the last, so that a tube that goes on there fits without a
    seam.  The section stands across the axis, its width in the plane of the cloth: vertices (n * sides, 3), faces
    (2 (n - 1) sides, 3) int, counter-clockwise from outside.
    """
    if around is None:
        tangent = np.gradient(points, axis=0)
    else:
        tangent = np.gradient(np.vstack([around[0], points, around[1]]), axis=0)[1:-1]
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    across = np.cross(np.broadcast_to([0.0, 0.0, 1.0], tangent.shape), tangent)
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    up = np.cross(tangent, across)
    angle = 2 * np.pi * np.arange(sides) / sides
    wide, tall = (np.broadcast_to(half, len(points))[:, None, None] for half in (half_width, half_height))
    ring = wide * np.cos(angle)[:, None] * across[:, None] + tall * np.sin(angle)[:, None] * up[:, None]
    vertices = (points[:, None] + ring).reshape(-1, 3)
    i, k = np.indices((len(points) - 1, sides))
    a, b = i * sides + k, i * sides + (k + 1) % sides
    c, d = a + sides, b + sides
    faces = np.stack([np.stack([a, b, d], -1), np.stack([a, d, c], -1)], axis=2).reshape(-1, 3)
    return vertices, faces


def write_yarns(systems: tuple[Strands, ...], path: str | Path) -> None:
    """Write one repeat of all yarns; the cloth lies in the x-y plane of the GLB, its face towards +z, in metres.

    .glb: tubes with their colours, one mesh a colour; .ply: the axes as points, with edges between them.
    Raises WeaveError for another kind of file, OSError where it cannot be written.
    """
    path = Path(path)
    if path.suffix.lower() == ".glb":
        path.write_bytes(_glb(systems))
    elif path.suffix.lower() == ".ply":
        path.write_bytes(_ply(systems))
    else:
        raise WeaveError(f"{path}: {path.suffix or 'no ending'} – end the name with .glb or .ply")


def coloured_stretches(system: Strands):
    """(points, colour index, points before and after, half widths and half heights) of each stretch of yarn that is
    there and of one colour.

    Whole yarns close: their last point is the first of the next repeat.
    """
    for number, colour in enumerate(system.colour):
        points = system.points(number)
        step = np.zeros(3)
        step[1 if system.along == "warp" else 0] = system.length
        around = np.vstack([points[-1:] - step, points, points[:2] + step])
        halves = np.column_stack([system.half_width[number], system.half_height[number]])
        halves = np.vstack([halves, halves[:1]])
        points, colour = around[1:-1], np.append(colour, colour[0])
        cuts = np.flatnonzero(np.diff(colour)) + 1
        for part in np.split(np.arange(len(colour)), cuts):
            if colour[part[0]] >= 0:
                if part[-1] + 1 < len(colour) and colour[part[-1] + 1] >= 0:
                    part = np.append(part, part[-1] + 1)
                if len(part) > 1:
                    yield (
                        points[part],
                        int(colour[part[0]]),
                        (around[part[0]], around[part[-1] + 2]),
                        halves[part].T,
                    )


def _glb(systems: tuple[Strands, ...]) -> bytes:
    import trimesh
    from trimesh.visual import TextureVisuals
    from trimesh.visual.material import PBRMaterial

    scene = trimesh.Scene()
    for system in systems:
        made: dict[int, tuple[list, list, int]] = {}
        for points, colour, around, halves in coloured_stretches(system):
            vertices, faces = tube_mesh(points, *halves, around=around)
            vs, fs, count = made.get(colour, ([], [], 0))
            made[colour] = ([*vs, vertices], [*fs, faces + count], count + len(vertices))
        for colour, (vertices, faces, _) in made.items():
            rgb = np.append(np.rint(system.palette[colour] * 255), 255).astype(np.uint8)
            material = PBRMaterial(baseColorFactor=rgb, metallicFactor=0.0, roughnessFactor=0.5)
            mesh = trimesh.Trimesh(np.concatenate(vertices), np.concatenate(faces), process=False)
            mesh.visual = TextureVisuals(material=material)
            scene.add_geometry(mesh, geom_name=f"{system.along} {colour}")
    return scene.export(file_type="glb")  # type: ignore[return-value]


def _ply(systems: tuple[Strands, ...]) -> bytes:
    points, tints, edges, count = [], [], [], 0
    for system in systems:
        for part, colour, _, _ in coloured_stretches(system):
            points.append(part)
            tints.append(np.tile(np.rint(system.palette[colour] * 255).astype(int), (len(part), 1)))
            edges.append(count + np.column_stack([np.arange(len(part) - 1), np.arange(1, len(part))]))
            count += len(part)
    head = (
        f"ply\nformat ascii 1.0\ncomment yarn axes of one repeat, metres\nelement vertex {count}\nproperty double x\n"
        "property double y\nproperty double z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
        f"element edge {sum(map(len, edges))}\nproperty int vertex1\nproperty int vertex2\nend_header\n"
    )
    rows = [
        f"{p[0]:.9g} {p[1]:.9g} {p[2]:.9g} {t[0]} {t[1]} {t[2]}"
        for p, t in zip(np.concatenate(points), np.concatenate(tints), strict=True)
    ]
    rows += [f"{a} {b}" for a, b in np.concatenate(edges)]
    return (head + "\n".join(rows) + "\n").encode("ascii")
