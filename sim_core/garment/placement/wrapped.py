"""Cloth wrapped round the body: upright along a convex line about hips and waist, closed or lapped, without strain."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import ConvexHull, KDTree

from sim_core.cloth.sheet.sheet import face_edge_table
from sim_core.errors import SimCoreError
from sim_core.garment.pattern import Cloth, Pattern
from sim_core.garment.placement.ground import Ground
from sim_core.garment.placement.tent import Folds, Tent
from sim_core.mesh.geometry import line_girth

__all__ = ["Wrapped"]

FINE = 0.002  # [m] between the points of the line
LAPS = 1.02  # times the way round, from which cloth laps over itself
CLOSE = 1e-4  # [m] to which it is found how far off a line has to go round
ABOVE = 0.01  # [m] over the cloth's top, that it is drawn round as well
SLAB = 0.01  # [m] of the wearer that a line about it is drawn round at least
LEVELS = 33  # heights at which pleats are laid about a wearer that is wider below


@dataclass(frozen=True)
class Wrapped:
    """x of the pattern goes round, y down from the top edge.

    mark: landmark at whose height the top lies; rise [m] above it; begin [deg] about +y where x begins, 0 the front,
    90 the wearer's left; gap [m] between layers of cloth that goes round more than once.
    """

    mark: str = "waist"
    rise: float = 0.0
    begin: float = 180.0
    gap: float = 0.006

    halves = False  # `start` takes the whole of a mirrored pattern

    def hanging(self, cloth: Cloth) -> float:
        """The longest free length [m]."""
        return float(np.ptp(cloth.vertices[:, 1]))

    def start(self, pattern: Pattern, cloth: Cloth, ground: Ground, rng: np.random.Generator) -> np.ndarray:
        """Positions (P, 3) [m] of the pattern vertices. Raises SimCoreError where the cloth does not go round."""
        low, high = cloth.vertices.min(0), cloth.vertices.max(0)
        top = ground.top(self.mark, self.rise, self.hanging(cloth), pattern.name)
        lowest = top - self.hanging(cloth)
        begin, end = (cloth.closed[np.abs(cloth.vertices[:, 0] - x) < 1e-6] for x in (low[0], high[0]))
        closed = len(np.intersect1d(begin, end)) > 0  # sewn to itself: a tube
        room = ground.clearance + 0.002
        if any(panel.pleats for panel in pattern.panels):
            depths = np.linspace(0.0, float(high[1] - low[1]), LEVELS)
            hulls = [_section(ground, top - max(float(depth), SLAB), top) for depth in depths]
            folds = Folds.of(pattern, cloth)
            need = line_girth(hulls[0]) + 2 * np.pi * room
            _check_width(pattern, folds.width, need, self.mark)
            if closed or folds.width < LAPS * need:
                room += (folds.width - need) / (2 * np.pi)
            tent = Tent.over(hulls, depths, np.radians(self.begin), room)
            return tent.hung(folds, cloth.vertices[:, 1] - low[1], self.gap) + [0.0, top, 0.0]
        hull = _section(ground, lowest, top)
        width, girth = float(high[0] - low[0]), line_girth(hull)
        need = girth + 2 * np.pi * room
        _check_width(pattern, width, need, self.mark)
        if closed or width < LAPS * need:
            line = _around(hull, np.radians(self.begin), (width - girth) / (2 * np.pi), 0.0, width)
        else:
            widest = (width / LAPS - girth) / (2 * np.pi)  # further off it would not lap any more
            room = min(_off(hull, room, _longest(cloth), ground.clearance), widest)
            line = _around(hull, np.radians(self.begin), room, self.gap, width)
        arc = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))]
        along = (cloth.vertices[:, 0] - low[0]) * (arc[-1] / width)
        x, z = (np.interp(along, arc, line[:, c]) for c in range(2))
        return np.stack([x, top - (cloth.vertices[:, 1] - low[1]), z], axis=1)


def _check_width(pattern: Pattern, width: float, need: float, mark: str) -> None:
    """Raises SimCoreError unless cloth goes round once."""
    if width < need:
        raise SimCoreError(
            f"pattern {pattern.name}: {width:.3f} m wide – to go round the wearer below {mark!r} it needs "
            f"{need:.3f} m; make it wider or place it elsewhere"
        )


def _section(ground: Ground, low: float, high: float) -> np.ndarray:
    """Corners (n, 2) [m] in x and z of the convex hull of trunk, legs and garments between two heights, one way round
    from the front to the wearer's left."""
    worn = [
        _between(vertices, faces, _on_trunk(ground, vertices), low, high) for vertices, faces in ground.worn
    ]
    own = ground.vertices[ground.trunk]
    own = own[(own[:, 1] >= low) & (own[:, 1] <= high + ABOVE)]
    points = np.concatenate([own, *worn])
    if len(points) < 3:
        raise SimCoreError(
            f"place: nothing of the wearer between {low:.2f} and {high:.2f} m – choose another mark"
        )
    flat = points[:, [0, 2]]
    hull = flat[ConvexHull(flat).vertices]
    ahead = np.arctan2(hull[:, 0], hull[:, 1])
    hull = hull[np.argsort(ahead - ahead.min())]
    return hull


