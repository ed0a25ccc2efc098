"""Seams: the two sides get the same number of steps and their vertices pair one to one; ease and notches are told.

A side is a stretch of a panel's outline from one of its points to another. Both sides are sampled at the same
fractions of their length: corners and notches of either side are kept, and max(1, round(longer / edge)) steps made
between each two.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from time import perf_counter
from typing import TypeVar

import numpy as np

from sim_core.errors import OutlineError
from sim_core.mesh.measures.report import deviation
from sim_core.mesh.outline.contours import (
    check_edge,
    clean_contour,
    clean_contours,
    cleaned_contours,
    signed_area,
)
from sim_core.mesh.outline.inner_lines import clean_lines
from sim_core.mesh.outline.samples import sampled_rim
from sim_core.mesh.outline.size_field import SizeField
from sim_core.mesh.panel import PanelMesh, check_options, filled_mesh, timed
from sim_core.mesh.seam_marks import Steps, arc_lengths, at_lengths, seam_steps
from sim_core.metrics.compile_time import compile_clock

__all__ = ["Seam", "SeamFit", "SeamSide", "sewn_meshes"]

Made = TypeVar("Made")


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
    """Two sides sewn from their first points to their last. notches: fractions of the length, above 0 and below 1."""

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
    of each given point.  holes, lines: checked, [m].  kept: ends of inner lines, as tuples.  given: contours [m] the
    deviation is told from, `merged` where holes were.
    """

    outline: np.ndarray
    number: np.ndarray
    holes: list[np.ndarray]
    lines: tuple[np.ndarray, ...]
    kept: set[tuple[float, float]]
    given: list[np.ndarray]
    merged: bool


def sewn_meshes(
    outlines,
    seams: list[Seam],
    *,
    edge: float,
    holes=(),
    constraints=(),
    sizes: Sequence[SizeField | None] = (),
    threshold: float = 0.7,
    quality: str = "light",
) -> tuple[list[PanelMesh], list[SeamFit]]:
    """Mesh panels whose seams match vertex for vertex.

    outlines: (N, 2) [m] each, y down.  seams: see `Seam`; the sides of one outline do not overlap.  edge: [m].
    holes, constraints, sizes: one entry a panel (a list of contours, a list of lines, a field or None), or none at all;
    these, threshold and quality as in `panel_mesh`. An inner line that ends on a seam has a vertex there on both
    sides; both follow the shorter of their size fields. Holes may touch each other, not the outline.
    Returns one mesh a panel, its `outline_deviation` from the contours given, and one fit a seam.
    Raises OutlineError naming the panel or seam that cannot be.
    """
    check_options(threshold, quality)
    count = len(outlines)
    every = [
        _one_each(name, given, count, none)
        for name, given, none in (
            ("holes", holes, ()),
            ("constraints", constraints, ()),
            ("sizes", sizes, None),
        )
    ]
    panels = [
        _of_panel(k, partial(_prepared, outline, inner, lines, field, edge))
        for k, (outline, inner, lines, field) in enumerate(zip(outlines, *every, strict=True))
    ]
    chains = [[_chain(side, panels, k) for side in (seam.a, seam.b)] for k, seam in enumerate(seams)]
    fields = every[2]
    steps = [
        _steps(number, seam, pair, panels, fields, edge)
        for number, (seam, pair) in enumerate(zip(seams, chains, strict=True))
    ]
    points = [
        [at_lengths(chain, arc_lengths(chain), at) for chain, at in zip(pair, step.at, strict=True)]
        for pair, step in zip(chains, steps, strict=True)
    ]
    meshes, places = [], []
    for k, panel in enumerate(panels):
        pieces: dict = {}
        for seam, pair in zip(seams, points, strict=True):
            for side, samples in zip((seam.a, seam.b), pair, strict=True):
                if side.panel == k:
                    _of_panel(k, partial(_put, pieces, side, panel, samples))
        work = partial(_meshed, panel, pieces, edge, fields[k], threshold, quality)
        meshes.append(_of_panel(k, work))
        loop = meshes[-1].boundary[0]
        places.append(
            {tuple(point): int(v) for v, point in zip(loop, meshes[-1].vertices[loop].tolist(), strict=True)}
        )
    fits = []
    for seam, pair, samples, step in zip(seams, chains, points, steps, strict=True):
        vertices = [
            [places[side.panel][tuple(point)] for point in sampled.tolist()]
            for side, sampled in zip((seam.a, seam.b), samples, strict=True)
        ]
        a, b = (float(arc_lengths(chain)[-1]) for chain in pair)
        pairs = np.array(vertices, dtype=np.int32).T
        mismatch = abs(a - b) / (len(pairs) - 1)
        fits.append(SeamFit(pairs, step.notches, (a, b), abs(a - b) / min(a, b), mismatch, step.joined))
    return meshes, fits


def _one_each(name: str, given, count: int, none) -> list:
    if len(given) not in (0, count):
        raise OutlineError(f"{name}: {len(given)} entries for {count} panels – give one a panel")
    return list(given) if len(given) else [none] * count


def _of_panel(k: int, work: Callable[[], Made]) -> Made:
    """What `work` returns; its OutlineError names the panel."""
    try:
        return work()
    except OutlineError as error:
        raise OutlineError(f"panel {k}: {error}") from error


