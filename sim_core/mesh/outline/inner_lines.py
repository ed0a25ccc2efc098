"""Inner lines of a panel (pleat folds, motif borders): inside the outline, cut where they meet, joined to it."""

from bisect import bisect

import numpy as np

from sim_core.errors import OutlineError
from sim_core.mesh.outline.contours import clean_points
from sim_core.mesh.outline.crossings import crossed_steps

__all__ = ["clean_lines"]

NEAR = 1e-6  # of the panel's extent: a line's point this near to a contour or to another line lies on it
PARALLEL = 1e-9  # [rad] steps from one point at less than this may lie on each other


class _Chains:
    """Contours or lines (n, 2) [m] whose steps are found by place, and what is put into them.

    A tree holds all steps, and each step the points put into it in order, so that many ends on one line take no more
    than many ends on many lines.
    """

    def __init__(self, chains: list[np.ndarray], *, closed: bool) -> None:
        from shapely import STRtree, linestrings

        ahead = [np.roll(chain, -1, axis=0) if closed else chain[1:] for chain in chains]
        counts = [len(steps) for steps in ahead]
        self.points = chains
        self.owner = np.repeat(np.arange(len(chains)), counts)
        self.step = np.concatenate([np.arange(count) for count in counts])
        behind = [chain[: len(steps)] for chain, steps in zip(chains, ahead, strict=True)]
        drawn = linestrings(np.stack([np.concatenate(behind), np.concatenate(ahead)], axis=1))
        self.tree = STRtree(np.asarray(drawn))
        self.put: dict[int, list[tuple[float, np.ndarray]]] = {}

    def ends(self, step: int) -> tuple[int, int, int]:
        """Chain of a step, and the points of it where the step begins and ends."""
        k, m = int(self.owner[step]), int(self.step[step])
        return k, m, (m + 1) % len(self.points[k])

    def foot(self, step: int, point: np.ndarray) -> tuple[float, np.ndarray, float]:
        """Where on a step the point nearest to `point` lies: its share of the step, its place [m], the distance [m]."""
        k, m, n = self.ends(step)
        a = self.points[k][m]
        along = self.points[k][n] - a
        share = float(np.clip((point - a) @ along / max(along @ along, 1e-300), 0, 1))
        place = a + share * along
        return share, place, float(np.hypot(*(place - point)))

    def beside(self, step: int, share: float) -> list[np.ndarray]:
        """The points put into a step that lie next to a share of it."""
        put = self.put.get(step, [])
        at = bisect(put, share, key=lambda found: found[0])
        return [place for _, place in put[max(at - 1, 0) : at + 1]]

    def insert(self, step: int, share: float, place: np.ndarray) -> None:
        """Put a point into a step."""
        put = self.put.setdefault(step, [])
        put.insert(bisect(put, share, key=lambda found: found[0]), (share, place))

    def joined(self) -> list[np.ndarray]:
        """The chains with all that was put into them."""
        found = list(self.points)
        into: dict[int, list[int]] = {}
        for step in sorted(self.put):
            into.setdefault(int(self.owner[step]), []).append(step)
        for k, steps in into.items():
            at = [int(self.step[step]) + 1 for step in steps for _ in self.put[step]]
            found[k] = np.insert(found[k], at, [place for s in steps for _, place in self.put[s]], axis=0)
        return found


def clean_lines(
    lines, contours: list[np.ndarray]
) -> tuple[tuple[np.ndarray, ...], list[np.ndarray], np.ndarray]:
    """Check inner lines and join them to the contours.

    lines: (n, 2) [m] each, open; they may cross and touch.  contours: as `clean_contours` returns them.
    Returns the lines cut at every crossing, the contours with the points lines end at put in, and those points.
    Raises OutlineError naming the line where it is no line or leaves the cloth.
    """
    from shapely import line_merge

    near = NEAR * float(np.ptp(contours[0], axis=0).max())
    given = [_clean_line(line, f"constraint {k}", near) for k, line in enumerate(lines)]
    _check_inside(given, contours, near)
    given, contours, kept = _joined_to_contours(given, contours, near)
    given = _joined_to_each_other(given, near)
    edges = _off_contours(_noded(given, near), contours, near / 2)
    merged = line_merge(edges) if edges.geom_type == "MultiLineString" else edges
    parts = list(getattr(merged, "geoms", [merged]))
    found = tuple(np.array(part.coords) for part in parts if not part.is_empty and part.length > near)
    return tuple(_opened(found)), contours, kept


