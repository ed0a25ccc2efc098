"""Whether cloth can go where an outfit wants it: refused before anything runs, naming file, key and remedy."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from sim_core.body import Figure, Pose
from sim_core.errors import SimCoreError
from sim_core.garment.dressing.course import Moves, courses
from sim_core.garment.dressing.places import nearest
from sim_core.garment.outfit import Layer, Outfit
from sim_core.garment.pattern import Cloth
from sim_core.garment.pattern.sections import sections
from sim_core.garment.placement import Flat, Ground, Wrapped
from sim_core.mesh.geometry import hull_girth

__all__ = ["check_fits", "first_positions"]

BESIDE = 0.02  # [m] above and below a tie that its girth is taken from
COLLAR = 0.1  # [m] from the shoulder fold, within which a tie goes round the neck and not round the trunk
ROOM = 0.01  # [m] more than the girth of what passes an opening
ARMPIT = 0.03  # [m] from where arms begin to where they are round
STATION = 0.01  # [m] between the sections that are measured
SLAB = 0.006  # [m] to both sides of a station from which the body's girth is taken


def check_fits(outfit: Outfit) -> None:
    """Raises SimCoreError where a pose is beyond a joint's limit, layers cannot be dressed one over the other, cloth
    does not lie as it is placed, a sleeve, body or neck is narrower than what it must go round, or a tie or belt is
    shorter than its girth.

    Wrapped layers go round those that are wrapped beneath them; how far a layer stands off that fell into its folds is
    known only when it has, and then `dress` tells.
    """
    ways: list[tuple[Pose, ...]] = []
    worn: list[tuple[np.ndarray, np.ndarray]] = []
    figure = Figure(outfit.wearer) if outfit.wearer is not None else None
    for number, layer in enumerate(outfit.layers):
        key = outfit.key(number)
        _, moves = courses(layer, outfit.pose)
        ways.append(_checked_way(key, layer, outfit, moves, ways))
        clearance = layer.program.contact.clearance
        ground = Ground(stand=outfit.stand, clearance=clearance, edge=layer.edge)
        if figure is not None:
            pose = moves.poses[0]
            marks, trunk = figure.mannequin.landmarks(pose), figure.trunk()
            around = tuple(worn) if isinstance(layer.place, Wrapped) else ()
            ground = replace(ground, marks=marks, trunk=trunk, worn=around)
            ground = replace(ground, **dict(zip(("vertices", "faces"), figure.mesh(pose), strict=True)))
        start = first_positions(key, layer, layer.cloth, ground)
        if isinstance(layer.place, Wrapped):
            worn.append((start, layer.cloth.faces))
        if figure is not None:
            _check_belts(key, layer, outfit.pose, figure)
        if isinstance(layer.place, Flat) and figure is not None:
            _check_neck(key, layer, ground.vertices)
            _check_sleeves(key, layer.cloth, start, ground)
            _check_trunk(key, layer.cloth, start, ground)
            _check_ties(key, layer, ground.vertices, ground.trunk)


def first_positions(key: str, layer: Layer, cloth: Cloth, ground: Ground) -> np.ndarray:
    """Positions (P, 3) [m] of the pattern vertices before anything is let go; cloth: the layer's whole one, or its cut.

    Raises SimCoreError beginning with `key` where it cannot be placed so.
    """
    place, rng = layer.place, np.random.default_rng(layer.seed)
    try:
        if cloth is layer.cut or not place.halves:
            return place.start(layer.pattern, cloth, ground, rng)
        if isinstance(place, Flat):
            return place.whole(layer.pattern, layer.cut, ground)
        own = place.start(layer.pattern, layer.cut, ground, rng)
    except SimCoreError as error:
        raise SimCoreError(f"{key}.place: {error}") from error
    return np.concatenate([own, own * [-1.0, 1.0, 1.0]])[layer.pattern.kept(layer.cut)]


def _checked_way(
    key: str, layer: Layer, outfit: Outfit, moves: Moves, ways: list[tuple[Pose, ...]]
) -> tuple[Pose, ...]:
    """The poses a wearer goes through while the layer is dressed, one where the wearer stands."""
    if outfit.wearer is not None:
        for pose in moves.poses:
            pose.check()
    ends = [step.pose or outfit.pose for step in layer.program.steps if step.do == "pose"]
    way = moves.poses[0], *ends
    if way[-1] != outfit.pose:
        raise SimCoreError(
            f"{key}.step: its steps leave the wearer in another pose than the outfit's, in which everything is shown – "
            "leave `pose` out of its last pose step, or change the outfit's"
        )
    if len(way) > 1 and any(other != way for other in ways):
        raise SimCoreError(
            f"{key}.step: it is dressed while the wearer moves, over a layer that was not dressed on the same way "
            'from pose to pose – give both the same pose steps (beneath one that is dressed flat, start = "t"), or '
            "place it along_path or wrapped"
        )
    return way


def _check_belts(key: str, layer: Layer, pose: Pose, figure: Figure) -> None:
    """A belt must reach round the wearer."""
    for number, step in enumerate(layer.program.steps, 1):
        if step.belt is None:
            continue
        height = float(figure.mannequin.landmarks(pose)[step.belt.mark][1]) + step.belt.rise
        told = f"{key}.{step.named(number)}.belt"
        girth = figure.girth(pose, height)
        if not girth:
            raise SimCoreError(
                f"{told}.rise: {100 * step.belt.rise:.1f} cm from the {step.belt.mark} there is "
                "nothing of the wearer to go round – bring it nearer"
            )
        if step.belt.length < girth + ROOM:
            raise SimCoreError(
                f"{told}.length: {100 * step.belt.length:.1f} cm, the wearer is {100 * girth:.1f} cm "
                f"round there – make it at least {100 * (girth + ROOM):.1f} cm"
            )


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
        fall = float(np.mean([tie.a.place[1], tie.b.place[1]]))
        if fall < COLLAR:
            continue  # it closes a collar: the neck has been measured
        height = top - fall
        near = body[trunk][np.abs(body[trunk, 1] - height) < BESIDE]
        girth, reach = hull_girth(near[:, [0, 2]]), cloth_way + tie.length
        if np.isfinite(cloth_way) and reach < girth:
            raise SimCoreError(
                f"{key}.pattern: tie {tie.name!r} and the cloth between its ends are {100 * reach:.1f} cm, the "
                f"girth they go round {100 * girth:.1f} cm – make it {100 * (girth - reach):.1f} cm longer, or "
                "move its ends"
            )


def _ways(cloth: Cloth) -> csr_array:
    """Lengths [m] of the edges between the vertices of the closed cloth."""
    pairs = cloth.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    length = np.linalg.norm(cloth.vertices[pairs[:, 0]] - cloth.vertices[pairs[:, 1]], axis=1)
    ends, first = np.unique(np.sort(cloth.closed[pairs], axis=1), axis=0, return_index=True)
    count = int(cloth.closed.max()) + 1
    return csr_array((length[first], (ends[:, 0], ends[:, 1])), (count, count))


def _check_neck(key: str, layer: Layer, body: np.ndarray) -> None:
    """A closed neck must let pass the neck."""
    cloth = layer.cloth
    for loop, length in _openings(cloth):
        points = cloth.vertices[loop]
        across = float(np.ptp(points[:, 0]))
        if (
            abs(float(points[:, 0].mean())) < 0.02
            and across < 0.5
            and float(np.abs(points[:, 1]).max()) < 0.5
        ):
            neck = body[body[:, 1] > body[:, 1].max() - 0.05]
            _check_girth(key, "its neck hole", length, hull_girth(neck[:, [0, 2]]))


def _check_sleeves(key: str, cloth: Cloth, start: np.ndarray, ground: Ground) -> None:
    """Wherever a sleeve is closed it must go round the arm there and let pass what is beyond it of arm and hand."""
    arms = np.setdiff1d(np.arange(len(ground.vertices)), ground.trunk)
    for side, which in ((1, "left"), (-1, "right")):
        arm = ground.vertices[arms][side * ground.vertices[arms, 0] > 0] * [side, 1.0, 1.0]
        root, tip = float(arm[:, 0].min()) + ARMPIT, float(arm[:, 0].max())
        passing, found = 0.0, []
        for at in np.arange(tip - STATION, root, -STATION):
            near = arm[np.abs(arm[:, 0] - at) < SLAB]
            passing = max(passing, hull_girth(near[:, [1, 2]]))
            height = float(near[:, 1].mean()) if len(near) else 0.0
            for section in sections(cloth, start, 0, side * float(at)):
                if section.high[1] > height:  # not what hangs lower, beside the body
                    where = f"its {which} sleeve, {100 * (at - root):.0f} cm from the armpit,"
                    found.append((section.length - passing, section.length, passing, where))
        _check_tightest(key, found)


def _check_trunk(key: str, cloth: Cloth, start: np.ndarray, ground: Ground) -> None:
    """Wherever a garment is closed about the body it must go round it there."""
    trunk = ground.vertices[ground.trunk]
    arms = np.setdiff1d(np.arange(len(ground.vertices)), ground.trunk)
    below, found = float(ground.vertices[arms, 1].min()) - STATION, []
    for at in np.arange(max(0.3, float(start[:, 1].min()) + 0.001), below, 2 * STATION):
        girth = hull_girth(trunk[np.abs(trunk[:, 1] - at) < SLAB][:, [0, 2]])
        for section in sections(cloth, start, 1, float(at)):
            if section.low[0] < 0.0 < section.high[0]:
                where = f"its body, {100 * at:.0f} cm above the floor,"
                found.append((section.length - girth, section.length, girth, where))
    _check_tightest(key, found)


def _check_tightest(key: str, found: list[tuple[float, float, float, str]]) -> None:
    """Of sections, each the room in it, its length, the girth [m] in it and where it is, the one with least room."""
    if found:
        _, wide, girth, where = min(found)
        _check_girth(key, where, wide, girth)


def _check_girth(key: str, what: str, wide: float, girth: float) -> None:
    if wide < girth + ROOM:
        raise SimCoreError(
            f"{key}.measures: {what} is {100 * wide:.1f} cm round, what it must go round or let pass "
            f"{100 * girth:.1f} cm – make it at least {100 * (girth + ROOM):.1f} cm"
        )


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
