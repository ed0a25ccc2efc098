"""Open lines of a drawing joined end to end: a program may draw an outline as hundreds of them.

Ends that meet are found as parts that hang together, so that any number of lines may meet in one point.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import shapely
from scipy.spatial import KDTree

from sim_core.mesh.outline.crossings import crossed_steps
from sim_core.mesh.sheets.strokes.stroke import Stroke
from sim_core.metrics import components

__all__ = ["joined"]

NEAR = 1e-6  # of the drawing's extent: ends this near are one place
ROUNDED = (
    5e-5  # [m] ends that rounding keeps apart, as a drawing in whole hundredths of a millimetre has them
)
DUST = 4  # times ROUNDED: lines shorter than that have both their ends in one place
CELLS = 4  # across NEAR: ends in one cell are one place at once
FEW = 300  # lines that are tried each with each


class _Chain(NamedTuple):
    """first: number of its first line.  points: (n, 2) [m].  closed: it came back to its start, not repeated."""

    first: int
    points: np.ndarray
    closed: bool


def joined(drawn: list[Stroke], remarks: list[str]) -> list[Stroke]:
    """Open lines of one layer and group joined end to end where only two ends meet; what comes back is closed.

    A line that hangs free at its other end does not count where it meets a joint: it is an inner line. Where more ends
    meet, lines that lead around all the others are an outline, and the others inner lines, which a remark says. What is
    open then is tried again with ends that miss each other by a rounding, which a remark says too.
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
    widest = 0.0
    for places in open_ones.values():
        lines = [_Chain(k, drawn[place].points, False) for k, place in enumerate(places)]
        ends, _ = _chains(lines, near)
        ends, gap = _second_try(ends, near)
        widest = max(widest, gap)
        chains = _around(ends, max(near, gap))
        if sum(chain.closed for chain in chains) > sum(chain.closed for chain in ends):
            remarks.append(
                f"{drawn[places[0]].layer or 'drawing'}: three and more lines meet in a point – the outermost are "
                "taken for outlines, the others for inner lines"
            )
        for first, points, closed in chains:
            found.append((places[first], replace(drawn[places[first]], points=points, closed=closed)))
    if widest:
        remarks.append(f"ends up to {1000 * widest:.2g} mm apart were joined")
    return [stroke for _, stroke in sorted(found, key=lambda pair: pair[0])]


def _second_try(chains: list[_Chain], near: float) -> tuple[list[_Chain], float]:
    """What is open joined where ends miss each other by a rounding, and the widest gap [m], 0 where there is none."""
    least = DUST * ROUNDED
    again = [c for c in chains if not c.closed and float(np.ptp(c.points, axis=0).max()) > least]
    if near >= ROUNDED or not again:
        return chains, 0.0
    made, gap = _chains(again, ROUNDED)
    if gap <= near:
        return chains, 0.0
    kept = {id(chain) for chain in again}
    return sorted([*(c for c in chains if id(c) not in kept), *made], key=lambda c: c.first), gap