def _clean_line(line, name: str, near: float) -> np.ndarray:
    points = clean_points(line, name)
    gaps = np.hypot(*np.diff(points, axis=0).T) if len(points) > 1 else np.zeros(0)
    points = points[np.concatenate([[True], gaps > near])] if len(points) else points
    if len(points) < 2:
        raise OutlineError(f"{name}: {len(points)} different points – a line needs at least two")
    return points


def _check_inside(given: list[np.ndarray], contours: list[np.ndarray], near: float) -> None:
    from shapely import LineString, Polygon, covers, get_coordinates, prepare

    cloth = Polygon(contours[0], contours[1:]).buffer(near)
    prepare(cloth)
    drawn = [LineString(points) for points in given]
    outside = np.flatnonzero(~covers(cloth, drawn))
    if outside.size:
        x, y = np.array(get_coordinates(drawn[outside[0]].difference(cloth)))[0]
        raise OutlineError(
            f"constraint {outside[0]}: leaves the cloth near ({x:.4f}, {y:.4f}) m – keep inner lines inside the outline"
        )


def _joined_to_contours(given: list[np.ndarray], contours: list[np.ndarray], near: float):
    """Points of lines that are near a contour move to their foot on it, which it then holds as a point of its own:
    lines, contours, and the points of contours that lines have now (k, 2)."""
    from shapely import points

    rims = _Chains(contours, closed=True)
    ends = np.cumsum([0, *(len(line) for line in given)])
    places, kept = np.concatenate(given), []
    of, steps = rims.tree.query(points(places), predicate="dwithin", distance=near)
    order = np.lexsort((steps, of))
    of, steps = of[order], steps[order]
    found, first = np.unique(of, return_index=True)
    bounds = np.append(first, len(of))
    for k, begin, end in zip(found.tolist(), bounds[:-1], bounds[1:], strict=True):
        some = steps[begin:end]
        some = some[rims.owner[some] == rims.owner[some[0]]]  # the first contour that is near
        places[k] = _put_in(places[k], rims, some.tolist(), near)
        kept.append(places[k])
    moved = [places[a:b] for a, b in zip(ends[:-1], ends[1:], strict=True)]
    return moved, rims.joined(), np.array(kept).reshape(-1, 2)


def _put_in(point: np.ndarray, rims: _Chains, steps: list[int], near: float) -> np.ndarray:
    """The foot of a point on the nearest of some steps of a contour, or a point that is there already."""
    feet = [rims.foot(step, point) for step in steps]
    best = min(range(len(steps)), key=lambda k: feet[k][2])
    share, place, _ = feet[best]
    k, m, n = rims.ends(steps[best])
    for there in (rims.points[k][m], rims.points[k][n], *rims.beside(steps[best], share)):
        if np.hypot(*(there - point)) <= 2 * near:
            return there
    rims.insert(steps[best], share, place)
    return place


def _joined_to_each_other(given: list[np.ndarray], near: float) -> list[np.ndarray]:
    """Lines that another one ends on hold its end as a point of their own."""
    from shapely import Point

    chains = _Chains(given, closed=False)
    done = set()
    for k in range(len(given)):
        for end in (0, -1):
            point = given[k][end].copy()
            if (key := tuple(point.tolist())) in done:
                continue  # many lines meet here: all hold it since the first of them
            done.add(key)
            steps = chains.tree.query(
                Point(point), predicate="dwithin", distance=2 * near
            )  # points have moved
            owners = chains.owner[steps]
            for m in np.unique(owners[owners != k]).tolist():
                _end_on(point, chains, steps[owners == m].tolist(), near)
    return chains.joined()


def _end_on(point: np.ndarray, chains: _Chains, steps: list[int], near: float) -> None:
    """Give the nearest of some steps of a line the point, unless it has it, where it passes near: one of its ends
    moves there, or it is divided."""
    feet = [chains.foot(step, point) for step in steps]
    best = min(range(len(steps)), key=lambda k: feet[k][2])
    share, _, gap = feet[best]
    if gap > near:
        return
    k, m, n = chains.ends(steps[best])
    line = chains.points[k]
    held = [line[m], line[n], *chains.beside(steps[best], share)]
    if any((there == point).all() for there in held):
        return
    for end in (m, n):
        if np.hypot(*(line[end] - point)) <= near:
            line[end] = point
            return
    if all(np.hypot(*(there - point)) > near for there in held):
        chains.insert(steps[best], share, point)


