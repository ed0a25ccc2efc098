"""Seams: the two sides get the same number of steps and their vertices pair one to one; ease and notches are told.

A side is a stretch of a panel's outline from one of its points to another. Corners that its panel names part it into
legs, and the legs of both sides meet one by one. They are sampled at the same fractions of their lengths: sharp turns,
notches and ends of inner lines are kept, and as many equal steps made between them that none is longer than the edge.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from time import perf_counter
from typing import TypeVar

import numpy as np

from sim_core.errors import OutlineError
from sim_core.mesh.measures.report import deviation
from sim_core.mesh.outline.contours import (
    CORNER_DEGREES,
    check_edge,
    clean_contour,
    clean_contours,
    cleaned_contours,
    outline_turning,
    signed_area,
)
from sim_core.mesh.outline.inner_lines import clean_lines
from sim_core.mesh.outline.samples import even_places, sampled_rim
from sim_core.mesh.outline.size_field import SizeField
from sim_core.mesh.panel import PanelMesh, check_options, filled_mesh, timed
from sim_core.mesh.seam_marks import Leg, Steps, arc_lengths, at_lengths, seam_steps
from sim_core.metrics.compile_time import compile_clock

__all__ = ["Seam", "SeamFit", "SeamSide", "SewnPanel", "sewn_meshes"]

Made = TypeVar("Made")
CLOSE = 1e-3  # of the edge: given points nearer to a sample are left out


@dataclass(frozen=True, eq=False)
class SewnPanel:
    """A panel of several that are sewn.

    outline: (N, 2) [m], y down.  corners: outline points (indices) at which legs end, whatever their angle; they stay,
    and those of the two sides of a seam meet.  holes, constraints, sizes: as in `panel_mesh`; holes may touch each
    other, not the outline.  name: what errors call it, else its number.
    """

    outline: np.ndarray
    corners: Sequence[int] = ()
    holes: Sequence = ()
    constraints: Sequence = ()
    sizes: SizeField | None = None
    name: str = ""


@dataclass(frozen=True)
class SeamSide:
    """From outline point `first` to outline point `last` of panel `panel` (indices), in the outline's direction as it
    is given, or against it with `backward`. first = last goes all the way round."""

    panel: int
    first: int
    last: int
    backward: bool = False


@dataclass(frozen=True)
class Seam:
    """Two sides sewn from their first points to their last, with as many legs each, or one on one of them.

    notches: fractions of the first side's length, above 0 and below 1.
    """

    a: SeamSide
    b: SeamSide
    notches: tuple[float, ...] = ()


@dataclass(frozen=True, eq=False)
class SeamFit:
    """How a seam came out.

    pairs: (N + 1, 2) int32, vertex of panel a and vertex of panel b.  notches: places of the notches in pairs.
    lengths: [m] of both sides along the given outlines.  ease: |length a - length b| / the shorter.
    mismatch: [m] |length a - length b| / N, what each step must be eased or stretched by.  joined: [m] greatest
    distance between marks (corners, notches, ends of inner lines) that became one vertex because they lay nearer than
    0.2 edge, 0 where none did.
    """

    pairs: np.ndarray
    notches: np.ndarray
    lengths: tuple[float, float]
    ease: float
    mismatch: float
    joined: float = 0.0


@dataclass(frozen=True, eq=False)
class _Panel:
    """A panel before its seams are sampled.

    outline: (n, 2) [m] in the direction given, with the points where inner lines end.  number: (N,) the place in it
    of each given point.  corners: places of its corners, in their order.  holes, lines: checked, [m].  kept: ends of
    inner lines, as tuples.  given: contours [m] the deviation is told from, `merged` where holes were.
    """

    outline: np.ndarray
    number: np.ndarray
    corners: list[int]
    holes: list[np.ndarray]
    lines: tuple[np.ndarray, ...]
    kept: set[tuple[float, float]]
    sizes: SizeField | None
    given: list[np.ndarray]
    merged: bool


Sides = tuple[list[Leg], list[Leg]]
Pieces = dict[int, tuple[int, np.ndarray]]  # sampled legs by the place they begin at: where they end, points


def sewn_meshes(
    panels: Sequence[SewnPanel],
    seams: Sequence[Seam],
    *,
    edge: float,
    threshold: float = 0.7,
    quality: str = "light",
) -> tuple[list[PanelMesh], list[SeamFit]]:
    """Mesh panels whose seams match vertex for vertex.

    panels: see `SewnPanel`.  seams: see `Seam`; the sides of one outline do not overlap.  edge: [m].  threshold,
    quality: as in `panel_mesh`. An inner line that ends on a seam has a vertex there on both sides; both follow the
    shorter of their size fields.
    Returns one mesh a panel, its `outline_deviation` from the contours given, and one fit a seam.
    Raises OutlineError naming the panel or seam that cannot be.
    """
    check_options(threshold, quality)
    names = [panel.name or f"panel {k}" for k, panel in enumerate(panels)]
    ready = [
        _of_panel(name, partial(_prepared, panel, edge)) for name, panel in zip(names, panels, strict=True)
    ]
    sides: list[Sides] = [(_legs(seam.a, ready, k), _legs(seam.b, ready, k)) for k, seam in enumerate(seams)]
    steps = [_seam_steps(k, seam, sides[k], ready, edge) for k, seam in enumerate(seams)]
    points = [
        [
            [leg.sampled(at) for leg, at in zip(legs, along, strict=True)]
            for legs, along in zip(pair, step.at, strict=True)
        ]
        for pair, step in zip(sides, steps, strict=True)
    ]
    pieces: list[Pieces] = [{} for _ in panels]
    for seam, pair, samples in zip(seams, sides, points, strict=True):
        for side, legs, rows in zip((seam.a, seam.b), pair, samples, strict=True):
            own, panel = pieces[side.panel], ready[side.panel]
            for leg, row in zip(legs, rows, strict=True):
                _of_panel(names[side.panel], partial(_put, own, leg, panel, row))
    meshes = [
        _of_panel(name, partial(_meshed, panel, own, edge, threshold, quality))
        for name, panel, own in zip(names, ready, pieces, strict=True)
    ]
    places = [_places(mesh) for mesh in meshes]
    rows = [
        [
            [places[side.panel][point] for point in _in_a_row(legs)]
            for side, legs in zip((seam.a, seam.b), samples, strict=True)
        ]
        for seam, samples in zip(seams, points, strict=True)
    ]
    return meshes, [
        _fit(pair, step, np.array(row, dtype=np.int32).T)
        for pair, step, row in zip(sides, steps, rows, strict=True)
    ]


def _fit(sides: Sides, steps: Steps, pairs: np.ndarray) -> SeamFit:
    a, b = (sum(leg.length for leg in legs) for legs in sides)
    mismatch = abs(a - b) / (len(pairs) - 1)
    return SeamFit(pairs, steps.notches, (a, b), abs(a - b) / min(a, b), mismatch, steps.joined)


def _of_panel(name: str, work: Callable[[], Made]) -> Made:
    """What `work` returns; its OutlineError names the panel."""
    try:
        return work()
    except OutlineError as error:
        raise OutlineError(f"{name}: {error}") from error


def _places(mesh: PanelMesh) -> dict[tuple[float, ...], int]:
    """The vertex at each point of a mesh's outline."""
    loop = mesh.boundary[0]
    return {tuple(point): int(v) for v, point in zip(loop, mesh.vertices[loop].tolist(), strict=True)}


