"""What must hold of a finished panel mesh: orientation, Euler, one loop per contour, conformity, area."""

import numpy as np

from sim_core.errors import OutlineError
from sim_core.mesh.outline import signed_area
from sim_core.mesh.quality import triangle_areas

__all__ = ["AREA_TOLERANCE", "area_error", "conformity", "fills", "mesh_fault", "verify"]

AREA_TOLERANCE = 1e-12


def area_error(vertices: np.ndarray, faces: np.ndarray, boundary: tuple[np.ndarray, ...]) -> float:
    """|sum of triangle areas - area inside the contours| / that area."""
    wanted = sum(signed_area(vertices[loop]) for loop in boundary)
    return abs(float(triangle_areas(vertices, faces).sum()) - wanted) / abs(wanted)


def conformity(faces: np.ndarray, boundary: tuple[np.ndarray, ...], count: int) -> float:
    """Fraction of outline steps that are edges of the mesh with the cloth on their left only."""
    open_edges = _open_edges(faces, count)
    steps = np.concatenate([loop.astype(np.int64) * count + np.roll(loop, -1) for loop in boundary])
    return float(np.isin(steps, open_edges).mean())


def _open_edges(faces: np.ndarray, count: int) -> np.ndarray:
    """Keys from * count + to of the directed edges that have no partner."""
    ahead, back = _directed(faces, count)
    return ahead[~np.isin(ahead, back)]


def _directed(faces: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    wide = faces.astype(np.int64)
    a, b = wide.ravel(), np.roll(wide, -1, axis=1).ravel()
    return a * count + b, b * count + a


def fills(vertices: np.ndarray, faces: np.ndarray, boundary: tuple[np.ndarray, ...]) -> bool:
    """Quick test for a front that has closed: only positive triangles, and together the area of the outline."""
    areas = triangle_areas(vertices, faces)
    return bool(areas.min() > 0) and area_error(vertices, faces, boundary) <= AREA_TOLERANCE


def mesh_fault(
    vertices: np.ndarray, faces: np.ndarray, boundary: tuple[np.ndarray, ...]
) -> tuple[str, int] | None:
    """The first thing that is wrong with a mesh as (what, vertex index where), or None."""
    count = len(vertices)
    areas = triangle_areas(vertices, faces)
    if len(areas) == 0 or areas.min() <= 0:
        return "a triangle without area", int(faces[areas.argmin(), 0]) if len(areas) else 0
    ahead, back = _directed(faces, count)
    order = np.sort(ahead)
    twice = np.flatnonzero(order[1:] == order[:-1])
    if twice.size:
        return "two triangles over each other", int(order[twice[0]] // count)
    steps = np.concatenate([loop.astype(np.int64) * count + np.roll(loop, -1) for loop in boundary])
    open_edges = ahead[~np.isin(ahead, back)]
    missing = steps[~np.isin(steps, open_edges)]
    if missing.size:
        return "an outline step that is not a mesh edge", int(missing[0] // count)
    if open_edges.size != steps.size:
        return "a hole in the mesh", int(open_edges[~np.isin(open_edges, steps)][0] // count)
    edges = (ahead.size + open_edges.size) // 2
    if count - edges + len(faces) != 2 - len(boundary):
        unused = np.setdiff1d(np.arange(count), faces)
        return "Euler's number is wrong", int(unused[0]) if unused.size else 0
    if area_error(vertices, faces, boundary) > AREA_TOLERANCE:
        return "the area differs from the outline's", 0
    return None


def verify(vertices: np.ndarray, faces: np.ndarray, boundary: tuple[np.ndarray, ...], edge: float) -> None:
    """Raise OutlineError, saying where, unless the mesh is a manifold that fills the contours exactly."""
    fault = mesh_fault(vertices, faces, boundary)
    if fault is not None:
        x, y = vertices[fault[1]]
        raise OutlineError(
            f"outline: {fault[0]} near ({x:.4f}, {y:.4f}) m – the outline has a feature finer than the edge of "
            f"{edge} m there; give a smaller edge or smooth the outline"
        )