def _noded(given: list[np.ndarray], near: float):
    """The lines cut where they meet, each stretch once. Where they meet at ends of steps only, they are so already:
    GEOS would try all pairs of those that meet at one place."""
    from shapely import MultiLineString, unary_union

    edges = MultiLineString([points.tolist() for points in given])
    if any(marks.any() for marks in crossed_steps(given)) or _side_by_side(given):
        edges = unary_union(edges)
        return _snapped(edges, np.concatenate(given), near) if _nearly_meet(edges, near) else edges
    return edges


def _nearly_meet(edges, near: float) -> bool:
    """Whether a point of noded lines lies as near to another one as rounding leaves it, or to a step between two."""
    from shapely import STRtree, linestrings, points

    steps = _steps(edges)
    places, ends = np.unique(steps.reshape(-1, 2), axis=0, return_inverse=True)
    of, found = STRtree(np.asarray(linestrings(steps))).query(
        points(places), predicate="dwithin", distance=near
    )
    return bool((ends.reshape(-1, 2)[found] != of[:, None]).all(axis=1).any())


def _snapped(edges, given: np.ndarray, near: float):
    """Noded lines on a grid of `near` [m], where what nearly meets does meet; points that were given stay in place."""
    from scipy.spatial import KDTree
    from shapely import linestrings, unary_union

    steps = _steps(unary_union(edges, grid_size=near))
    away, which = KDTree(given).query(steps)
    steps = np.where((away < near)[..., None], given[which], steps)
    return unary_union(linestrings(steps[(steps[:, 0] != steps[:, 1]).any(axis=1)]))


def _steps(edges) -> np.ndarray:
    """All steps of lines. (k, 2, 2) [m]"""
    parts = [np.array(part.coords) for part in getattr(edges, "geoms", [edges])]
    return np.concatenate([np.stack([line[:-1], line[1:]], axis=1) for line in parts])


def _side_by_side(given: list[np.ndarray]) -> bool:
    """Whether two steps leave one point in one direction, or nearly."""
    a, b = (np.concatenate([line[k : len(line) - 1 + k] for line in given]) for k in (0, 1))
    origin, along = np.concatenate([a, b]), np.concatenate([b - a, a - b])
    angle = np.arctan2(along[:, 1], along[:, 0])
    order = np.lexsort((angle, origin[:, 1], origin[:, 0]))
    origin, angle = origin[order], angle[order]
    same = (origin[1:] == origin[:-1]).all(axis=1)
    first = np.flatnonzero(np.append(True, ~same))
    last = np.append(first[1:], len(order)) - 1
    around = angle[first] + 2 * np.pi - angle[last]
    return bool((np.diff(angle)[same] < PARALLEL).any() or (around < PARALLEL).any())


def _off_contours(edges, contours: list[np.ndarray], near: float):
    """Noded lines as single steps, without those that run wholly along a contour: they are that contour already."""
    from shapely import LineString, MultiLineString, covers, linestrings, points, prepare

    steps = _steps(edges)
    rims = _Chains(contours, closed=True)
    middle = points(steps.mean(axis=1))
    of, found = rims.tree.query(middle, predicate="dwithin", distance=near)
    along = np.zeros(len(steps), dtype=bool)
    for k in np.unique(rims.owner[found]).tolist():
        some = np.unique(of[rims.owner[found] == k])
        rim = LineString(np.vstack([contours[k], contours[k][:1]])).buffer(near)
        prepare(rim)
        along[some] |= covers(rim, linestrings(steps[some]))
    return MultiLineString(steps[~along].tolist())


def _opened(parts: tuple[np.ndarray, ...]):
    """Closed lines as two open ones, so that every line has two ends."""
    for part in parts:
        if (part[0] == part[-1]).all():
            middle = len(part) // 2
            yield part[: middle + 1]
            yield part[middle:]
        else:
            yield part
