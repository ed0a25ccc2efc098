"""Sampling of all contours and inner lines of a panel: corners kept, finer where curves bend or lines run close."""

from dataclasses import dataclass, field, replace

import numpy as np
from scipy.spatial import KDTree

from sim_core.mesh.crossings import crossed_steps
from sim_core.mesh.outline import CORNER_DEGREES, outline_turning
from sim_core.mesh.sizes import SizeField

__all__ = ["Rim", "sampled_contours", "sampled_rim"]

SPLITTING_PASSES = 12
FINEST = 32
SAME = 1e-9  # of a chain's length: places nearer to each other are one
DEVIATION = 0.045  # of the edge: a step that leaves the given line by more is halved
PARTS = 256  # of a chain between corners, at least, over which edge lengths of a size field are summed
MOST_PARTS = 1_000_000


@dataclass(frozen=True, eq=False)
class Rim:
    """What of a mesh is given: the sampled contours and inner lines.

    points: (b, 2) [m], y down, no two equal.  loops: one array of indices per contour, cloth on the left in (x, -y).
    lines: open chains of indices inside the cloth.
    """

    points: np.ndarray
    loops: tuple[np.ndarray, ...]
    lines: tuple[np.ndarray, ...] = ()

    @property
    def contours(self) -> list[np.ndarray]:
        """The sampled contours as points (m, 2) [m]."""
        return [self.points[loop] for loop in self.loops]

    @property
    def steps(self) -> np.ndarray:
        """Directed edges (m, 2) growth starts from: contours once, inner lines in both directions."""
        around = [np.column_stack([loop, np.roll(loop, -1)]) for loop in self.loops]
        along = [np.column_stack([line[:-1], line[1:]]) for line in self.lines]
        return np.concatenate([*around, *along, *(pairs[:, ::-1] for pairs in along)])

    @property
    def segments(self) -> np.ndarray:
        """All steps once, as (m, 4) a.x a.y b.x b.y [m]."""
        pairs = [np.column_stack([loop, np.roll(loop, -1)]) for loop in self.loops]
        pairs += [np.column_stack([line[:-1], line[1:]]) for line in self.lines]
        return self.points[np.concatenate(pairs)].reshape(-1, 4)


@dataclass(frozen=True, eq=False)
class _Chain:
    """A contour (its first point repeated at the end) or an inner line, and where it is sampled, by arc length.

    fixed: where steps begin that stay as they are.
    """

    points: np.ndarray
    arc: np.ndarray
    at: np.ndarray
    closed: bool
    fixed: np.ndarray = field(default_factory=lambda: np.zeros(0))

    def sampled(self) -> np.ndarray:
        return np.column_stack([np.interp(self.at, self.arc, self.points[:, axis]) for axis in range(2)])

    def halved(self, split: np.ndarray) -> "_Chain":
        middle = (self.at[:-1] + self.at[1:]) / 2
        return replace(self, at=np.insert(self.at, np.flatnonzero(split) + 1, middle[split]))

    @property
    def free(self) -> np.ndarray:
        """Steps (bool) that may be divided."""
        return ~np.isin(self.at[:-1], self.fixed)

    def as_given(self, steps: np.ndarray) -> "_Chain":
        """The chain with all its given points in the marked steps (bool)."""
        step = np.clip(np.searchsorted(self.at, self.arc, side="right") - 1, 0, len(steps) - 1)
        given = self.arc[steps[step]]
        gap = np.abs(self.at[:, None] - given).min(axis=1, initial=np.inf)
        kept = self.at[(gap == 0) | (gap > SAME * self.arc[-1])]  # no sample within rounding of a given point
        return replace(self, at=np.union1d(kept, given))


def sampled_contours(contours: list[np.ndarray], edge: float) -> list[np.ndarray]:
    """Samples (m, 2) [m] of each contour (n, 2) [m]: `sampled_rim` without inner lines."""
    return sampled_rim(contours, edge).contours


