"""What is drawn on a pattern sheet before anyone says what it is: lines with the names that stand around them."""

from collections import Counter
from dataclasses import dataclass, field, replace

import numpy as np
import shapely
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

__all__ = ["MOST_VISITED", "Drawn", "Stroke", "joined", "visited"]

Chain = tuple[int, np.ndarray, bool]  # its first line's number, points, whether it came back to its start
NEAR = 1e-6  # of the drawing's extent: ends this near are joined
MOST_VISITED = 200_000  # elements, those of blocks and uses each time they are drawn


@dataclass(frozen=True)
class Stroke:
    """One line of a drawing.

    points: (n, 2) [m], y down; n = 1 is a mark.  closed: the first point is not repeated.  layer: the DXF layer, or
    the SVG class.  groups: names of the groups or the block around it, outermost first.  words: what its classes,
    names and layers say, lower case.  filled: an area without a line
    around it.  dashed: not drawn through.  name: its own.
    """

    points: np.ndarray
    closed: bool
    layer: str = ""
    groups: tuple[str, ...] = ()
    words: tuple[str, ...] = ()
    filled: bool = False
    dashed: bool = False
    name: str = ""


@dataclass(frozen=True)
class Drawn:
    """What a reader found: lines, what it left out (name: how often); remarks and notes as in `Sheet`."""

    strokes: list[Stroke]
    left_out: Counter[str] = field(default_factory=Counter)
    remarks: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()


def joined(drawn: list[Stroke], remarks: list[str]) -> list[Stroke]:
    """Open lines of one layer and group joined end to end where only two ends meet; what comes back is closed.

    A line that hangs free at its other end does not count where it meets a joint: it is an inner line. Where more ends
    meet, lines that lead around all the others are an outline, and the others inner lines, which a remark says.
    """
    if not drawn or not all(np.isfinite(stroke.points).all() for stroke in drawn):
        return drawn
    near = NEAR * float(np.ptp(np.concatenate([stroke.points for stroke in drawn]), axis=0).max())
    found = [(k, stroke) for k, stroke in enumerate(drawn) if stroke.closed or len(stroke.points) == 1]
    open_ones: dict[tuple, list[int]] = {}
    for k, stroke in enumerate(drawn):
        if not stroke.closed and np.ptp(stroke.points, axis=0).max() > near:
            key = (stroke.groups, stroke.layer, stroke.words, stroke.dashed, stroke.filled)
            open_ones.setdefault(key, []).append(k)
    for places in open_ones.values():
        ends = _chains([drawn[k].points for k in places], near)
        chains = _around(ends, near)
        if sum(chain[2] for chain in chains) > sum(chain[2] for chain in ends):
            remarks.append(
                f"{drawn[places[0]].layer or 'drawing'}: three and more lines meet in a point – the outermost are "
                "taken for outlines, the others for inner lines"
            )
        for first, points, closed in chains:
            found.append((places[first], replace(drawn[places[first]], points=points, closed=closed)))
    return [stroke for _, stroke in sorted(found, key=lambda pair: pair[0])]


