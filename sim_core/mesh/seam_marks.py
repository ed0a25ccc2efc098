"""Where the two sides of a seam have their vertices: corners, notches and ends of inner lines, and steps between."""

from typing import NamedTuple

import numpy as np

from sim_core.mesh.outline.contours import CORNER_DEGREES, outline_turning
from sim_core.mesh.outline.size_field import SizeField

__all__ = ["Steps", "arc_lengths", "at_lengths", "seam_steps"]

SAME = 1e-9  # of the length: places nearer than this are one
ONE = 0.2  # of the edge: marks of the two sides, and notches, nearer than this become one vertex
PARTS = 256  # of a stretch between marks, at least, over which edge lengths of size fields are summed
MOST_PARTS = 100_000


class Steps(NamedTuple):
    """at: two arrays (N + 1,) [m], places along either side, from 0 to its length.
    notches: (k,) int32, the place of each notch.  joined: [m] greatest distance between marks taken as one."""

    at: tuple[np.ndarray, np.ndarray]
    notches: np.ndarray
    joined: float


def arc_lengths(chain: np.ndarray) -> np.ndarray:
    """Length [m] from the first to each point of an open chain (n, 2) [m]."""
    return np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(chain, axis=0).T))])


def at_lengths(chain: np.ndarray, arc: np.ndarray, where: np.ndarray) -> np.ndarray:
    """Points (m, 2) [m] of a chain at lengths `where` (m,) [m]; arc: its `arc_lengths`."""
    return np.column_stack([np.interp(where, arc, chain[:, axis]) for axis in range(2)])


def seam_steps(
    sides: tuple[np.ndarray, np.ndarray],
    kept: tuple[set, set],
    notches: tuple[float, ...],
    edge: float,
    sizes: tuple[SizeField | None, SizeField | None],
) -> Steps:
    """The places of both sides' vertices.

    sides: the chains (n, 2) [m], first to last.  kept: points, as tuples, of each that must be vertices besides its
    corners.  notches: fractions above 0 and below 1.  edge: [m].  sizes: the panels' size fields.
    Between marks both sides get the same number of equal steps, round(longer / edge); with a size field, steps in
    proportion to the shorter edge length of the two sides.
    """
    arcs = [arc_lengths(chain) for chain in sides]
    longest = float(max(arc[-1] for arc in arcs))
    fixed = [_fractions(*side) for side in zip(sides, arcs, kept, strict=True)]
    marks, spots, joined = _marks(fixed, notches, ONE * edge / longest)
    found: tuple[list, list] = ([], [])
    count = [0]
    for begin, end in zip(marks[:-1], marks[1:], strict=True):
        if sizes[0] is None and sizes[1] is None:
            stretch = max((end[s] - begin[s]) * arcs[s][-1] for s in (0, 1))
            share = np.linspace(0.0, 1.0, max(1, round(stretch / edge)) + 1)[:-1]
        else:
            share = _graded(sides, arcs, begin, end, edge, sizes)
        count.append(count[-1] + len(share))
        for s in (0, 1):
            found[s].append(begin[s] + share * (end[s] - begin[s]))
    a, b = (
        _on_corners(np.append(np.concatenate(at), 1.0) * arc[-1], arc)
        for at, arc in zip(found, arcs, strict=True)
    )
    return Steps((a, b), np.array([count[spot] for spot in spots], dtype=np.int32), joined * longest)


def _fractions(chain: np.ndarray, arc: np.ndarray, kept: set) -> list[float]:
    """Where a side has corners, and kept points, between its ends."""
    marked = outline_turning(chain) > CORNER_DEGREES
    if kept:
        marked |= np.array([tuple(point) in kept for point in chain.tolist()])
    marked[[0, -1]] = False
    return (arc[marked] / arc[-1]).tolist()


def _marks(
    fixed: list[list[float]], notches: tuple[float, ...], near: float
) -> tuple[list[tuple[float, float]], list[int], float]:
    """Marks as fractions of both sides, the mark of each notch, and the widest spread of what became one mark.

    Marks join the one before where that begins nearer than `near`; never two of one side, which must both stay.
    """
    given = [(at, side, -1) for side in (0, 1) for at in fixed[side]]
    given += [(at, 2, k) for k, at in enumerate(notches)]
    groups: list[list[tuple[float, int, int]]] = [[(0.0, 0, -1), (0.0, 1, -1)]]
    for mark in sorted(given):
        taken = mark[1] < 2 and any(mark[1] == other[1] for other in groups[-1])
        if taken or mark[0] - groups[-1][0][0] > near:
            groups.append([])
        groups[-1].append(mark)
    end = [(1.0, 0, -1), (1.0, 1, -1)]
    only_notches = len(groups) > 1 and all(side == 2 for _, side, _ in groups[-1])
    if only_notches and 1.0 - groups[-1][0][0] <= near:
        groups[-1].extend(end)
    else:
        groups.append(end)
    places, joined = [], 0.0
    spots = [0] * len(notches)
    for k, group in enumerate(groups):
        first = [next((at for at, side, _ in group if side == wanted), None) for wanted in (0, 1, 2)]
        other = first[2] if first[2] is not None else next(at for at in first if at is not None)
        places.append(tuple(other if at is None else at for at in first[:2]))
        spread = max(at for at, _, _ in group) - min(at for at, _, _ in group)
        joined = max(joined, spread if spread > SAME else 0.0)
        for _, side, number in group:
            if side == 2:
                spots[number] = k
    return places, spots, joined


def _graded(sides, arcs, begin, end, edge: float, sizes) -> np.ndarray:
    """Shares (m,) of a stretch between marks, 0 first and 1 left out, in proportion to the shorter edge length."""
    longest = max((end[s] - begin[s]) * arcs[s][-1] for s in (0, 1))
    least = min(float(field.sizes.min()) for field in sizes if field is not None)
    fine = np.linspace(0.0, 1.0, int(np.clip(2 * longest / min(least, edge), PARTS, MOST_PARTS)) + 1)
    middle = (fine[:-1] + fine[1:]) / 2
    steps = np.zeros(len(middle))  # that a share of the stretch makes, on the side that wants more
    for s, field in enumerate(sizes):
        where = (begin[s] + middle * (end[s] - begin[s])) * arcs[s][-1]
        lengths = edge if field is None else field.at(at_lengths(sides[s], arcs[s], where), edge)
        steps = np.maximum(steps, (end[s] - begin[s]) * arcs[s][-1] / lengths)
    count = np.concatenate([[0.0], np.cumsum(steps * np.diff(fine))])
    return np.interp(np.linspace(0.0, count[-1], max(1, round(count[-1])) + 1)[:-1], count, fine)


def _on_corners(where: np.ndarray, arc: np.ndarray) -> np.ndarray:
    """Lengths [m], those within rounding of a given point moved to it: corners stay what they are, to the bit."""
    after = np.clip(np.searchsorted(arc, where), 1, len(arc) - 1)
    near = np.where(where - arc[after - 1] < arc[after] - where, arc[after - 1], arc[after])
    return np.where(np.abs(near - where) <= SAME * arc[-1], near, where)