def _in_a_row(rows: list[np.ndarray]) -> list[tuple[float, ...]]:
    """The points of legs one after the other, where they meet once."""
    whole = np.concatenate([rows[0][:1], *(row[1:] for row in rows)])
    return [tuple(point) for point in whole.tolist()]


def _prepared(panel: SewnPanel, edge: float) -> _Panel:
    """Check a panel and put the ends of its inner lines into its contours."""
    contour = clean_contour(panel.outline, "outline")
    if len(contour) != len(panel.outline):
        raise OutlineError("outline: holds a point twice – give each once, so that seams can name them")
    for corner in panel.corners:
        if not 0 <= corner < len(contour):
            raise OutlineError(f"corner {corner} – the outline has {len(contour)} points")
    contours, given = cleaned_contours(panel.outline, panel.holes, edge=edge)
    turned = signed_area(contour) < 0
    if given is not None:
        if {tuple(point) for point in contours[0].tolist()} != {tuple(point) for point in contour.tolist()}:
            raise OutlineError(
                "a hole touches the outline – draw it as part of that, so that seams can name its points"
            )
        contours[0] = contour[::-1] if turned else contour
    check_edge(edge, contours)
    if panel.sizes is not None:
        panel.sizes.check(edge)
    lines, joined, kept = (
        clean_lines(panel.constraints, contours)
        if len(panel.constraints)
        else ((), contours, np.zeros((0, 2)))
    )
    whole = joined[0][::-1] if turned else joined[0]
    place = {tuple(point): k for k, point in enumerate(whole.tolist())}
    number = np.array([place[tuple(point)] for point in contour.tolist()])
    corners = number[np.asarray(panel.corners, dtype=int)].tolist()
    ends = {(float(x), float(y)) for x, y in kept}
    merged = given is not None
    return _Panel(whole, number, corners, joined[1:], lines, ends, panel.sizes, given or contours, merged)


def _seam_steps(number: int, seam: Seam, sides: Sides, panels: list[_Panel], edge: float) -> Steps:
    if not all(0 < notch < 1 for notch in seam.notches):
        raise OutlineError(f"seam {number}: notches {seam.notches} – give fractions above 0 and below 1")
    sizes = panels[seam.a.panel].sizes, panels[seam.b.panel].sizes
    try:
        return seam_steps(sides, seam.notches, edge, sizes)
    except OutlineError as error:
        raise OutlineError(f"seam {number}: {error}") from error


