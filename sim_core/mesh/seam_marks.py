"""Where the two sides of a seam have their vertices: corners, notches and ends of inner lines, and steps between."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sim_core.errors import OutlineError
from sim_core.mesh.outline.contours import CORNER_DEGREES, outline_turning
from sim_core.mesh.outline.size_field import SizeField

__all__ = ["Leg", "Steps", "arc_lengths", "at_lengths", "seam_steps"]

SAME = 1e-9  # of the length: places nearer than this are one
ONE = 0.2  # of the edge: marks of the two sides, and notches, nearer than this become one vertex
WHOLE = 1e-6  # of a step: what a stretch may be longer than a whole number of them
PARTS = 256  # of a stretch between marks, at least, over which edge lengths of size fields are summed
MOST_PARTS = 100_000


class Leg(NamedTuple):
    """A part of a seam's side between two corners of the outline.

    points: (n, 2) [m] in the outline's direction.  arc: (n,) [m] lengths along them.  begin, end: the places of the
    first and the last in the outline.  backward: whether the seam runs against the outline.  hard: (k,) [m] where on
    the way there must be vertices: sharp turns, ends of inner lines.
    """

    points: np.ndarray
    arc: np.ndarray
    begin: int
    end: int
    backward: bool
    hard: np.ndarray

    @staticmethod
    def of(outline: np.ndarray, run: np.ndarray, kept: set, *, backward: bool) -> Leg:
        """The leg along the places `run` of an outline (N, 2) [m]; kept: points, as tuples, that must be vertices."""
        points = outline[run]
        arc = arc_lengths(points)
        marked = outline_turning(points) > CORNER_DEGREES
        if kept:
            marked |= np.array([tuple(point) in kept for point in points.tolist()])
        marked[[0, -1]] = False
        return Leg(points, arc, int(run[0]), int(run[-1]), backward, arc[marked])

    @property
    def length(self) -> float:
        """[m]"""
        return float(self.arc[-1])

    @property
    def marks(self) -> np.ndarray:
        """`hard` along the seam. (k,) [m]"""
        return self.length - self.hard[::-1] if self.backward else self.hard

    def sampled(self, along: np.ndarray) -> np.ndarray:
        """Points (m, 2) [m] at places (m,) [m] along the seam, in its direction; marks are the given points."""
        at = self.length - along[::-1] if self.backward else along.copy()
        for mark in self.hard:
            at[np.abs(at - mark) <= SAME * self.length] = mark
        points = at_lengths(self.points, self.arc, at)
        return points[::-1] if self.backward else points


class Steps(NamedTuple):
    """at: of either side, the places (n,) [m] along each of its legs, from 0 to its length.
    notches: (k,) int32, the place of each notch.  joined: [m] greatest distance between marks taken as one."""

    at: tuple[list[np.ndarray], list[np.ndarray]]
    notches: np.ndarray
    joined: float


class _Stretch(NamedTuple):
    """A part of a side that one part of the other is sewn to: the number of its leg, and where in that. [m]"""

    leg: int
    begin: float
    length: float


def arc_lengths(chain: np.ndarray) -> np.ndarray:
    """Length [m] from the first to each point of an open chain (n, 2) [m]."""
    return np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(chain, axis=0).T))])


def at_lengths(chain: np.ndarray, arc: np.ndarray, where: np.ndarray) -> np.ndarray:
    """Points (m, 2) [m] of a chain at lengths `where` (m,) [m]; arc: its `arc_lengths`."""
    return np.column_stack([np.interp(where, arc, chain[:, axis]) for axis in range(2)])


def seam_steps(
    sides: tuple[list[Leg], list[Leg]],
    notches: tuple[float, ...],
    edge: float,
    sizes: tuple[SizeField | None, SizeField | None],
) -> Steps:
    """The places of both sides' vertices.

    sides: their legs in the seam's direction.  notches: fractions of the first side's length, above 0 and below 1.
    edge: [m].  sizes: the panels' size fields.
    Legs are sewn one by one where both sides have as many; a single one is divided in proportion to the other side's.
    Between marks both get the same number of equal steps of at most the edge; with a size field, steps in proportion
    to the shorter edge length of the two sides. Raises OutlineError where legs do not match.
    """
    pairs, joined = _matched(sides, ONE * edge)
    ends = np.cumsum([a.length for a, _ in pairs])
    home = np.minimum(np.searchsorted(ends, np.array(notches) * ends[-1], side="right"), len(pairs) - 1)
    found: tuple[list, list] = ([[[0.0]] for _ in sides[0]], [[[0.0]] for _ in sides[1]])
    count, places = 0, np.zeros(len(notches), dtype=np.int32)
    for number, pair in enumerate(pairs):
        own = np.flatnonzero(home == number)
        begin = ends[number] - pair[0].length
        shares = [float((notches[k] * ends[-1] - begin) / pair[0].length) for k in own]
        fixed = [_fractions(legs[part.leg].marks, part) for legs, part in zip(sides, pair, strict=True)]
        marks, spots, one = _marks(fixed, shares, ONE * edge / max(part.length for part in pair))
        joined = max(joined, one * max(part.length for part in pair))
        first = [count]
        for a, b in zip(marks[:-1], marks[1:], strict=True):
            parts = [
                _Stretch(part.leg, part.begin + a[s] * part.length, (b[s] - a[s]) * part.length)
                for s, part in enumerate(pair)
            ]
            steps = _steps(sides, parts, edge, sizes)
            for s, part in enumerate(parts):
                found[s][part.leg].append(part.begin + steps[s])
            count += len(steps[0])
            first.append(count)
        places[own] = [first[spot] for spot in spots]
    whole: tuple[list, list] = ([], [])
    for s, legs in enumerate(sides):
        for leg, parts in zip(legs, found[s], strict=True):
            whole[s].append(np.concatenate(parts))
            whole[s][-1][-1] = leg.length
    return Steps(whole, places, joined)


def _matched(
    sides: tuple[list[Leg], list[Leg]], near: float
) -> tuple[list[tuple[_Stretch, _Stretch]], float]:
    """What is sewn to what, and by how much a division was moved to a mark of the leg it divides. [m]"""
    a, b = ([_Stretch(k, 0.0, leg.length) for k, leg in enumerate(legs)] for legs in sides)
    if len(a) == len(b):
        return list(zip(a, b, strict=True)), 0.0
    if 1 not in (len(a), len(b)):
        raise OutlineError(f"{len(a)} legs meet {len(b)} – as many on both sides, or one")
    if len(a) == 1:
        a, moved = _divided(sides[0][0], [part.length for part in b], near)
    else:
        b, moved = _divided(sides[1][0], [part.length for part in a], near)
    return list(zip(a, b, strict=True)), moved


def _divided(leg: Leg, others: list[float], near: float) -> tuple[list[_Stretch], float]:
    """A leg in parts in proportion to others [m], divided at its own marks where they are nearer than `near` [m]."""
    lengths = [leg.length * other / sum(others) for other in others]
    begins = np.concatenate([[0.0], np.cumsum(lengths)[:-1]])
    moved = 0.0
    for k in range(1, len(begins)):
        after = begins[k + 1] if k + 1 < len(begins) else leg.length
        free = leg.marks[(leg.marks > begins[k - 1]) & (leg.marks < after)]
        mark = min(free, key=lambda at: abs(at - begins[k]), default=np.inf)
        if abs(mark - begins[k]) <= near:
            moved, begins[k] = max(moved, abs(mark - begins[k])), mark
    if moved:
        lengths = np.diff(np.append(begins, leg.length)).tolist()
    return [_Stretch(0, float(at), length) for at, length in zip(begins, lengths, strict=True)], float(moved)


def _fractions(marks: np.ndarray, part: _Stretch) -> list[float]:
    """Where a stretch has marks of its own between its ends."""
    at = (marks - part.begin) / part.length
    return at[(at > SAME) & (at < 1 - SAME)].tolist()


def _marks(
    fixed: list[list[float]], notches: list[float], near: float
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


def _steps(sides, parts: list[_Stretch], edge: float, sizes) -> list[np.ndarray]:
    """Of both sides, where the steps of a stretch between marks end, from its beginning. (n,) [m]"""
    if sizes[0] is None and sizes[1] is None:
        count = max(1, int(np.ceil(max(part.length for part in parts) / edge - WHOLE)))
        return [np.linspace(0.0, part.length, count + 1)[1:] for part in parts]
    shares = _graded(sides, parts, edge, sizes)
    return [shares * part.length for part in parts]


def _graded(sides, parts: list[_Stretch], edge: float, sizes) -> np.ndarray:
    """Shares (n,) of a stretch between marks, 1 last, in proportion to the shorter edge length of the two sides."""
    longest = max(part.length for part in parts)
    least = min(float(field.sizes.min()) for field in sizes if field is not None)
    fine = np.linspace(0.0, 1.0, int(np.clip(2 * longest / min(least, edge), PARTS, MOST_PARTS)) + 1)
    middle = (fine[:-1] + fine[1:]) / 2
    steps = np.zeros(len(middle))  # that a share of the stretch makes, on the side that wants more
    for legs, part, field in zip(sides, parts, sizes, strict=True):
        where = legs[part.leg].sampled(part.begin + middle * part.length)
        lengths = edge if field is None else field.at(where, edge)
        steps = np.maximum(steps, part.length / lengths)
    count = np.concatenate([[0.0], np.cumsum(steps * np.diff(fine))])
    wanted = max(1, int(np.ceil(count[-1] - WHOLE)))
    return np.interp(np.linspace(0.0, count[-1], wanted + 1)[1:], count, fine)