def sampled_rim(
    contours: list[np.ndarray],
    edge: float,
    *,
    lines: tuple[np.ndarray, ...] = (),
    kept: np.ndarray | None = None,
    sizes: SizeField | None = None,
    fixed: np.ndarray | None = None,
) -> Rim:
    """Sample contours and inner lines: every corner, and equal steps of at most `edge` between corners.

    contours: (n, 2) [m] each, closed without repeating a point.  edge: [m].  lines: (n, 2) [m] each, open, meeting
    contours and each other only at their own points.  kept: (k, 2) [m] further points of contours that stay.
    sizes: shorter steps by place.  fixed: (n,) bool, steps of the first contour, by the point they begin at, that
    are sampled already (a seam's).
    A step is halved, along the given line, where it leaves that line by more than 0.045 edge, and while a sample that
    is no neighbour lies in the circle over it as diameter: then it is a Delaunay edge, and growth follows it without
    recovery of constraints. Spikes would halve for ever: steps stay above edge / 32. Steps that cross each other,
    where bent lines run closer than that, follow the given line point by point, which crosses nothing.
    """
    corners = {tuple(point) for line in lines for point in line[[0, -1]]}
    corners |= {tuple(point) for point in (() if kept is None else kept)}
    chains = [_chain(contours[0], True, corners, edge, sizes, fixed)]
    chains += [_chain(contour, True, corners, edge, sizes) for contour in contours[1:]]
    chains += [_chain(line, False, corners, edge, sizes) for line in lines]
    finest = edge / FINEST if sizes is None else min(edge, float(sizes.sizes.min())) / FINEST
    for _ in range(SPLITTING_PASSES):
        places = [chain.sampled() for chain in chains]
        split = [_strays(chain, DEVIATION * edge) for chain in chains]
        crowded = _crowded(places, [chain.closed for chain in chains])
        steps = [np.hypot(*np.diff(place, axis=0).T) > finest for place in places]
        split = [(a | b) & c for a, b, c in zip(split, crowded, steps, strict=True)]
        if fixed is not None:
            split[0] &= chains[0].free
        if not any(mark.any() for mark in split):
            break
        chains = [chain.halved(mark) for chain, mark in zip(chains, split, strict=True)]
    for _ in range(SPLITTING_PASSES):
        crossed = crossed_steps([chain.sampled() for chain in chains])
        if not any(mark.any() for mark in crossed):
            break
        chains = [chain.as_given(mark) for chain, mark in zip(chains, crossed, strict=True)]
    return _joined(chains)