def _prepared(outline, holes, constraints, sizes: SizeField | None, edge: float) -> _Panel:
    """Check a panel and put the ends of its inner lines into its contours."""
    contour = clean_contour(outline, "outline")
    if len(contour) != len(outline):
        raise OutlineError("outline: holds a point twice – give each once, so that seams can name them")
    contours, given = cleaned_contours(outline, holes, edge=edge)
    turned = signed_area(contour) < 0
    if given is not None:
        if {tuple(point) for point in contours[0].tolist()} != {tuple(point) for point in contour.tolist()}:
            raise OutlineError(
                "a hole touches the outline – draw it as part of that, so that seams can name its points"
            )
        contours[0] = contour[::-1] if turned else contour
    check_edge(edge, contours)
    if sizes is not None:
        sizes.check(edge)
    lines, joined, kept = (
        clean_lines(constraints, contours) if len(constraints) else ((), contours, np.zeros((0, 2)))
    )
    whole = joined[0][::-1] if turned else joined[0]
    place = {tuple(point): k for k, point in enumerate(whole.tolist())}
    number = np.array([place[tuple(point)] for point in contour.tolist()])
    ends = {(float(x), float(y)) for x, y in kept}
    return _Panel(whole, number, joined[1:], lines, ends, given or contours, given is not None)


def _steps(number: int, seam: Seam, pair, panels: list[_Panel], fields, edge: float) -> Steps:
    if not all(0 < notch < 1 for notch in seam.notches):
        raise OutlineError(f"seam {number}: notches {seam.notches} – give fractions above 0 and below 1")
    a, b = seam.a.panel, seam.b.panel
    kept = panels[a].kept, panels[b].kept
    return seam_steps((pair[0], pair[1]), kept, seam.notches, edge, (fields[a], fields[b]))


def _meshed(panel: _Panel, pieces: dict, edge: float, sizes, threshold: float, quality: str) -> PanelMesh:
    """The mesh of a panel whose seams are sampled: pieces as `_put` notes them."""
    begin = perf_counter()
    with compile_clock() as clock:
        contour, fixed = _sampled(panel.outline, pieces)
        if len(clean_contours(contour, panel.holes)[0]) != len(contour):
            raise OutlineError("samples fall together – give a larger seam or a smaller edge")
        if signed_area(contour) < 0:  # steps are named by the point they begin at, which is the other one now
            contour, fixed = contour[::-1], np.roll(fixed[::-1], -1)
        kept = np.array(sorted(panel.kept)).reshape(-1, 2)
        contours = [contour, *panel.holes]
        rim = sampled_rim(contours, edge, lines=panel.lines, kept=kept, sizes=sizes, fixed=fixed)
        mesh = filled_mesh(rim, edge=edge, threshold=threshold, quality=quality, sizes=sizes)
        strays = deviation(panel.given, rim.contours, merged=panel.merged)
    return timed(mesh, strays, begin, clock)


def _chain(side: SeamSide, panels: list[_Panel], number: int) -> np.ndarray:
    """The points of a side (n, 2), first to last."""
    if not 0 <= side.panel < len(panels):
        raise OutlineError(f"seam {number}: panel {side.panel} – there are {len(panels)}")
    panel = panels[side.panel]
    for point in (side.first, side.last):
        if not 0 <= point < len(panel.number):
            raise OutlineError(
                f"seam {number}: point {point} – panel {side.panel} has {len(panel.number)} points"
            )
    count = len(panel.outline)
    first, last = panel.number[side.first], panel.number[side.last]
    steps = ((first - last if side.backward else last - first) - 1) % count + 1
    way = -1 if side.backward else 1
    return panel.outline[(first + way * np.arange(steps + 1)) % count]


def _put(pieces: dict, side: SeamSide, panel: _Panel, points: np.ndarray) -> None:
    """Note a side's samples under its first point in the outline's own direction."""
    first, last = (side.last, side.first) if side.backward else (side.first, side.last)
    begin = int(panel.number[first])
    if begin in pieces and not np.array_equal(pieces[begin][1], points):
        raise OutlineError(f"two seams begin at point {first} – seams must not overlap")
    pieces[begin] = (int(panel.number[last]), points[::-1] if side.backward else points)


def _sampled(contour: np.ndarray, pieces: dict) -> tuple[np.ndarray, np.ndarray]:
    """The outline with its seams sampled, and which of its steps those are, by the point they begin at."""
    if not pieces:
        return contour, np.zeros(len(contour), dtype=bool)
    count, found, fixed = len(contour), [], []
    begin = here = min(pieces)
    while True:
        if here in pieces:
            last, points = pieces[here]
            passed = {(here + k) % count for k in range(1, ((last - here - 1) % count) + 1)}
            if (passed - {last}) & set(pieces) or begin in passed - {last}:
                x, y = contour[here]
                raise OutlineError(f"seams overlap behind ({x:.4f}, {y:.4f}) m – seams must not overlap")
            found.append(points[:-1])
            fixed.append(np.ones(len(points) - 1, dtype=bool))
            here = last
        else:
            found.append(contour[here : here + 1])
            fixed.append(np.zeros(1, dtype=bool))
            here = (here + 1) % count
        if here == begin:
            return np.concatenate(found), np.concatenate(fixed)
