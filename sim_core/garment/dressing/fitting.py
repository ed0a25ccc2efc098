"""Whether cloth can go where an outfit wants it: refused before anything runs, naming layer, key and remedy."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra
from scipy.spatial import ConvexHull

from sim_core.body import Figure, Pose
from sim_core.errors import SimCoreError
from sim_core.garment.dressing.course import Moves, courses
from sim_core.garment.dressing.places import nearest
from sim_core.garment.outfit import Layer, Outfit
from sim_core.garment.pattern import Cloth
from sim_core.garment.placement import Flat

__all__ = ["check_fits"]

BESIDE = 0.02  # [m] above and below a tie that its girth is taken from
ROOM = 0.01  # [m] more than the girth of what passes an opening


def check_fits(outfit: Outfit) -> None:
    """Raises SimCoreError where a pose is beyond a joint's limit, layers cannot be dressed one over the other, an
    opening is narrower than the limb that must pass it, or a tie is shorter than the girth it goes round."""
    ways = []
    for number, layer in enumerate(outfit.layers, 1):
        key = f"outfit {outfit.name}: layer {number} ({layer.name})"
        _, moves = courses(layer, outfit.pose)
        if outfit.wearer is not None:
            for pose in moves.poses:
                pose.check()
        way = _way(layer, outfit, moves)
        if way[-1] != outfit.pose:
            raise SimCoreError(
                f"{key}: its steps leave the wearer in another pose than the outfit's, in which everything is shown – "
                "leave `pose` out of its last pose step, or change the outfit's"
            )
        if number > 1 and len(way) > 1 and any(other != way for other in ways):
            raise SimCoreError(
                f"{key}: it is dressed while the wearer moves, over a layer that was not dressed on the same way "
                "from pose to pose – give both the same pose steps, or place it along_path or wrapped"
            )
        ways.append(way)
        if isinstance(layer.place, Flat) and outfit.wearer is not None:
            figure = Figure(outfit.wearer)
            body, _ = figure.mesh(moves.poses[0])
            _check_openings(key, layer, body)
            _check_ties(key, layer, body, figure.trunk())


def _way(layer: Layer, outfit: Outfit, moves: Moves) -> tuple[Pose, ...]:
    """The poses a wearer goes through while the layer is dressed, one where the wearer stands."""
    ends = [step.pose or outfit.pose for step in layer.program.steps if step.do == "pose"]
    return moves.poses[0], *ends


def _check_ties(key: str, layer: Layer, body: np.ndarray, trunk: np.ndarray) -> None:
    """With every tie closed the cloth and the tie must reach round the trunk at the tie's height."""
    pattern, place = layer.pattern, layer.place
    if not pattern.ties or not isinstance(place, Flat):
        return
    cut, cloth = layer.cut, layer.cloth
    ways = _ways(cloth)
    top = float(body[np.abs(body[:, 0]) > 0.1, 1].max())  # the shoulders
    for tie in pattern.ties:
        ends = [nearest(cloth, cut, spot) for spot in (tie.a, tie.b)]
        if any(len(end) != 1 for end in ends):
            continue  # of both sides at once: it goes round nothing
        (a,), (b,) = ends
        cloth_way = float(dijkstra(ways, directed=False, indices=int(cloth.closed[a]))[cloth.closed[b]])
        height = top - float(np.mean([tie.a.place[1], tie.b.place[1]]))
        near = body[trunk][np.abs(body[trunk, 1] - height) < BESIDE]
        girth, reach = _hull_girth(near[:, [0, 2]]), cloth_way + tie.length
        if np.isfinite(cloth_way) and reach < girth:
            raise SimCoreError(
                f"{key}: tie {tie.name!r} and the cloth between its ends are {100 * reach:.1f} cm, the girth they go "
                f"round {100 * girth:.1f} cm – make it {100 * (girth - reach):.1f} cm longer, or move its ends"
            )


def _ways(cloth: Cloth) -> csr_array:
    """Lengths [m] of the edges between the vertices of the closed cloth."""
    pairs = cloth.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    length = np.linalg.norm(cloth.vertices[pairs[:, 0]] - cloth.vertices[pairs[:, 1]], axis=1)
    ends, first = np.unique(np.sort(cloth.closed[pairs], axis=1), axis=0, return_index=True)
    count = int(cloth.closed.max()) + 1
    return csr_array((length[first], (ends[:, 0], ends[:, 1])), (count, count))


def _check_openings(key: str, layer: Layer, body: np.ndarray) -> None:
    """Cuffs must let pass what is beyond them of the arm, a closed neck the neck."""
    cloth = layer.cloth
    reach = float(np.abs(body[:, 0]).max())
    for loop, length in _openings(cloth):
        points = cloth.vertices[loop]
        x, y = points[:, 0], points[:, 1]
        across = float(np.ptp(x))
        if across < 0.35 * float(np.ptp(y)) and np.abs(x).min() > 0.15:  # it lies across an arm
            at = float(np.abs(x).min())
            if at < reach:
                beyond = body[np.sign(x.mean()) * body[:, 0] >= at]
                _check_girth(key, "sleeve", length, _hull_girth(beyond[:, [1, 2]]))
        elif abs(float(x.mean())) < 0.02 and across < 0.5 and float(np.abs(y).max()) < 0.5:
            neck = body[body[:, 1] > body[:, 1].max() - 0.05]
            _check_girth(key, "neck hole", length, _hull_girth(neck[:, [0, 2]]))


def _check_girth(key: str, what: str, opening: float, girth: float) -> None:
    if opening < girth + ROOM:
        raise SimCoreError(
            f"{key}: its {what} is {100 * opening:.1f} cm round, what must pass it {100 * girth:.1f} cm – make it "
            f"at least {100 * (girth + ROOM):.1f} cm"
        )


def _hull_girth(points: np.ndarray) -> float:
    if len(points) < 3:
        return 0.0
    ring = points[ConvexHull(points).vertices]
    return float(np.linalg.norm(ring - np.roll(ring, 1, axis=0), axis=1).sum())


def _openings(cloth: Cloth) -> list[tuple[np.ndarray, float]]:
    """Border loops of the closed cloth, as pattern vertices in order, and their lengths [m].

    Where a loop crosses a seam it leaps in the pattern, not in the cloth: lengths are those of the faces' own edges.
    """
    faces = cloth.closed[cloth.faces]
    ahead = faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2).astype(np.int64)
    own = cloth.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    count = int(cloth.closed.max()) + 1
    free = ~np.isin(ahead[:, 0] * count + ahead[:, 1], ahead[:, 1] * count + ahead[:, 0])
    sides = np.linalg.norm(cloth.vertices[own[free, 0]] - cloth.vertices[own[free, 1]], axis=1)
    following = {
        int(a): (int(b), int(vertex), float(side))
        for (a, b), vertex, side in zip(ahead[free], own[free, 0], sides, strict=True)
    }
    loops = []
    while following:
        first, (at, vertex, length) = next(iter(following.items()))
        del following[first]
        loop = [vertex]
        while at != first and at in following:
            at, vertex, side = following.pop(at)
            loop.append(vertex)
            length += side
        loops.append((np.array(loop), length))
    return loops