def _chains(lines: list[_Chain], near: float) -> tuple[list[_Chain], float]:
    """The chains of open lines, and the widest gap [m] in them."""
    mate, gap = _mates([line.points for line in lines], near)
    done: set[int] = set()
    found = []
    for k in range(len(lines)):
        if k in done:
            continue
        begin = 2 * k  # ends are numbered 2 k and 2 k + 1: back to where this chain begins, or once around
        while mate[begin] >= 0 and mate[begin] ^ 1 != 2 * k:
            begin = mate[begin] ^ 1
        parts, end = [], begin
        while end >= 0 and end // 2 not in done:
            done.add(end // 2)
            part = lines[end // 2].points[:: -1 if end % 2 else 1]
            parts.append(part[1:] if parts else part)
            end = mate[end ^ 1]
        line = np.vstack(parts)
        back = mate[begin] >= 0 or bool(np.hypot(*(line[0] - line[-1])) <= near)
        closed = len(line) > 3 and back
        found.append(_Chain(lines[k].first, line[:-1] if closed else line, closed))
    return found, gap


def _mates(lines: list[np.ndarray], near: float) -> tuple[list[int], float]:
    """For both ends of each line the one other end that it meets, or -1; and how far such two are apart at most [m]."""
    ends = np.array([line[k] for line in lines for k in (0, -1)])
    joints, joint = _places(ends, near)
    meets = np.bincount(joint, minlength=joints)[joint] - 1
    hangs = (meets > 1) & (meets[np.arange(len(ends)) ^ 1] == 0)
    counted = np.where(hangs, joints, joint)
    pairs = (np.bincount(counted, minlength=joints + 1)[counted] == 2) & ~hangs
    one = np.flatnonzero(pairs)
    one = one[np.argsort(counted[one], kind="stable")].reshape(-1, 2)
    mate = np.full(len(ends), -1)
    mate[one] = one[:, ::-1]
    gaps = np.hypot(*(ends[one[:, 0]] - ends[one[:, 1]]).T)
    return mate.tolist(), float(gaps.max(initial=0.0))


def _places(ends: np.ndarray, near: float) -> tuple[int, np.ndarray]:
    """How many places ends (n, 2) lie in, those within `near` of each other in one, and the place of each (n,)."""
    if near <= 0:
        places, place = np.unique(ends, axis=0, return_inverse=True)
        return len(places), place.ravel()
    cells, cell = np.unique(np.rint(ends * (CELLS / near)), axis=0, return_inverse=True)
    pairs = KDTree(cells).query_pairs(CELLS, output_type="ndarray")
    place = components(len(cells), *pairs.T)
    return int(place.max(initial=-1)) + 1, place[cell.ravel()]


def _around(chains: list[_Chain], near: float) -> list[_Chain]:
    """Chains that end where three or more do: those with a face on one side only become an outline."""
    open_ones = [chain for chain in chains if not chain.closed]
    if len(open_ones) < 3:
        return chains
    ends = np.array([chain.points[k] for chain in open_ones for k in (0, -1)])
    joints, joint = _places(ends, near)
    if np.bincount(joint).max() < 3:
        return chains
    net = components(joints, *joint.reshape(-1, 2).T)
    _, first = np.unique(joint, return_index=True)
    nets: dict[int, list[_Chain]] = {}
    for k, chain in enumerate(open_ones):
        points = chain.points.copy()
        points[[0, -1]] = ends[first[joint[2 * k : 2 * k + 2]]]
        nets.setdefault(int(net[joint[2 * k]]), []).append(_Chain(chain.first, points, False))
    return [chain for chain in chains if chain.closed] + [
        c for some in nets.values() for c in _outlined(some, near)
    ]


def _outlined(net: list[_Chain], near: float) -> list[_Chain]:
    """Chains that hang together, those around all their faces made one; as they are where that is not plain: where
    they cross, are drawn twice or make no faces, nobody can say which line is whose."""
    lines = np.array([shapely.LineString(chain.points) for chain in net])
    middles = np.array(
        [chain.points[(n := len(chain.points) // 2) - 1 : n + 1].mean(axis=0) for chain in net]
    )
    faces = shapely.get_parts(shapely.polygonize(lines))
    if not len(faces) or _places(middles, near)[0] < len(middles):
        return net
    if _crossing(net, lines) or not shapely.is_valid(faces).all():
        return net
    whole = shapely.union_all(faces)
    rims = shapely.get_rings(shapely.get_parts(whole))
    halves = np.asarray(shapely.points(middles))
    shapely.prepare(edge := shapely.boundary(whole))
    on_rim = np.asarray(shapely.dwithin(edge, halves, near))
    lying = np.flatnonzero(on_rim)
    tree = shapely.STRtree(halves[lying])
    nearest = tree.query_nearest(rims, all_matches=False)[1]
    outer = [
        _Chain(net[lying[k]].first, shapely.get_coordinates(rim)[:-1], True)
        for rim, k in zip(rims, nearest.tolist(), strict=True)
    ]
    return outer + [chain for chain, out in zip(net, on_rim, strict=True) if not out]


def _crossing(net: list[_Chain], lines: np.ndarray) -> bool:
    """Whether lines cross each other. Of many only those are tried that meet anything but at their ends."""
    tried = lines
    if len(net) > FEW:
        crossed = crossed_steps([chain.points for chain in net])
        tried = lines[np.array([steps.any() for steps in crossed])]
        if len(tried) > FEW:
            return True  # nobody can say which line is whose
    return bool(shapely.STRtree(lines).query(tried, predicate="crosses").size)
