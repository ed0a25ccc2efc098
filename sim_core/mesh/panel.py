"""Outline to panel mesh: samples, staggered points, redundant points out, growth, check."""

from dataclasses import dataclass, replace
from time import perf_counter

import numpy as np

from sim_core.errors import OutlineError
from sim_core.mesh.improvement.best import BestFill, best_fill
from sim_core.mesh.improvement.smoothing import smoothed
from sim_core.mesh.measures.report import MeshReport, deviation, measured
from sim_core.mesh.measures.triangles import quality as face_quality
from sim_core.mesh.measures.verification import fills, verify
from sim_core.mesh.outline.contours import check_edge, cleaned_contours, sharpest_corner
from sim_core.mesh.outline.inner_lines import clean_lines
from sim_core.mesh.outline.samples import Rim, sampled_rim
from sim_core.mesh.outline.size_field import SizeField
from sim_core.mesh.points.graded import graded_points
from sim_core.mesh.points.lattice import staggered_points
from sim_core.mesh.points.raycast import keep_points
from sim_core.mesh.triangulation.growth import CLOSED, Growth, grow_points
from sim_core.metrics.compile_time import CompileClock, compile_clock

__all__ = ["QUALITIES", "PanelMesh", "check_options", "filled_mesh", "panel_mesh", "timed"]

UPRIGHT = np.array([1.0, -1.0])  # y down -> y up; exact
ENOUGH_DEGREES = 30.0
OTHER_THRESHOLDS = (0.76, 0.64, 0.82)
QUALITIES = ("fair", "light", "best")
PASSES = 3  # of light smoothing


@dataclass(frozen=True, eq=False)
class PanelMesh:
    """A triangulated panel in pattern coordinates (metres, y down).

    vertices: (V, 2) float64 [m].  faces: (F, 3) int32, positive area in (x, -y).
    boundary: one array of vertex indices per contour, the outer one first; outer counter-clockwise and holes
    clockwise in (x, -y), so that the cloth lies to the left.
    lines: one array of vertex indices per inner line, open; their steps are edges of the mesh.
    """

    vertices: np.ndarray
    faces: np.ndarray
    boundary: tuple[np.ndarray, ...]
    report: MeshReport
    lines: tuple[np.ndarray, ...] = ()


def panel_mesh(
    outline,
    *,
    edge: float,
    holes=(),
    constraints=(),
    sizes: SizeField | None = None,
    threshold: float = 0.7,
    quality: str = "light",
    sampled: bool = False,
) -> PanelMesh:
    """Triangulate one pattern panel.

    outline: (N, 2) [m], y down, in either direction, first point repeated or not.  edge: [m] length L of a lattice
    step; outline steps are at most that.  holes: contours inside the outline; one that touches it is merged with it,
    with a warning.  constraints: open lines (N, 2) [m] inside the cloth that edges must follow.  sizes: shorter edges
    by place.  threshold: lattice points nearer to the outline than threshold * edge are redundant; 0.5 to 0.9.
    quality: "fair", the paper's method and nothing else; "light", with up to three smoothing passes, kept where the
    smallest angle grows, and other thresholds where it stays below 30 degrees (or the outline's own sharpest corner);
    "best", with a row of points along the outline, smoothing, insertion and deletion (`best.py`; the threshold plays
    no part).  sampled: the contours are sampled already, so that every point becomes a boundary vertex, in its order
    where the cloth lies to the left in (x, -y).
    Raises OutlineError saying what is wrong with the outline, where, and what to do.
    """
    begin = perf_counter()
    with compile_clock() as clock:
        check_options(threshold, quality)
        contours, given = cleaned_contours(outline, holes, edge=edge)
        check_edge(edge, contours)
        if sizes is not None:
            sizes.check(edge)
        rim = _rim(contours, constraints, edge, sizes, sampled)
        mesh = filled_mesh(rim, edge=edge, threshold=threshold, quality=quality, sizes=sizes)
        strays = deviation(given or contours, rim.contours, merged=given is not None)
    return timed(mesh, strays, begin, clock)


def timed(mesh: PanelMesh, strays: float, begin: float, clock: CompileClock) -> PanelMesh:
    """The mesh with what `filled_mesh` cannot know: deviation [m], and time since `begin` without compiling."""
    seconds = perf_counter() - begin - clock.seconds
    told = replace(mesh.report, outline_deviation=strays, seconds=seconds, compile_seconds=clock.seconds)
    return replace(mesh, report=told)


def check_options(threshold: float, quality: str) -> None:
    """Raise OutlineError for a threshold or quality that `panel_mesh` does not know."""
    if quality not in QUALITIES:
        raise OutlineError(f"quality {quality!r} – give one of {', '.join(QUALITIES)}")
    if not 0.5 <= threshold <= 0.9:
        raise OutlineError(f"threshold {threshold} – give a fraction of the edge between 0.5 and 0.9")


