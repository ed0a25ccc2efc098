"""The condition of a scan: what is broken, open or loose in it, counted; and the scan without what is no surface."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from sim_core.mesh.scan.scan import Scan, ScanError
from sim_core.metrics import components

__all__ = ["Condition", "cleaned", "largest_part"]

NARROW = 0.1  # of the greatest extent: an open line that is narrower is a hole, else a hem or an opening


@dataclass(frozen=True)
class Condition:
    """What was found. Lengths and areas are in the file's units.

    triangles: as read; not_finite, degenerate, duplicated: of these, left out; parts: how many hang together each for
    itself; loose_area: share of all but the largest; largest, whole: extent (x, y, z) of the largest part and of all.
    Of the largest part: holes: lines of open edges narrower than a tenth of it; hole_width: the widest of these; rims:
    wider ones, hems and openings; open_edges: share of all edges; branching: edges of more than two triangles.
    """

    triangles: int
    not_finite: int
    degenerate: int
    duplicated: int
    parts: int
    loose_area: float
    largest: tuple[float, float, float]
    whole: tuple[float, float, float]
    holes: int
    rims: int
    hole_width: float
    open_edges: float
    branching: int
    coloured: bool

    def as_json(self) -> dict[str, Any]:
        """As a bake's record keeps it."""
        return asdict(self)

    @staticmethod
    def from_json(told: dict[str, Any]) -> Condition:
        """Raises TypeError or KeyError for what a record does not hold."""
        return Condition(**{**told, "largest": tuple(told["largest"]), "whole": tuple(told["whole"])})


def cleaned(scan: Scan) -> tuple[Scan, Condition]:
    """The scan with equal vertices joined and without what is no surface, and its condition. Raises ScanError where
    nothing is left."""
    finite = np.asarray(np.isfinite(scan.vertices).all(1))
    kept = np.asarray(finite[scan.faces].all(1))
    not_finite = int(len(kept) - kept.sum())
    first, weld = _welded(np.where(finite[:, None], scan.vertices, 0.0))
    vertices = scan.vertices[first]
    faces = weld[scan.faces].astype(np.int32)
    flat = kept & ~_spread(vertices, faces)
    kept &= ~flat
    single = _single(faces, kept)
    duplicated = int((kept & ~single).sum())
    kept &= single
    if not_finite == len(scan.faces):
        raise ScanError("every triangle of it has a corner that is no number", "export it again")
    if not kept.any():
        raise ScanError("it holds no triangle that has an area", "export it again")
    colours = None if scan.colours is None else scan.colours[first]
    uv = None if scan.uv is None else scan.uv[kept]
    whole = replace(
        scan, vertices=vertices, faces=faces[kept], uv=uv, picture=scan.picture[kept], colours=colours
    )
    part, area = _parts(whole)
    order = np.argsort(-area, kind="stable")
    main = part == order[0]
    holes, rims, width, share, branching = _openings(vertices, whole.faces[main])
    found = Condition(
        triangles=len(scan.faces),
        not_finite=not_finite,
        degenerate=int(flat.sum()),
        duplicated=duplicated,
        parts=len(area),
        loose_area=float(1 - area[order[0]] / area.sum()),
        largest=_extent(vertices, whole.faces[main]),
        whole=_extent(vertices, whole.faces),
        holes=holes,
        rims=rims,
        hole_width=width,
        open_edges=share,
        branching=branching,
        coloured=scan.coloured,
    )
    return whole, found


def largest_part(scan: Scan) -> Scan:
    """The part of the greatest area alone."""
    part, area = _parts(scan)
    kept = part == int(np.argmax(area))
    uv = None if scan.uv is None else scan.uv[kept]
    return replace(scan, faces=scan.faces[kept], uv=uv, picture=scan.picture[kept])


def _welded(vertices: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """First of each set of equal vertices, and which set each (V,) belongs to."""
    order = np.lexsort(vertices.T)
    ordered = vertices[order]
    new = np.ones(len(vertices), bool)
    new[1:] = (ordered[1:] != ordered[:-1]).any(1)
    weld = np.zeros(len(vertices), np.int64)
    weld[order] = np.cumsum(new) - 1
    return order[new], weld


def _spread(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Which faces (F,) have an area."""
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    distinct = (faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])
    across, longest = np.cross(b - a, c - a), np.maximum(((b - a) ** 2).sum(1), ((c - a) ** 2).sum(1))
    with np.errstate(invalid="ignore"):
        return distinct & ((across**2).sum(1) > 1e-16 * longest**2)


def _single(faces: np.ndarray, kept: np.ndarray) -> np.ndarray:
    """Which faces (F,) are the first of their three vertices, among the kept ones."""
    rows = np.flatnonzero(kept)
    low = np.sort(faces[rows], axis=1).astype(np.int64)
    order = np.lexsort((rows, low[:, 2], low[:, 1], low[:, 0]))
    ordered = low[order]
    again = (ordered[1:] == ordered[:-1]).all(1)
    single = np.ones(len(faces), bool)
    single[rows[order[1:][again]]] = False
    return single


def _parts(scan: Scan) -> tuple[np.ndarray, np.ndarray]:
    """The part of each face (F,), and each part's area."""
    faces, count = scan.faces, len(scan.vertices)
    part = components(count, np.r_[faces[:, 0], faces[:, 1]], np.r_[faces[:, 1], faces[:, 2]])[faces[:, 0]]
    _, part = np.unique(part, return_inverse=True)
    a, b, c = (scan.vertices[faces[:, k]] for k in range(3))
    size = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    return part, np.bincount(part, size)


def _openings(vertices: np.ndarray, faces: np.ndarray) -> tuple[int, int, float, float, int]:
    """Holes, rims, width of the widest hole, share of open edges, and edges of more than two faces."""
    count = len(vertices)
    ends = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    ends.sort(axis=1)
    key, many = np.unique(ends[:, 0].astype(np.int64) * count + ends[:, 1], return_counts=True)
    border, branching = key[many == 1], int((many > 2).sum())
    if not len(border):
        return 0, 0, 0.0, 0.0, branching
    used, local = np.unique(np.stack([border // count, border % count]), return_inverse=True)
    first, second = local.reshape(2, -1)
    loop = components(len(used), first, second)
    low, high = (np.full((int(loop.max()) + 1, 3), sign * np.inf) for sign in (1, -1))
    np.minimum.at(low, loop, vertices[used])
    np.maximum.at(high, loop, vertices[used])
    width = (high - low).max(1)
    narrow = width < NARROW * max(_extent(vertices, faces))
    widest = float(width[narrow].max()) if narrow.any() else 0.0
    return int(narrow.sum()), int((~narrow).sum()), widest, len(border) / len(key), branching


def _extent(vertices: np.ndarray, faces: np.ndarray) -> tuple[float, float, float]:
    used = vertices[np.unique(faces)]
    x, y, z = np.ptp(used, axis=0).tolist()
    return x, y, z
