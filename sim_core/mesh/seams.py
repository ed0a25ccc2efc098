"""Seams: the two sides get the same number of steps and their vertices pair one to one; ease and notches are told.

A side is a stretch of a panel's outline from one of its points to another. Both sides are sampled at the same
fractions of their length: N = max(1, round(longer / edge)) steps in all, corners and notches of either side kept.
"""

from dataclasses import dataclass, replace

import numpy as np

from sim_core.errors import OutlineError
from sim_core.mesh.model import PanelMesh
from sim_core.mesh.outline import CORNER_DEGREES, clean_contour, outline_samples, outline_turning, signed_area
from sim_core.mesh.panel import panel_mesh
from sim_core.mesh.report import deviation

__all__ = ["Seam", "SeamFit", "SeamSide", "sewn_meshes"]

SAME = 1e-9  # of the length: fractions nearer than this are one


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
    mismatch: [m] |length a - length b| / N, what each step must be eased or stretched by.
    """

    pairs: np.ndarray
    notches: np.ndarray
    lengths: tuple[float, float]
    ease: float
    mismatch: float


def sewn_meshes(
    outlines, seams: list[Seam], *, edge: float, quality: str = "light"
) -> tuple[list[PanelMesh], list[SeamFit]]:
    """Mesh panels whose seams match vertex for vertex.

    outlines: (N, 2) [m] each, y down.  seams: see `Seam`; the sides of one outline do not overlap.  edge: [m].
    Returns one mesh a panel, its `outline_deviation` from the outline given, and one fit a seam.
    Raises OutlineError naming the panel or seam that cannot be.
    """
    contours = [clean_contour(outline, f"panel {k}") for k, outline in enumerate(outlines)]
    for k, (outline, contour) in enumerate(zip(outlines, contours, strict=True)):
        if len(contour) != len(outline):
            raise OutlineError(
                f"panel {k}: holds a point twice – give each once, so that seams can name them"
            )
    chains = [[_chain(seam, side, contours, k) for side in (seam.a, seam.b)] for k, seam in enumerate(seams)]
    fractions = [
        _fractions(pair, seam, edge, k) for k, (pair, seam) in enumerate(zip(chains, seams, strict=True))
    ]
    meshes, places = [], []
    for k, contour in enumerate(contours):
        pieces = {}
        for seam, pair, at in zip(seams, chains, fractions, strict=True):
            for side, chain in zip((seam.a, seam.b), pair, strict=True):
                if side.panel == k:
                    _put(pieces, side, _along(chain, at), k)
        samples = _sampled(contour, pieces, edge)
        turned = signed_area(samples) < 0
        try:
            mesh = panel_mesh(samples, edge=edge, sampled=True, quality=quality)
        except OutlineError as error:
            raise OutlineError(f"panel {k}: {error}") from error
        loop = mesh.vertices[mesh.boundary[0]]
        if not np.array_equal(loop, samples[::-1] if turned else samples):
            raise OutlineError(f"panel {k}: samples fall together – give a larger seam or a smaller edge")
        given = contour if (signed_area(contour) < 0) == turned else contour[::-1]
        report = replace(mesh.report, outline_deviation=deviation(given, loop))
        meshes.append(replace(mesh, report=report))
        places.append(
            {tuple(point): int(v) for v, point in zip(mesh.boundary[0], loop.tolist(), strict=True)}
        )
    fits = []
    for seam, pair, at in zip(seams, chains, fractions, strict=True):
        vertices = [
            [places[side.panel][tuple(point)] for point in _along(chain, at).tolist()]
            for side, chain in zip((seam.a, seam.b), pair, strict=True)
        ]
        fits.append(_fit(np.array(vertices, dtype=np.int32).T, seam, pair, at))
    return meshes, fits


def _chain(seam: Seam, side: SeamSide, contours: list[np.ndarray], number: int) -> np.ndarray:
    """The points of a side (n, 2), first to last."""
    if not 0 <= side.panel < len(contours):
        raise OutlineError(f"seam {number}: panel {side.panel} – there are {len(contours)}")
    contour = contours[side.panel]
    count = len(contour)
    for point in (side.first, side.last):
        if not 0 <= point < count:
            raise OutlineError(f"seam {number}: point {point} – panel {side.panel} has {count} points")
    steps = ((side.first - side.last if side.backward else side.last - side.first) - 1) % count + 1
    way = -1 if side.backward else 1
    return contour[(side.first + way * np.arange(steps + 1)) % count]


def _arc(chain: np.ndarray) -> np.ndarray:
    return np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(chain, axis=0).T))])


def _fractions(pair: list[np.ndarray], seam: Seam, edge: float, number: int) -> np.ndarray:
    """Where both sides have their vertices, as fractions of their length, 0 and 1 included."""
    if not all(0 < notch < 1 for notch in seam.notches):
        raise OutlineError(f"seam {number}: notches {seam.notches} – give fractions above 0 and below 1")
    marks = [0.0, 1.0, *seam.notches]
    for chain in pair:
        arc = _arc(chain)
        corner = outline_turning(chain) > CORNER_DEGREES
        corner[[0, -1]] = False
        marks.extend((arc[corner] / arc[-1]).tolist())
    marks = sorted(marks)
    marks = [m for k, m in enumerate(marks) if k == 0 or m - marks[k - 1] > SAME]
    longest = max(_arc(chain)[-1] for chain in pair)
    found = [
        np.linspace(a, b, max(1, round((b - a) * longest / edge)) + 1)[:-1]
        for a, b in zip(marks[:-1], marks[1:], strict=True)
    ]
    return np.append(np.concatenate(found), 1.0)


def _along(chain: np.ndarray, at: np.ndarray) -> np.ndarray:
    arc = _arc(chain)
    where = at * arc[-1]
    near = np.abs(arc[:, None] - where).argmin(axis=0)
    where = np.where(
        np.abs(arc[near] - where) <= SAME * arc[-1], arc[near], where
    )  # corners stay what they are
    return np.column_stack([np.interp(where, arc, chain[:, axis]) for axis in range(2)])


def _put(pieces: dict, side: SeamSide, points: np.ndarray, panel: int) -> None:
    """Note a side's samples under its first point in the outline's own direction."""
    first, last = (side.last, side.first) if side.backward else (side.first, side.last)
    if first in pieces and not np.array_equal(pieces[first][1], points):
        raise OutlineError(f"panel {panel}: two seams begin at point {first} – seams must not overlap")
    pieces[first] = (last, points[::-1] if side.backward else points)


def _sampled(contour: np.ndarray, pieces: dict, edge: float) -> np.ndarray:
    """The whole outline sampled: seam sides as they are given, the rest at equal steps."""
    if not pieces:
        return outline_samples(contour, edge)
    count, found = len(contour), []
    begin = here = min(pieces)
    while True:
        if here in pieces:
            last, points = pieces[here]
            passed = {(here + k) % count for k in range(1, ((last - here - 1) % count) + 1)}
            if (passed - {last}) & set(pieces) or begin in passed - {last}:
                raise OutlineError(f"outline: seams overlap behind point {here} – seams must not overlap")
            found.append(points[:-1])
            here = last
        else:
            ends = [
                k for k in range(1, count + 1) if (here + k) % count in pieces or (here + k) % count == begin
            ]
            chain = contour[(here + np.arange(ends[0] + 1)) % count]
            found.append(_free(chain, edge))
            here = (here + ends[0]) % count
        if here == begin:
            return np.concatenate(found)


def _free(chain: np.ndarray, edge: float) -> np.ndarray:
    """Equal steps between the corners of an open stretch, its last point left out."""
    arc = _arc(chain)
    corner = outline_turning(chain) > CORNER_DEGREES
    corner[[0, -1]] = True
    marks = arc[corner]
    at = [
        np.linspace(a, b, max(1, int(np.ceil((b - a) / edge - 1e-9))) + 1)[:-1]
        for a, b in zip(marks[:-1], marks[1:], strict=True)
    ]
    where = np.concatenate(at)
    return np.column_stack([np.interp(where, arc, chain[:, axis]) for axis in range(2)])


def _fit(pairs: np.ndarray, seam: Seam, pair: list[np.ndarray], at: np.ndarray) -> SeamFit:
    a, b = (float(_arc(chain)[-1]) for chain in pair)
    notches = np.array([int(np.abs(at - notch).argmin()) for notch in seam.notches], dtype=np.int32)
    return SeamFit(pairs, notches, (a, b), abs(a - b) / min(a, b), abs(a - b) / (len(at) - 1))