def _chain(
    points: np.ndarray, closed: bool, kept: set, edge: float, sizes: SizeField | None, fixed=None
) -> _Chain:
    """A chain with its first samples: corners, kept points, and even steps between them; fixed: as `sampled_rim`."""
    turning = outline_turning(points)
    corner = turning > CORNER_DEGREES
    if kept:
        corner |= np.array([tuple(point) in kept for point in points])
    if fixed is not None:
        corner |= fixed | np.roll(fixed, 1)
    if not closed:
        corner[[0, -1]] = True
    elif not corner.any():
        corner[0] = True
    if closed:
        first = int(np.flatnonzero(corner)[0])
        points, corner = np.roll(points, -first, axis=0), np.roll(corner, -first)
        fixed = None if fixed is None else np.roll(fixed, -first)
        points, corner = np.vstack([points, points[:1]]), np.append(corner, True)
    arc = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    marks = arc[corner]
    least = max(1, -(-3 // (len(marks) - 1))) if closed else 1
    whole = set() if fixed is None else set(arc[:-1][fixed].tolist())
    at = [
        np.array([a]) if a in whole else _even(points, arc, a, b, edge, sizes, least)
        for a, b in zip(marks[:-1], marks[1:], strict=True)
    ]
    return _Chain(points, arc, np.concatenate([*at, marks[-1:]]), closed, np.array(sorted(whole)))


def _even(
    points, arc, begin: float, end: float, edge: float, sizes: SizeField | None, least: int
) -> np.ndarray:
    """Sample positions from begin to before end: equal steps, or steps in proportion to the size field."""
    if sizes is None:
        fewest = max(least, int(np.ceil((end - begin) / edge - 1e-9)))
        for steps in range(fewest, 2 * fewest):  # a bend gets more, but still even, steps
            at = np.linspace(begin, end, steps + 1)
            inner = (arc >= begin) & (arc <= end)
            if not _strays(_Chain(points[inner], arc[inner], at, False), DEVIATION * edge).any():
                return at[:-1]
        return np.linspace(begin, end, fewest + 1)[:-1]
    parts = int(np.clip(2 * (end - begin) / sizes.sizes.min(), PARTS, MOST_PARTS))
    fine = np.linspace(begin, end, parts + 1)
    middle = (fine[:-1] + fine[1:]) / 2
    places = np.column_stack([np.interp(middle, arc, points[:, axis]) for axis in range(2)])
    count = np.concatenate([[0.0], np.cumsum(np.diff(fine) / sizes.at(places, edge))])
    steps = max(least, int(np.ceil(count[-1] - 1e-9)))
    return np.interp(np.linspace(0, count[-1], steps + 1)[:-1], count, fine)


def _strays(chain: _Chain, most: float) -> np.ndarray:
    """Steps that a given point between their ends is further from than `most` [m]. Returns (steps,) bool."""
    stray = np.zeros(len(chain.at) - 1, dtype=bool)
    step = np.clip(np.searchsorted(chain.at, chain.arc, side="right") - 1, 0, len(stray) - 1)
    places = chain.sampled()
    a, along = places[step], places[step + 1] - places[step]
    square = np.maximum((along**2).sum(axis=1), 1e-300)
    t = np.clip(((chain.points - a) * along).sum(axis=1) / square, 0, 1)
    gap = np.hypot(*(chain.points - a - t[:, None] * along).T)
    stray[step[gap > most]] = True
    return stray


def _crowded(places: list[np.ndarray], closed: list[bool]) -> list[np.ndarray]:
    """Steps whose circle over them as diameter holds a sample other than those next to the step."""
    starts, ends, before, after = [], [], [], []
    for place, round_ in zip(places, closed, strict=True):
        starts.append(place[:-1])
        ends.append(place[1:])
        before.append(np.vstack([place[-2:-1] if round_ else place[:1], place[:-2]]))
        after.append(np.vstack([place[2:], place[1:2] if round_ else place[-1:]]))
    points = np.concatenate(
        [*starts, *(p[-1:] for p, round_ in zip(places, closed, strict=True) if not round_)]
    )
    a, b, behind, beyond = (np.concatenate(rows) for rows in (starts, ends, before, after))
    middle, reach = (a + b) / 2, np.hypot(*(b - a).T) / 2 * (1 - 1e-9)
    tree = KDTree(points)
    crowded = np.zeros(len(a), dtype=bool)
    for k in np.flatnonzero(tree.query_ball_point(middle, reach, return_length=True)):
        others = points[tree.query_ball_point(middle[k], reach[k])]
        known = np.stack([a[k], b[k], behind[k], beyond[k]])
        crowded[k] = bool((others[:, None] != known).any(axis=2).all(axis=1).any())
    return np.split(crowded, np.cumsum([len(rows) for rows in starts])[:-1])


def _joined(chains: list[_Chain]) -> Rim:
    """One list of points; inner lines share theirs where they meet contours or each other."""
    loops, points = [], []
    count = 0
    for chain in chains:
        if chain.closed:
            points.append(chain.sampled()[:-1])
            loops.append(np.arange(count, count + len(points[-1]), dtype=np.int32))
            count += len(points[-1])
    lines = [chain.sampled() for chain in chains if not chain.closed]
    if not lines:
        return Rim(np.concatenate(points), tuple(loops))
    number = {tuple(point): k for k, point in enumerate(np.concatenate(points).tolist())}
    numbered = []
    for line in lines:
        for point in line.tolist():
            number.setdefault(tuple(point), len(number))
        numbered.append(np.array([number[tuple(point)] for point in line.tolist()], dtype=np.int32))
    return Rim(np.array(list(number)), tuple(loops), tuple(numbered))