def _between(
    vertices: np.ndarray, faces: np.ndarray, counts: np.ndarray, low: float, high: float
) -> np.ndarray:
    """Points (n, 3) [m] of a mesh between two heights: vertices there that count (V,), and where edges cross either."""
    high += ABOVE
    y = vertices[:, 1]
    edges, _ = face_edge_table(faces)
    edges = edges[counts[edges].all(1)]
    found = [vertices[counts & (y >= low) & (y <= high)]]
    for height in (low, high):
        a, b = vertices[edges[(y[edges] < height).sum(1) == 1]].transpose(1, 0, 2)
        share = (height - a[:, 1]) / (b[:, 1] - a[:, 1])
        found.append(a + share[:, None] * (b - a))
    return np.concatenate(found)


def _longest(cloth: Cloth) -> float:
    """How far [m] an edge of its mesh goes along x at most."""
    x = cloth.vertices[cloth.faces, 0]
    return float(np.abs(x - np.roll(x, 1, axis=1)).max())


def _off(hull: np.ndarray, least: float, chord: float, clearance: float) -> float:
    """How far [m] off a convex hull (n, 2), at least, a line goes round whose chords [m] keep the clearance of it."""
    low, high = least, least + chord
    if _nearest(hull, low, chord) >= clearance:
        return low
    while high - low > CLOSE:
        middle = (low + high) / 2
        low, high = (low, middle) if _nearest(hull, middle, chord) >= clearance else (middle, high)
    return high


def _nearest(hull: np.ndarray, away: float, chord: float) -> float:
    """How near [m] chords of a line `away` [m] off a convex hull (n, 2) come to it; below 0 one cuts it."""
    line = _around(hull, 0.0, away, 0.0, np.inf)
    arc = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))]
    far = (arc[:-1] + chord) % arc[-1]
    begin, end = line[:-1], np.stack([np.interp(far, arc, line[:, c]) for c in range(2)], axis=1)
    across = (end - begin)[:, ::-1] * [1.0, -1.0]
    across /= np.maximum(np.linalg.norm(across, axis=1), 1e-12)[:, None]
    beside = np.einsum("nc,nmc->nm", across, begin[:, None] - hull[None])
    # The hull lies on one side of all of them, whichever way round it is.
    return float(beside.min() if beside.mean() > 0 else -beside.max())


def _on_trunk(ground: Ground, points: np.ndarray) -> np.ndarray:
    """Which (N,) of the points (N, 3) [m] of a garment lie nearer to the wearer's trunk and legs than to the arms."""
    nearest = KDTree(ground.vertices).query(points)[1]
    return np.isin(nearest, ground.trunk)


def _around(hull: np.ndarray, begin: float, away: float, gap: float, length: float) -> np.ndarray:
    """A line (n, 2) of `length` [m] round a convex hull (m, 2), `away` [m] off, `gap` [m] further off each turn.

    Points are told by the direction (sin, cos) they lie in from the hull, along its sides and round its corners.
    """
    sides = np.roll(hull, -1, axis=0) - hull
    normals = np.stack([-sides[:, 1], sides[:, 0]], axis=1) / np.linalg.norm(sides, axis=1)[:, None]
    if ((hull.mean(0) - hull) * normals).sum() > 0:
        normals = -normals
    points, outward = [], []
    for k in range(len(hull)):
        first, second = (float(np.arctan2(*normals[j])) for j in (k - 1, k))
        turn = (second - first) % (2 * np.pi)
        turn = turn if turn <= np.pi else turn - 2 * np.pi
        count = max(2, int(abs(turn) * max(away, 0.02) / FINE) + 1)
        angle = first + turn * np.linspace(0, 1, count)
        points.append(np.repeat(hull[k : k + 1], count, axis=0))
        outward.append(np.stack([np.sin(angle), np.cos(angle)], axis=1))
        steps = np.linspace(0, 1, int(np.linalg.norm(sides[k]) / FINE) + 2)[1:-1, None]
        points.append(hull[k] + steps * sides[k])
        outward.append(np.repeat(normals[k : k + 1], len(steps), axis=0))
    on, off = np.concatenate(points), np.concatenate(outward)
    middle = hull.mean(0)
    first = int(np.argmax((on - middle) @ np.array([np.sin(begin), np.cos(begin)])))
    on, off = np.roll(on, -first, axis=0), np.roll(off, -first, axis=0)
    line: list[np.ndarray] = []
    left, turns = length, 0
    while left > 0:
        spread = away + gap * (turns + np.arange(len(on)) / len(on))
        ring = on + spread[:, None] * off
        if not line or gap == 0.0:
            ring = np.concatenate([ring, on[:1] + (away + gap * (turns + 1)) * off[:1]])
        arc = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(ring, axis=0), axis=1))]
        kept = ring[arc < left]
        if arc[-1] >= left:
            end = [np.interp(left, arc, ring[:, c]) for c in range(2)]
            kept = np.concatenate([kept, [end]])
        line.append(kept[1:] if line else kept)
        left -= float(arc[-1])
        turns += 1
        if gap == 0.0:
            break
    return np.concatenate(line)
