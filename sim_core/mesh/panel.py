"""Outline to panel mesh: samples, staggered points, redundant points out, growth, check."""

from time import perf_counter

import numpy as np

from sim_core.errors import OutlineError
from sim_core.mesh.best import BestFill, best_fill
from sim_core.mesh.growth import CLOSED, Growth, grow_points
from sim_core.mesh.lattice import staggered_points
from sim_core.mesh.model import PanelMesh
from sim_core.mesh.outline import check_edge, clean_contours, sharpest_corner
from sim_core.mesh.quality import quality as face_quality
from sim_core.mesh.raycast import keep_points
from sim_core.mesh.report import measured
from sim_core.mesh.sampling import sampled_contours
from sim_core.mesh.smoothing import smoothed
from sim_core.mesh.verify import fills, verify

__all__ = ["panel_mesh"]

UPRIGHT = np.array([1.0, -1.0])  # y down -> y up; exact
ENOUGH_DEGREES = 30.0
OTHER_THRESHOLDS = (0.76, 0.64, 0.82)
QUALITIES = ("fair", "light", "best")
PASSES = 3  # of light smoothing


def panel_mesh(
    outline,
    *,
    edge: float,
    holes=(),
    threshold: float = 0.7,
    quality: str = "light",
    sampled: bool = False,
) -> PanelMesh:
    """Triangulate one pattern panel.

    outline: (N, 2) [m], y down, in either direction, closed without repeating the first point.  edge: [m] length L of
    a lattice step; outline steps are at most that.  holes: contours inside the outline.  threshold: lattice points
    nearer to the outline than threshold * edge are redundant; 0.5 to 0.9.  quality: "fair", the paper's method and
    nothing else; "light", with up to three smoothing passes, kept where the smallest angle grows, and other thresholds
    where it stays below 30 degrees (or the outline's own sharpest corner); "best", with a row of points along the
    outline and smoothing until the angles are open (`best.py`; the threshold plays no part).  sampled: the contours
    are sampled already, so that every point becomes a boundary vertex, in its order where the cloth lies to the left in (x, -y).
    Raises OutlineError saying what is wrong with the outline, where, and what to do.
    """
    begin = perf_counter()
    if quality not in QUALITIES:
        raise OutlineError(f"quality {quality!r} – give one of {', '.join(QUALITIES)}")
    if not 0.5 <= threshold <= 0.9:
        raise OutlineError(f"threshold {threshold} – give a fraction of the edge between 0.5 and 0.9")
    contours = clean_contours(outline, holes)
    check_edge(edge, contours)
    samples = contours if sampled else sampled_contours(contours, edge)
    boundary = _loops(samples)
    vertices, faces = _filled(samples, boundary, edge, threshold, quality)
    verify(vertices, faces, boundary, edge)
    report = measured(vertices, faces, boundary, contours, perf_counter() - begin)
    return PanelMesh(vertices, faces, boundary, report)


def _filled(samples, boundary, edge: float, threshold: float, quality: str) -> tuple[np.ndarray, np.ndarray]:
    if quality == "best":
        best = best_fill(samples, _steps(boundary), edge)
        return best.vertices, _closed(best, best.vertices)
    return _light_fill(samples, boundary, edge, threshold, PASSES if quality == "light" else 0)


def _light_fill(
    samples, boundary, edge: float, threshold: float, smooth: int
) -> tuple[np.ndarray, np.ndarray]:
    """Fill the contours for one threshold after the other until the smallest angle is good enough; the best counts."""
    lattice = staggered_points(samples[0].min(axis=0), samples[0].max(axis=0), edge)
    enough = min(ENOUGH_DEGREES, sharpest_corner(samples))
    others = [t for t in OTHER_THRESHOLDS if smooth and abs(t - threshold) > 0.02]
    tried = []
    for fraction in (threshold, *others):
        inner = keep_points(lattice, samples, edge=edge, threshold=fraction)
        vertices = np.concatenate([*samples, inner])
        tried.append(_improved(vertices, _fill(vertices, boundary), boundary, smooth))
        if tried[-1][0] >= enough:
            break
    _, vertices, faces = max(tried, key=lambda found: found[0])
    return vertices, faces


def _loops(samples: list[np.ndarray]) -> tuple[np.ndarray, ...]:
    ends = np.cumsum([len(loop) for loop in samples])
    return tuple(
        np.arange(end - len(loop), end, dtype=np.int32) for loop, end in zip(samples, ends, strict=True)
    )


def _fill(vertices: np.ndarray, boundary: tuple[np.ndarray, ...]) -> np.ndarray:
    """Grow inward from the oriented outline, so that nothing outside, in holes or across notches needs culling.

    Outline steps are Delaunay edges nearly always; where a spike or slit is so fine that one is not, it becomes a wall.
    """
    return _closed(grow_points(vertices * UPRIGHT, _steps(boundary)), vertices)


def _steps(boundary: tuple[np.ndarray, ...]) -> np.ndarray:
    return np.concatenate([np.column_stack([loop, np.roll(loop, -1)]) for loop in boundary])


def _closed(grown: Growth | BestFill, vertices: np.ndarray) -> np.ndarray:
    """The faces of a front that has closed; raises OutlineError where it has not."""
    if grown.status != CLOSED:
        x, y = vertices[grown.where]
        raise OutlineError(
            f"outline: the mesh does not close near ({x:.4f}, {y:.4f}) m – the outline has a feature finer than the "
            "edge there; give a smaller edge"
        )
    return grown.faces


def _improved(vertices, faces, boundary, passes: int) -> tuple[float, np.ndarray, np.ndarray]:
    """The best of the mesh and its smoothed forms, by the smallest angle: (angle, vertices, faces)."""
    fixed = sum(len(loop) for loop in boundary)
    best = _angle(vertices, faces, boundary), vertices, faces
    for _ in range(passes if fixed < len(vertices) else 0):
        vertices = smoothed(vertices, faces, fixed)
        try:
            faces = _fill(vertices, boundary)
        except OutlineError:
            break  # a point has come too close to the outline; what was found before stands
        angle = _angle(vertices, faces, boundary)
        if angle > best[0]:
            best = angle, vertices, faces
        if angle < 0:
            break
    return best


def _angle(vertices, faces, boundary) -> float:
    """Smallest angle [degrees], or -1 where the faces do not fill the contours."""
    return float(face_quality(vertices, faces).min_angle.min()) if fills(vertices, faces, boundary) else -1.0
