"""Inner lines that meet at any angle, and how far a mesh of them is from what they make it be."""

from typing import NamedTuple

import numpy as np

from sim_core.mesh import PanelMesh, panel_mesh
from sim_core.mesh.improvement import small_angles
from sim_core.mesh.measures import quality

__all__ = [
    "EDGE",
    "Corners",
    "Panel",
    "Pair",
    "best_mesh",
    "branch",
    "bundle",
    "crossing_pairs",
    "measured",
    "touching",
]

EDGE = 0.02
SQUARE = np.array([[-0.1, -0.1], [0.1, -0.1], [0.1, 0.1], [-0.1, 0.1]])


class Panel(NamedTuple):
    """outline: (4, 2) [m].  lines: of (2 or 3, 2) [m]."""

    outline: np.ndarray
    lines: list[np.ndarray]


class Pair(NamedTuple):
    """Two of 500 lines that cross: their numbers, the angle between them [degrees], and the panel they are in."""

    names: tuple[int, int]
    angle: float
    panel: Panel


def random_lines(seed: int, count: int = 500, length: float = 0.04) -> np.ndarray:
    """Lines of one length in the unit square, in all directions. (count, 2, 2) [m]"""
    rng = np.random.default_rng(seed)
    begin, along = rng.uniform(0.03, 0.97, (count, 2)), rng.normal(size=(count, 2))
    along /= np.hypot(*along.T)[:, None]
    return np.stack([begin, begin + length * along], axis=1)


def crossing_pairs(seed: int) -> list[Pair]:
    """Every two of the random lines that cross, alone in a square of 0.2 m around them."""
    from shapely import STRtree, linestrings

    lines = random_lines(seed)
    drawn = np.asarray(linestrings(lines))
    one, other = STRtree(drawn).query(drawn, predicate="intersects")
    found = []
    for a, b in zip(one[one < other].tolist(), other[one < other].tolist(), strict=True):
        u, w = lines[a, 1] - lines[a, 0], lines[b, 1] - lines[b, 0]
        angle = np.degrees(np.arctan2(abs(u[0] * w[1] - u[1] * w[0]), abs(u @ w)))
        panel = Panel(SQUARE + lines[[a, b]].mean(axis=(0, 1)), [lines[a], lines[b]])
        found.append(Pair((a, b), float(angle), panel))
    return found


def bundle(seed: int, *, joined: bool) -> Panel:
    """Three to five lines through one point, some of them close together; joined: they hold the point."""
    rng = np.random.default_rng(seed)
    count, point = int(rng.integers(3, 6)), rng.random(2)
    angles = rng.random(count) * np.pi * rng.choice([1, 0.3, 0.1])
    lines = []
    for angle, (behind, ahead) in zip(angles, rng.uniform(0.005, 0.04, (count, 2)), strict=True):
        along = np.array([np.cos(angle), np.sin(angle)])
        ends = [point - behind * along, point + ahead * along]
        lines.append(np.array([ends[0], point, ends[1]] if joined else ends))
    return Panel(SQUARE + point, lines)


def branch(seed: int) -> Panel:
    """Three or four lines from one point, none nearer to the next than 60 degrees."""
    rng = np.random.default_rng(seed)
    count, point = int(rng.integers(3, 5)), rng.random(2)
    gaps = 60 + (360 - 60 * count) * rng.dirichlet(np.ones(count))
    angles = np.radians(np.cumsum(gaps)) + rng.random()
    ways = np.column_stack([np.cos(angles), np.sin(angles)])
    return Panel(SQUARE + point, [np.array([point, point + rng.uniform(0.003, 0.04) * way]) for way in ways])


def touching(seed: int) -> Panel:
    """One to three lines that end on the outline, at half a degree or more, some at one point; they may cross."""
    rng = np.random.default_rng(seed)
    lines = []
    for angle in np.radians(10 ** rng.uniform(-0.3, np.log10(150), int(rng.integers(1, 4)))):
        foot = np.array([rng.uniform(-0.03, 0.03) if rng.random() < 0.5 else 0.0, -0.1])
        lines.append(
            np.array([foot, foot + rng.uniform(0.01, 0.05) * np.array([np.cos(angle), np.sin(angle)])])
        )
    return Panel(SQUARE, lines)


