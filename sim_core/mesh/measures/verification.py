"""What must hold of a finished panel mesh: orientation, Euler, one loop per contour, conformity, area."""

import numpy as np
from numba import njit

from sim_core.errors import OutlineError
from sim_core.mesh.measures.triangles import stars, triangle_areas
from sim_core.mesh.outline.contours import swept_area

__all__ = ["AREA_TOLERANCE", "area_error", "conformity", "fills", "mesh_fault", "open_edges", "verify"]

AREA_TOLERANCE = 1e-12


def area_error(vertices: np.ndarray, faces: np.ndarray, boundary: tuple[np.ndarray, ...]) -> float:
    """|sum of triangle areas - area inside the contours| / that area."""
    around = _steps(boundary)  # summed in one, since outline and hole of a thin ring cancel
    wanted = swept_area(vertices[around[:, 0]], vertices[around[:, 1]])
    error = abs(float(triangle_areas(vertices, faces).sum()) - wanted) / abs(wanted)
    if error <= AREA_TOLERANCE:
        return error
    # Slivers cancel: once more without rounding.
    exact = swept_area(vertices[faces.ravel()], vertices[np.roll(faces, -1, axis=1).ravel()])
    return abs(exact - wanted) / abs(wanted)


def open_edges(faces: np.ndarray, count: int) -> tuple[np.ndarray, int]:
    """Directed edges (k, 2) int32 without a partner, and a vertex where an edge is used twice one way (or -1)."""
    start, items = stars(faces, count)
    found, twice = _open_edges(faces, start, items)
    return found, int(twice)


@njit(cache=True, error_model="numpy")
def _open_edges(faces, start, items):
    found, kept, twice = np.zeros((3 * faces.shape[0], 2), np.int32), 0, -1
    left = np.full(start.size, -1, np.int32)  # by vertex: the last vertex that an edge led from to it
    for v in range(start.size - 1):
        for m in range(start[v], start[v + 1]):
            ahead = faces[items[m] // 3, (items[m] % 3 + 1) % 3]
            if left[ahead] == v:
                twice = v
            left[ahead] = v
        for m in range(start[v], start[v + 1]):
            behind = faces[items[m] // 3, (items[m] % 3 + 2) % 3]
            if left[behind] != v:
                found[kept, 0], found[kept, 1] = behind, v
                kept += 1
    return found[:kept].copy(), twice


def conformity(free: np.ndarray, boundary: tuple[np.ndarray, ...], count: int) -> float:
    """Fraction of outline steps that are among the mesh's `open_edges` (k, 2): with the cloth on their left only."""
    return float(np.isin(_keys(_steps(boundary), count), _keys(free, count)).mean())


def _steps(boundary: tuple[np.ndarray, ...]) -> np.ndarray:
    return np.concatenate([np.column_stack([loop, np.roll(loop, -1)]) for loop in boundary])


def _keys(edges: np.ndarray, count: int) -> np.ndarray:
    return edges[:, 0].astype(np.int64) * count + edges[:, 1]


def fills(vertices: np.ndarray, faces: np.ndarray, boundary: tuple[np.ndarray, ...]) -> bool:
    """Quick test for a front that has closed: only positive triangles, and together the area of the outline."""
    areas = triangle_areas(vertices, faces)
    return bool(areas.min() > 0) and area_error(vertices, faces, boundary) <= AREA_TOLERANCE


def mesh_fault(
    vertices: np.ndarray,
    faces: np.ndarray,
    boundary: tuple[np.ndarray, ...],
    lines: tuple[np.ndarray, ...] = (),
) -> tuple[str, int] | None:
    """The first thing that is wrong with a mesh as (what, vertex index where), or None. Arrays as in PanelMesh."""
    return _fault(vertices, faces, boundary, lines, *open_edges(faces, len(vertices)))


def _fault(vertices, faces, boundary, lines, free: np.ndarray, twice: int) -> tuple[str, int] | None:
    count = len(vertices)
    if len(faces) == 0:
        return "a triangle without area", 0
    areas = triangle_areas(vertices, faces)
    if areas.min() <= 0:
        return "a triangle without area", int(faces[areas.argmin(), 0])
    if twice >= 0:
        return "two triangles over each other", twice
    open_keys, steps = _keys(free, count), _keys(_steps(boundary), count)
    missing = steps[~np.isin(steps, open_keys)]
    if missing.size:
        return "an outline step that is not a mesh edge", int(missing[0] // count)
    if open_keys.size != steps.size:
        return "a hole in the mesh", int(open_keys[~np.isin(open_keys, steps)][0] // count)
    edges = (3 * len(faces) + len(free)) // 2
    if count - edges + len(faces) != 2 - len(boundary):
        unused = np.setdiff1d(np.arange(count), faces)
        return "Euler's number is wrong", int(unused[0]) if unused.size else 0
    if area_error(vertices, faces, boundary) > AREA_TOLERANCE:
        return "the area differs from the outline's", 0
    lost = _lost_step(faces, lines, count)
    return None if lost < 0 else ("an inner line that is not in the mesh", lost)


def _lost_step(faces: np.ndarray, lines: tuple[np.ndarray, ...], count: int) -> int:
    """A vertex of an inner line where its next step is no mesh edge, or -1."""
    if not lines:
        return -1
    steps = np.concatenate([np.column_stack([line[:-1], line[1:]]) for line in lines])
    ahead = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    keys = _keys(ahead, count)
    held = np.isin(_keys(steps, count), keys) | np.isin(_keys(steps[:, ::-1], count), keys)
    return -1 if held.all() else int(steps[np.flatnonzero(~held)[0], 0])


def verify(
    vertices: np.ndarray,
    faces: np.ndarray,
    boundary: tuple[np.ndarray, ...],
    edge: float,
    lines: tuple[np.ndarray, ...] = (),
) -> np.ndarray:
    """The mesh's `open_edges`. Raises OutlineError, saying where, unless it is a manifold that fills the contours."""
    free, twice = open_edges(faces, len(vertices))
    fault = _fault(vertices, faces, boundary, lines, free, twice)
    if fault is not None:
        x, y = vertices[fault[1]]
        raise OutlineError(
            f"outline: {fault[0]} near ({x:.4f}, {y:.4f}) m – the outline has a feature finer than the edge of "
            f"{edge} m there; give a smaller edge or smooth the outline"
        )
    return free