def filled_mesh(
    rim: Rim, *, edge: float, threshold: float, quality: str, sizes: SizeField | None
) -> PanelMesh:
    """The checked mesh of a sampled rim; options as in `panel_mesh`. Its report's `outline_deviation` and `seconds`
    are 0: the rim does not know them. Raises OutlineError."""
    vertices, faces, rim = _filled(rim, edge, threshold, quality, sizes)
    free = verify(vertices, faces, rim.loops, edge, rim.lines)
    return PanelMesh(vertices, faces, rim.loops, measured(vertices, faces, rim.loops, free), rim.lines)


def _rim(contours, constraints, edge: float, sizes: SizeField | None, sampled: bool) -> Rim:
    if len(constraints):
        if sampled:
            raise OutlineError("constraints: not on contours that are sampled already – leave `sampled` out")
        lines, contours, kept = clean_lines(constraints, contours)
        return sampled_rim(contours, edge, lines=lines, kept=kept, sizes=sizes)
    if not sampled:
        return sampled_rim(contours, edge, sizes=sizes)
    ends = np.cumsum([len(loop) for loop in contours])
    loops = tuple(
        np.arange(end - len(loop), end, dtype=np.int32) for loop, end in zip(contours, ends, strict=True)
    )
    return Rim(np.concatenate(contours), loops, whole=np.ones(int(ends[-1]), dtype=bool))


def _filled(
    rim: Rim, edge: float, threshold: float, quality: str, sizes
) -> tuple[np.ndarray, np.ndarray, Rim]:
    """Vertices, faces, and the rim, whose steps `best` may have divided."""
    if quality == "best" or (sizes is not None and quality == "light"):
        best = best_fill(rim, edge, sizes, refine=quality == "best")
        return best.vertices, _closed(best, best.vertices), best.rim
    if sizes is not None:
        vertices = np.concatenate([rim.points, graded_points(rim, edge, sizes)])
        return vertices, _fill(vertices, rim), rim
    return *_light_fill(rim, edge, threshold, PASSES if quality == "light" else 0), rim


def _light_fill(rim: Rim, edge: float, threshold: float, smooth: int) -> tuple[np.ndarray, np.ndarray]:
    """Fill the contours for one threshold after the other until the smallest angle is good enough; the best counts."""
    contours = rim.contours
    lattice = staggered_points(contours[0].min(axis=0), contours[0].max(axis=0), edge)
    enough = min(ENOUGH_DEGREES, sharpest_corner(contours))
    others = [t for t in OTHER_THRESHOLDS if smooth and abs(t - threshold) > 0.02]
    tried = []
    for fraction in (threshold, *others):
        inner = keep_points(lattice, contours, edge=edge, threshold=fraction, segments=rim.segments)
        vertices = np.concatenate([rim.points, inner])
        faces = _fill(vertices, rim)
        if not smooth:
            return vertices, faces
        tried.append(_improved(vertices, faces, rim, smooth))
        if tried[-1][0] >= enough:
            break
    _, vertices, faces = max(tried, key=lambda found: found[0])
    return vertices, faces


def _fill(vertices: np.ndarray, rim: Rim) -> np.ndarray:
    """Grow inward from the oriented outline, so that nothing outside, in holes or across notches needs culling.

    Outline steps are Delaunay edges nearly always; where a spike or slit is so fine that one is not, it becomes a wall.
    """
    return _closed(grow_points(vertices * UPRIGHT, rim.steps), vertices)


def _closed(grown: Growth | BestFill, vertices: np.ndarray) -> np.ndarray:
    """The faces of a front that has closed; raises OutlineError where it has not."""
    if grown.status != CLOSED:
        x, y = vertices[grown.where]
        raise OutlineError(
            f"outline: the mesh does not close near ({x:.4f}, {y:.4f}) m – the outline has a feature finer than the "
            "edge there; give a smaller edge"
        )
    return grown.faces


def _improved(vertices, faces, rim: Rim, passes: int) -> tuple[float, np.ndarray, np.ndarray]:
    """The best of the mesh and its smoothed forms, by the smallest angle: (angle, vertices, faces)."""
    fixed = len(rim.points)
    best = _angle(vertices, faces, rim), vertices, faces
    for _ in range(passes if fixed < len(vertices) else 0):
        vertices = smoothed(vertices, faces, fixed)
        try:
            faces = _fill(vertices, rim)
        except OutlineError:
            break  # a point has come too close to the outline; what was found before stands
        angle = _angle(vertices, faces, rim)
        if angle > best[0]:
            best = angle, vertices, faces
        if angle < 0:
            break
    return best


def _angle(vertices, faces, rim: Rim) -> float:
    """Smallest angle [degrees], or -1 where the faces do not fill the contours."""
    if not fills(vertices, faces, rim.loops):
        return -1.0
    return float(face_quality(vertices, faces).min_angle.min())