def _meshed(panel: _Panel, pieces: Pieces, edge: float, threshold: float, quality: str) -> PanelMesh:
    """The mesh of a panel whose seams are sampled."""
    begin = perf_counter()
    with compile_clock() as clock:
        contour, fixed, kept = _sampled(panel, pieces, edge)
        if len(clean_contours(contour, panel.holes)[0]) != len(contour):
            raise OutlineError("samples fall together – give a larger seam or a smaller edge")
        if signed_area(contour) < 0:  # steps are named by the point they begin at, which is the other one now
            contour, fixed = contour[::-1], np.roll(fixed[::-1], -1)
        contours = [contour, *panel.holes]
        sizes = panel.sizes
        rim = sampled_rim(contours, edge, lines=panel.lines, kept=kept, sizes=sizes, fixed=fixed)
        mesh = filled_mesh(rim, edge=edge, threshold=threshold, quality=quality, sizes=sizes)
        strays = deviation(panel.given, rim.contours, merged=panel.merged)
    return timed(mesh, strays, begin, clock)


def _legs(side: SeamSide, panels: list[_Panel], number: int) -> list[Leg]:
    """The legs of a side in the seam's direction."""
    if not 0 <= side.panel < len(panels):
        raise OutlineError(f"seam {number}: panel {side.panel} – there are {len(panels)}")
    panel = panels[side.panel]
    for point in (side.first, side.last):
        if not 0 <= point < len(panel.number):
            raise OutlineError(
                f"seam {number}: point {point} – panel {side.panel} has {len(panel.number)} points"
            )
    count = len(panel.outline)
    first, last = panel.number[[side.first, side.last]]
    begin, end = (last, first) if side.backward else (first, last)
    run = (begin + np.arange((end - begin - 1) % count + 2)) % count
    ends = [0, *(k for k in range(1, len(run) - 1) if run[k] in panel.corners), len(run) - 1]
    legs = [
        Leg.of(panel.outline, run[a : b + 1], panel.kept, backward=side.backward) for a, b in pairwise(ends)
    ]
    return legs[::-1] if side.backward else legs


def _put(pieces: Pieces, leg: Leg, panel: _Panel, points: np.ndarray) -> None:
    """Note a leg's samples (n, 2) [m], which run in the seam's direction, in the outline's own."""
    along = points[::-1] if leg.backward else points
    if leg.begin in pieces and not np.array_equal(pieces[leg.begin][1], along):
        first = int(np.flatnonzero(panel.number == leg.begin)[0])
        raise OutlineError(f"two seams begin at point {first} – seams must not overlap")
    pieces[leg.begin] = leg.end, along


def _sampled(panel: _Panel, pieces: Pieces, edge: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The outline with its legs sampled, which of its steps are a seam's, by the point they begin at, and points of it
    (k, 2) [m] that stay. What is not sewn keeps its given points beside its samples, so that finer steps follow it."""
    outline, count = panel.outline, len(panel.outline)
    marked = outline_turning(outline) > CORNER_DEGREES
    marked |= np.array([tuple(point) in panel.kept for point in outline.tolist()])
    marks = sorted({*np.flatnonzero(marked).tolist(), *panel.corners, *pieces}) or [0]
    found, fixed, kept = [], [], [outline[panel.corners], np.array(sorted(panel.kept)).reshape(-1, 2)]
    begin = here = panel.corners[0] if panel.corners else min(pieces, default=marks[0])
    while True:
        if here in pieces:
            last, points = pieces[here]
            passed = {(here + k) % count for k in range(1, ((last - here - 1) % count) + 1)}
            if (passed - {last}) & set(pieces) or begin in passed - {last}:
                x, y = outline[here]
                raise OutlineError(f"seams overlap behind ({x:.4f}, {y:.4f}) m – seams must not overlap")
        else:
            last = next((mark for mark in marks if mark > here), marks[0])
            points = outline[(here + np.arange((last - here - 1) % count + 2)) % count]
            if panel.sizes is None:
                points, samples = _evenly(points, edge, max(1, -(-3 // len(marks))))
                kept.append(samples)
        found.append(points[:-1])
        fixed.append(np.full(len(points) - 1, here in pieces))
        here = last
        if here == begin:
            return np.concatenate(found), np.concatenate(fixed), np.concatenate(kept)


def _evenly(chain: np.ndarray, edge: float, least: int) -> tuple[np.ndarray, np.ndarray]:
    """A chain (n, 2) [m] with samples at even steps, at least so many, among its points; and those samples alone."""
    arc = arc_lengths(chain)
    at = np.append(even_places(chain, arc, 0.0, float(arc[-1]), edge, None, least), arc[-1])
    after = np.clip(np.searchsorted(at, arc), 1, len(at) - 1)
    apart = np.minimum(np.abs(at[after] - arc), np.abs(arc - at[after - 1]))
    where = np.union1d(at, arc[apart > CLOSE * edge])
    points = at_lengths(chain, arc, where)
    return points, points[np.isin(where, at)]
