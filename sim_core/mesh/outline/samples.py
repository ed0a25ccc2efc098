"""Sampling of all contours and inner lines of a panel: corners kept, finer where curves bend or lines run close."""

from dataclasses import dataclass, field, replace

import numpy as np

from sim_core.mesh.geometry.nearest import nearest_others, size_boxes
from sim_core.mesh.outline.contours import CORNER_DEGREES, outline_turning
from sim_core.mesh.outline.crossings import crossed_steps
from sim_core.mesh.outline.size_field import SizeField

__all__ = ["Rim", "even_places", "sampled_contours", "sampled_rim"]

SPLITTING_PASSES = 12
FINEST = 32
SAME = 1e-9  # of a chain's length: places nearer to each other are one
DEVIATION = 0.045  # of the edge: a step that leaves the given line by more is halved
PARTS = 256  # of a chain between corners, at least, over which edge lengths of a size field are summed
MOST_PARTS = 1_000_000
TRIALS = 128  # numbers of even steps that are tried on a bend


@dataclass(frozen=True, eq=False)
class Rim:
    """What of a mesh is given: the sampled contours and inner lines.

    points: (b, 2) [m], y down, no two equal.  loops: one array of indices per contour, cloth on the left in (x, -y).
    lines: open chains of indices inside the cloth.  whole: (k,) bool, which of the first k
    `steps` must not be divided further (a seam's); those behind them may be.
    """

    points: np.ndarray
    loops: tuple[np.ndarray, ...]
    lines: tuple[np.ndarray, ...] = ()
    whole: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=bool))

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
    def kept(self) -> np.ndarray:
        """Which of `steps` must not be divided. (m,) bool"""
        kept = np.zeros(len(self.steps), dtype=bool)
        kept[: len(self.whole)] = self.whole
        return kept

    def divided(self, parts: np.ndarray) -> "Rim":
        """The rim with steps divided: parts (k, 3) first, last and middle point of each, in the order they were. The
        middles get no place among `points`."""
        middle = {(min(a, b), max(a, b)): v for a, b, v in parts.tolist()}

        def along(chain: list[int]) -> np.ndarray:
            found, ahead = [chain[0]], chain[:0:-1]
            while ahead:
                step = (min(found[-1], ahead[-1]), max(found[-1], ahead[-1]))
                if step in middle:
                    ahead.append(middle[step])
                else:
                    found.append(ahead.pop())
            return np.array(found, dtype=np.int32)

        loops = tuple(along([*loop.tolist(), int(loop[0])])[:-1] for loop in self.loops)
        return replace(self, loops=loops, lines=tuple(along(line.tolist()) for line in self.lines))

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
        after = np.clip(np.searchsorted(given, self.at), 0, max(len(given) - 1, 0))
        gap = np.full(len(self.at), np.inf)
        if len(given):
            gap = np.minimum(
                np.abs(given[after] - self.at), np.abs(given[np.maximum(after - 1, 0)] - self.at)
            )
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
        crowded = _crowded(places, [chain.closed for chain in chains], finest / 2)
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
    straight = len(points) == 2
    corner = np.ones(2, dtype=bool) if straight else outline_turning(points) > CORNER_DEGREES
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
        np.array([a]) if a in whole else even_places(points, arc, a, b, edge, sizes, least)
        for a, b in zip(marks[:-1], marks[1:], strict=True)
    ]
    return _Chain(points, arc, np.concatenate([*at, marks[-1:]]), closed, np.array(sorted(whole)))


def even_places(
    points, arc, begin: float, end: float, edge: float, sizes: SizeField | None, least: int
) -> np.ndarray:
    """Lengths [m] of samples from begin to before end: equal steps, or steps in proportion to the size field.

    points: (n, 2) [m] of a chain, `arc` (n,) [m] the lengths along it; begin and end are among these.  edge: [m].
    least: how many steps there are at least.
    """
    if sizes is None:
        fewest = max(least, int(np.ceil((end - begin) / edge - 1e-9)))
        first, last = np.searchsorted(arc, (begin, end))
        part = slice(int(first), int(last) + 1)
        if last == first + 1:  # straight
            return np.linspace(begin, end, fewest + 1)[:-1]
        for steps in range(
            fewest, 2 * fewest, max(1, fewest // TRIALS)
        ):  # a bend gets more, but still even, steps
            at = np.linspace(begin, end, steps + 1)
            if not _strays(_Chain(points[part], arc[part], at, False), DEVIATION * edge).any():
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
    if len(chain.points) == 2:
        return stray
    step = np.clip(np.searchsorted(chain.at, chain.arc, side="right") - 1, 0, len(stray) - 1)
    places = chain.sampled()
    a, along = places[step], places[step + 1] - places[step]
    square = np.maximum((along**2).sum(axis=1), 1e-300)
    t = np.clip(((chain.points - a) * along).sum(axis=1) / square, 0, 1)
    gap = np.hypot(*(chain.points - a - t[:, None] * along).T)
    stray[step[gap > most]] = True
    return stray


def _crowded(places: list[np.ndarray], closed: list[bool], least: float) -> list[np.ndarray]:
    """Steps whose circle over them as diameter holds a sample other than those next to the step, not nearer to it than
    `least` [m]: a gap narrower than that stays narrow however fine the steps are."""
    starts, ends, before, after = [], [], [], []
    for place, round_ in zip(places, closed, strict=True):
        starts.append(place[:-1])
        ends.append(place[1:])
        before.append(np.vstack([place[-2:-1] if round_ else place[:1], place[:-2]]))
        after.append(np.vstack([place[2:], place[1:2] if round_ else place[-1:]]))
    points = np.concatenate([*starts, *ends])
    points = points[
        np.lexsort((points[:, 1], points[:, 0]))
    ]  # np.unique hashes: thirty times as long for these
    points = points[np.append(True, (points[1:] != points[:-1]).any(axis=1))]
    a, b, behind, beyond = (np.concatenate(rows) for rows in (starts, ends, before, after))
    middle, reach = (a + b) / 2, np.hypot(*(b - a).T) / 2
    boxes = size_boxes(points, np.zeros(len(points)))
    known = np.stack([a, b, behind, beyond], axis=1)
    nearest = nearest_others(middle, reach * (1 - 1e-9), known, boxes.points, boxes.boxes, boxes.first)
    unit = (b - a) / np.maximum(2 * reach, 1e-300)[:, None]
    off = boxes.points[nearest] - a
    gap = np.abs(off[:, 0] * unit[:, 1] - off[:, 1] * unit[:, 0])
    crowded = (nearest >= 0) & (gap >= least)
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
    whole = ~chains[0].free
    lines = [chain.sampled() for chain in chains if not chain.closed]
    if not lines:
        return Rim(np.concatenate(points), tuple(loops), whole=whole)
    number = {tuple(point): k for k, point in enumerate(np.concatenate(points).tolist())}
    numbered = []
    for line in lines:
        for point in line.tolist():
            number.setdefault(tuple(point), len(number))
        numbered.append(np.array([number[tuple(point)] for point in line.tolist()], dtype=np.int32))
    return Rim(np.array(list(number)), tuple(loops), tuple(numbered), whole)