def _chains(rest: list[np.ndarray], near: float) -> list[Chain]:
    """The chains of open lines."""
    mate = _mates(rest, near)
    done: set[int] = set()
    found = []
    for k in range(len(rest)):
        if k in done:
            continue
        begin = 2 * k  # ends are numbered 2 k and 2 k + 1: back to where this chain begins, or once around
        while mate[begin] >= 0 and mate[begin] ^ 1 != 2 * k:
            begin = mate[begin] ^ 1
        parts, end = [], begin
        while end >= 0 and end // 2 not in done:
            done.add(end // 2)
            part = rest[end // 2][:: -1 if end % 2 else 1]
            parts.append(part[1:] if parts else part)
            end = mate[end ^ 1]
        line = np.vstack(parts)
        closed = len(line) > 3 and bool(np.hypot(*(line[0] - line[-1])) <= near)
        found.append((k, line[:-1] if closed else line, closed))
    return found


def _around(chains: list[Chain], near: float) -> list[Chain]:
    """Chains that end where three or more do: those with a face on one side only become an outline."""
    open_ones = [chain for chain in chains if not chain[2]]
    if len(open_ones) < 3:
        return chains
    ends = np.array([points[k] for _, points, _ in open_ones for k in (0, -1)])
    pairs = KDTree(ends).query_pairs(near, output_type="ndarray")
    joints, joint = _parts(len(ends), pairs)
    if np.bincount(joint).max() < 3:
        return chains
    _, net = _parts(joints, joint.reshape(-1, 2))
    _, first = np.unique(joint, return_index=True)
    nets: dict[int, list[Chain]] = {}
    for k, (number, points, _) in enumerate(open_ones):
        points = points.copy()
        points[[0, -1]] = ends[first[joint[2 * k : 2 * k + 2]]]
        nets.setdefault(int(net[joint[2 * k]]), []).append((number, points, False))
    return [chain for chain in chains if chain[2]] + [
        c for some in nets.values() for c in _outlined(some, near)
    ]


def _parts(count: int, pairs: np.ndarray) -> tuple[int, np.ndarray]:
    """How many parts so many things make that hang together in pairs, and the part of each."""
    graph = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(count, count))
    return connected_components(graph, directed=False)


def _outlined(net: list[Chain], near: float) -> list[Chain]:
    """Chains that hang together, those around all their faces made one; as they are where that is not plain: where
    they cross, are drawn twice or make no faces, nobody can say which line is whose."""
    lines = np.array([shapely.LineString(points) for _, points, _ in net])
    middles = np.array([points[(n := len(points) // 2) - 1 : n + 1].mean(axis=0) for _, points, _ in net])
    faces = shapely.get_parts(shapely.polygonize(lines))
    if not len(faces) or KDTree(middles).query_pairs(near):
        return net
    if shapely.STRtree(lines).query(lines, predicate="crosses").size or not shapely.is_valid(faces).all():
        return net
    whole = shapely.union_all(faces)
    rims = [shapely.get_coordinates(ring)[:-1] for ring in shapely.get_rings(shapely.get_parts(whole))]
    halves = np.asarray(shapely.points(middles))
    on_rim = np.asarray(shapely.dwithin(shapely.boundary(whole), halves, near))
    numbers = [number for number, _, _ in net]
    outer = [(_nearest(halves, on_rim, numbers, rim), rim, True) for rim in rims]
    return outer + [chain for chain, out in zip(net, on_rim, strict=True) if not out]


def _nearest(halves: np.ndarray, on_rim: np.ndarray, numbers: list[int], rim: np.ndarray) -> int:
    """The number of a line that lies on a rim, by a point of each line."""
    far = np.where(on_rim, shapely.distance(shapely.LinearRing(rim), halves), np.inf)
    return numbers[int(np.argmin(far))]


def _mates(lines: list[np.ndarray], near: float) -> list[int]:
    """For both ends of each line the one other end that it meets, or -1."""
    ends = np.array([line[k] for line in lines for k in (0, -1)])
    pairs = KDTree(ends).query_pairs(near, output_type="ndarray")
    meets = np.bincount(pairs.ravel(), minlength=len(ends))
    other = np.arange(len(ends)) ^ 1
    hangs = (meets > 1) & (meets[other] == 0)
    pairs = pairs[~hangs[pairs].any(axis=1)]
    meets = np.bincount(pairs.ravel(), minlength=len(ends))
    pairs = pairs[(meets[pairs] == 1).all(axis=1)]
    mate = np.full(len(ends), -1)
    mate[pairs] = pairs[:, ::-1]
    return mate.tolist()


def visited(before: int) -> int:
    """One element more; raises ValueError where a drawing multiplies itself beyond bearing."""
    if before >= MOST_VISITED:
        raise ValueError(f"it draws more than {MOST_VISITED} elements")
    return before + 1