class Corners(NamedTuple):
    """What is small in a mesh beside what its lines make small.

    vertices: how many.  side: shortest [m].  feature: the least distance [m] of an end or crossing of lines from a line
    that it is not on.  own: [degrees] the least angle between two lines.  small: faces with an angle below 30 degrees
    that is none of the lines' own.  least: the smallest of those [degrees], 90 where none is; beside: by the angle of
    the corner it lies at.  crowd: most of them at one corner.  astray: those at no corner below 60 degrees.
    """

    vertices: int
    side: float
    feature: float
    own: float
    small: int
    least: float
    beside: float
    crowd: int
    astray: int


def best_mesh(panel: Panel, edge: float = EDGE) -> PanelMesh:
    return panel_mesh(panel.outline, edge=edge, constraints=panel.lines, quality="best")


def fixed_steps(mesh: PanelMesh) -> np.ndarray:
    around = [np.column_stack([loop, np.roll(loop, -1)]) for loop in mesh.boundary]
    return np.concatenate([*around, *(np.column_stack([line[:-1], line[1:]]) for line in mesh.lines)])


def measured(panel: Panel, mesh: PanelMesh) -> Corners:
    places, steps = mesh.vertices, fixed_steps(mesh)
    sides = places[mesh.faces] - np.roll(places[mesh.faces], 1, axis=1)
    small = small_angles(places, mesh.faces, steps)
    angle = quality(places, mesh.faces).min_angle
    corner, own, reach = narrow_corners(places, steps)
    crowd, beside, astray = np.zeros(len(corner), int), np.inf, 0
    for face in np.flatnonzero(small):
        away = np.hypot(*(places[mesh.faces[face]][:, None] - places[corner]).transpose(2, 0, 1)).min(axis=0)
        near = np.flatnonzero(away <= reach)
        astray += len(near) == 0
        if len(near):
            which = near[own[near].argmin()]
            crowd[which] += 1
            beside = min(beside, angle[face] / own[which])
    return Corners(
        len(places),
        float(np.hypot(sides[..., 0], sides[..., 1]).min()),
        least_feature(panel, mesh),
        float(own.min()) if len(own) else 90.0,
        int(small.sum()),
        float(angle[small].min()) if small.any() else 90.0,
        float(beside),
        int(crowd.max()) if len(crowd) else 0,
        int(astray),
    )


def narrow_corners(places: np.ndarray, steps: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points where steps meet at less than 60 degrees, the least such angle [degrees], and twice the length [m] of the
    longest step that ends there."""
    around: dict[int, list[int]] = {}
    for a, b in steps.tolist():
        around.setdefault(a, []).append(b)
        around.setdefault(b, []).append(a)
    found = []
    for v, others in around.items():
        along = places[others] - places[v]
        angle = np.sort(np.arctan2(along[:, 1], along[:, 0]))
        gaps = np.diff(np.append(angle, angle[0] + 2 * np.pi))
        if gaps.min() < np.radians(60):
            found.append((v, np.degrees(gaps.min()), np.hypot(*along.T).max()))
    if not found:
        return np.zeros(0, int), np.zeros(0), np.zeros(0)
    corner, own, reach = zip(*found, strict=True)
    return np.array(corner), np.array(own), 2 * np.array(reach)


def least_feature(panel: Panel, mesh: PanelMesh) -> float:
    """The least distance [m] of an end or crossing of lines, or a corner of the outline, from a line it is not on."""
    from shapely import distance, linestrings, points

    lines = [mesh.vertices[line[[0, -1]]] for line in mesh.lines]  # all are straight
    steps = np.array([*lines, *np.stack([panel.outline, np.roll(panel.outline, -1, axis=0)], axis=1)])
    ends = np.unique(steps.reshape(-1, 2), axis=0)
    away = distance(np.asarray(points(ends))[:, None], np.asarray(linestrings(steps)))
    return float(away[away > 1e-9].min())
