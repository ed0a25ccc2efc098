"""A figure as what cloth meets: whole fields and half ones, motions, and a floor beside a figure that moves."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sim_core import metrics
from sim_core.body import HANDS, JOINTS, POSES, Figure, Mannequin, Pose, pose_named
from sim_core.body.making import section
from sim_core.cloth import Contact, HalfSpace, Material, MovingGrid, Phase, Sheet, drape, moving_mesh
from sim_core.cloth.contact import (
    DistanceField,
    GridSdf,
    Union,
    closed,
    distances,
    field_of,
    hull_mesh,
    united,
)
from sim_core.cloth.step import FRAME
from sim_core.errors import SimCoreError

WOMAN = Path(__file__).parents[2] / "assets" / "mannequins" / "woman.npz"
CELL = 0.015
EXACT = 2.4 * CELL - HANDS  # [m] up to which distances to the nearest face are the nearest
FLOOR = HalfSpace()


@pytest.fixture(scope="module")
def figure() -> Figure:
    return Figure(Mannequin.load(WOMAN), CELL)


@pytest.mark.parametrize("pose", ["display", "held"])
def test_the_fields_cells_round_no_finger_off(pose: str) -> None:
    """Cloth is kept out of the field, and is seen beside the mesh."""
    beneath = Figure(Mannequin.load(WOMAN)).beneath(pose_named(pose))
    (surface,), field = beneath.surfaces, beneath.field()
    for hand in surface.hulls:
        assert field.at(surface.vertices[hand]).max() < 5e-4


def test_the_whole_field_holds_both_hands_as_hulls(figure: Figure) -> None:
    pose = POSES["held"][0]
    vertices, faces = figure.mesh(pose)
    field = figure.field(pose)
    for side in "lr":
        hand = vertices[figure.mannequin.weights[:, JOINTS.index(f"wrist_{side}")] > 0.5]
        rng = np.random.default_rng(2)
        share = rng.dirichlet(np.ones(len(hand)), 300)
        assert field.at(share @ hand).max() < 0.5 * CELL  # within the hull, fingers or not
    low, high = field.box()
    assert (low < vertices.min(0)).all()
    assert (high > vertices.max(0)).all()
    skin = field.at(vertices)
    assert skin.max() < 0.6 * CELL


def test_the_half_is_that_part_of_the_whole(figure: Figure) -> None:
    pose = POSES["display"][0]
    whole, half = figure.field(pose), figure.field(pose, half=True)
    assert half.values.size < 0.6 * whole.values.size
    vertices, _ = figure.mesh(pose)
    points = vertices[vertices[:, 0] > 0.02]
    assert np.abs(half.at(points) - whole.at(points)).max() < 0.5 * CELL
    assert half.box()[0][0] == pytest.approx(-2 * CELL)


def test_all_fields_of_a_figure_share_their_nodes(figure: Figure) -> None:
    """What was draped on the half that moves goes on lying on the whole that stands: equal values, mirrored too."""
    poses = [POSES["t"][0], POSES["display"][0]]
    whole, half = figure.beneath(poses[1]).field(), figure.moving(poses, half=True)
    for corner in (whole.origin, half.origin):
        cells = np.array(corner) / CELL
        assert np.abs(cells - np.round(cells)).max() < 1e-9
    first = np.round((np.array(half.origin) - whole.origin) / CELL).astype(int)
    values = half.key(1)
    own = tuple(slice(max(k, 0), k + n) for k, n in zip(first, values.shape, strict=True))
    shared = whole.values[own]
    values = values[
        tuple(slice(max(-k, 0), max(-k, 0) + n) for k, n in zip(first, shared.shape, strict=True))
    ]
    near = np.abs(shared) < EXACT
    assert near.sum() > 1000
    assert np.abs(shared - values)[near].max() < 1e-6
    middle = round(-whole.origin[0] / CELL)
    left, right = whole.values[middle:], whole.values[middle::-1]
    count = min(len(left), len(right))
    near = np.abs(left[:count]) < EXACT
    assert np.abs(left[:count] - right[:count])[near].max() < 1.2e-4  # as the mesh is mirrored


def test_a_motion_is_a_key_a_pose_and_carries_what_lies_on_it(figure: Figure) -> None:
    poses = [Pose().towards(POSES["display"][0], share) for share in (0.0, 0.02, 0.04)]
    body = figure.moving(poses, half=True)
    assert body.count == 3
    vertices, faces = figure.mesh(poses[2])
    hand = vertices[np.unique(figure.hands()[0])]
    box = (np.array(body.origin), body.origin + CELL * (np.array(body.key(2).shape) - 1))
    meshes = (vertices, faces), hull_mesh(hand)
    own, hull = (field_of(*mesh, cell=CELL, band=0.04, box=box, far=False) for mesh in meshes)
    alone = united(own, hull, thicker=HANDS)
    exact = np.abs(alone.values) < EXACT  # further off the faces are handed on, the hull's in another order
    assert np.abs(alone.values - body.key(2))[exact].max() < 1e-6
    assert body.surface is not None
    nearest, corners = body.surface(2)
    assert nearest.shape == alone.values.shape
    assert len(corners) == len(faces) + len(figure.hands()[0])
    assert nearest.max() >= len(faces)  # of the hull too
    assert figure.name != Figure(figure.mannequin, 0.02).name
    with pytest.raises(SimCoreError, match="no poses"):
        figure.moving([])
    with pytest.raises(SimCoreError, match="elbow_l turned"):
        figure.moving([Pose.from_rotvecs({"elbow_l": (0.0, 60.0, 0.0)})])


# A floor beside a moving body.


def _block(x: float) -> np.ndarray:
    """Corners (8, 3) of a block 0.2 m wide whose lower side is 2 mm above the floor, its middle at x [m]."""
    return np.array([[x + a, b, c] for a in (-0.1, 0.1) for b in (0.002, 0.2) for c in (-0.2, 0.2)])


BLOCK = np.array(
    [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6]]
    + [[0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]],
    np.int32,
)


def _going(frames: int, speed: float, beside: HalfSpace | None) -> MovingGrid:
    way = speed * FRAME * np.arange(frames + 1)
    return moving_mesh(np.stack([_block(x) for x in way]), BLOCK, cell=0.01, beside=beside)


def test_body_and_floor_are_one_solid_with_exact_distance() -> None:
    body = _going(2, 0.5, FLOOR)
    points = np.random.default_rng(3).uniform([-0.5, -0.1, -0.4], [0.5, 0.4, 0.4], (500, 3))
    alone = GridSdf(body.origin, body.cell, body.key(1))
    expected = np.minimum(alone.distance(points), points[:, 1])
    assert np.abs(body.solid(1).distance(points) - expected).max() < 1e-12
    packed, (early, late) = body.packed(0.5, 0.75)
    between = distances(packed._replace(blend=np.array([early, 1.0])), points)
    first, second = (GridSdf(body.origin, body.cell, body.key(k)).distance(points) for k in (0, 1))
    assert np.abs(between - np.minimum(0.5 * first + 0.5 * second, points[:, 1])).max() < 1e-6
    assert late == 0.75


@pytest.mark.parametrize("beside", [3.0, Union((GridSdf((0, 0, 0), 1.0, np.ones((2, 2, 2))),))])
def test_what_cannot_stand_beside_a_body_is_refused(beside: object) -> None:
    with pytest.raises(SimCoreError, match=r"body\.beside"):
        MovingGrid((0.0, 0.0, 0.0), 1.0, 1, lambda k: np.ones((2, 2, 2)), beside=beside)  # type: ignore[arg-type]


def _square(edge: float, side: float) -> tuple[Sheet, np.ndarray]:
    count = round(side / edge) + 1
    grid = np.stack(np.meshgrid(*[np.linspace(0, side, count)] * 2, indexing="ij"), -1).reshape(-1, 2)
    at = np.arange(count * count).reshape(count, count)
    a, b, c, d = (part.ravel() for part in (at[:-1, :-1], at[1:, :-1], at[:-1, 1:], at[1:, 1:]))
    faces = np.concatenate([np.stack([a, b, d], 1), np.stack([a, d, c], 1)]).astype(np.int32)
    return Sheet.of(grid, faces, Material(0.2, 200.0, 0.3, 1e-4, 0.5)), grid


def test_cloth_on_the_floor_is_not_carried_by_a_body_that_passes_it() -> None:
    """It lies 15 mm beside the block, within the block's field: what it rests on is the floor, which stands still."""
    frames, clearance = 10, Contact().clearance
    sheet, flat = _square(0.03, 0.15)
    start = np.column_stack([flat[:, 0], np.full(len(flat), clearance), 0.215 + flat[:, 1]])
    phase = Phase(frames * FRAME, body=(0.0, float(frames)))
    end = drape(sheet, start, [phase], collider=_going(frames, 0.5, FLOOR)).positions
    assert np.abs(end - start).max() < 1e-4


@pytest.mark.parametrize("height", [0.01, 0.014])
def test_a_body_comes_upon_cloth_that_hovers_over_the_floor(height: float) -> None:
    """The floor is nearest, which stands still, until the block is there: at 100 mm a frame, whoever waits is hit."""
    (sheet, flat), body = _square(0.01, 0.01), _going(1, 2.5, FLOOR)
    for ahead in np.linspace(0.18, 0.1995, 14):
        start = np.column_stack([ahead + flat[:, 0], np.full(len(flat), height), flat[:, 1]])
        end = drape(sheet, start, [Phase(FRAME, (0.0, 0.0), body=(0.0, 1.0))], collider=body)
        assert body.solid(1).distance(end.positions).min() > 0.0, ahead


def test_a_garment_beneath_reaches_beyond_its_mesh_everywhere_in_the_field() -> None:
    """A hull that is 25 mm thicker lies beside the body: the fields end 30 mm from the thick one, not from its mesh."""
    vertices = np.concatenate([_block(0.0), _block(0.5)])
    body = moving_mesh(vertices[None], BLOCK, cell=0.01, band=0.03, hulls=[BLOCK + 8], thicker=[0.025])
    solid = body.solid(0)
    for out in (0.03, 0.035, 0.04, 0.045, 0.05):
        at = np.array([[0.4 - out, 0.1, 0.0]])
        assert solid.distance(at)[0] == pytest.approx(out - 0.025, abs=1e-3)


def _skirt(figure: Figure, floor: float) -> tuple[np.ndarray, np.ndarray]:
    """A cone from round the waist to the floor, its hem lying on it: vertices (V, 3) [m], faces (F, 3)."""
    vertices, faces = figure.mesh(Pose())
    waist = float(figure.mannequin.marks["waist"][1])
    around = section(vertices, faces, waist)
    around = around[np.abs(around[:, 0]) < 0.3]
    middle = (around[:, 1].min() + around[:, 1].max()) / 2
    wide, deep = np.ptp(around, axis=0) / 2 + 0.012
    down = np.linspace(0.0, 1.0, 24)
    rings = [
        (wide + t * (0.5 - wide), deep + t * (0.5 - deep), waist + t * (floor - waist), middle * (1 - t))
        for t in down
    ]
    rings += [(0.5 + out, 0.5 + out, floor, 0.0) for out in (0.04, 0.08, 0.12, 0.16)]
    angle = np.linspace(0.0, 2 * np.pi, 64, endpoint=False)
    points = [np.stack([a * np.sin(angle), np.full(64, y), z + b * np.cos(angle)], 1) for a, b, y, z in rings]
    i = np.arange(len(rings) * 64).reshape(len(rings), 64)
    a, b, c, d = (p.ravel() for p in (i[:-1], np.roll(i[:-1], -1, 1), i[1:], np.roll(i[1:], -1, 1)))
    return np.concatenate(points), np.concatenate([np.stack([a, c, b], 1), np.stack([b, c, d], 1)])


def _flattened(x: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Every triangle laid flat by itself, (F, 3, 2) [m]: the cloth is at rest as it is laid out."""
    along, other = x[faces[:, 1]] - x[faces[:, 0]], x[faces[:, 2]] - x[faces[:, 0]]
    length = np.linalg.norm(along, axis=1)
    u = (along * other).sum(1) / length
    out = np.zeros((len(faces), 3, 2))
    out[:, 1, 0], out[:, 2, 0] = length, u
    out[:, 2, 1] = np.sqrt((other**2).sum(1) - u * u)
    return out


def test_a_hem_trails_on_the_floor_while_the_figure_walks_off(figure: Figure) -> None:
    frames, figure = 14, Figure(figure.mannequin, 0.01)
    x, faces = _skirt(figure, 0.005)
    sheet = Sheet.of_corners(
        _flattened(x, faces), faces, [Material(0.15, 150.0, 0.3, 1e-5, 0.4)], np.zeros(len(faces), np.int32)
    )
    begin, step = POSES["gown"][0], POSES["step"][0]
    poses = []
    for frame in range(frames + 1):
        pose = figure.mannequin.standing(begin.towards(step, 0.5 * frame / frames))
        poses.append(pose.shifted(z=0.014 * frame))
    body = figure.moving(poses, beside=FLOOR)
    film: list[np.ndarray] = []
    contact = Contact(0.008, 0.005, 0.0, speed_limit=8.0)
    phase = Phase(frames * FRAME, damping=2.0, body=(0.0, float(frames)))
    drape(sheet, x, [phase], collider=body, contact=contact, on_frame=lambda _, p: film.append(p))
    for frame in (3, 6, 10, 14):
        p = film[frame - 1].astype(float)
        samples = np.concatenate([p, p[sheet.edges].mean(1), p[faces].mean(1)])
        assert samples[:, 1].min() > 0.0  # nothing below the floor
        inside = metrics.penetration(p, faces, *figure.mesh(poses[frame]))
        assert (inside.vertices, inside.midpoints, inside.centroids) == (0, 0, 0)
    end = film[-1]
    assert (end[-64:, 1] < 0.02).mean() > 0.7  # the hem lies on the floor still,
    assert end[:64, 2].mean() - x[:64, 2].mean() > 0.1  # and the waist went with the figure
    assert end[-64:, 2].mean() - x[-64:, 2].mean() < 0.1


def test_where_arms_hang_beside_the_trunk_what_lies_between_is_filled(figure: Figure) -> None:
    """A gap beneath: the field is nowhere higher, it is lower between arm and trunk, and it has a name of its own."""
    open_, mannequin = figure.beneath(Pose.arms(84.0, 84.0)), figure.mannequin
    filled = replace(open_, closing=0.02)
    before, after = open_.field(), filled.field()
    assert (after.values <= before.values).all()
    marks = mannequin.landmarks(Pose.arms(84.0, 84.0))
    changed = np.argwhere(before.values - after.values > 0.004) * before.cell + before.origin
    assert len(changed)
    shoulder, hip = marks["shoulder_l"], marks["hip_l"]
    under_an_arm = (np.abs(changed[:, 0]) > 0.08) & (changed[:, 1] < shoulder[1]) & (changed[:, 1] > hip[1])
    assert under_an_arm.any()
    assert filled.digest() != open_.digest()
    assert replace(open_, closing=0.0).digest() == open_.digest()


def test_a_moving_figure_is_filled_key_by_key(figure: Figure) -> None:
    moving = figure.moving([Pose.arms(80.0, 80.0), Pose.arms(82.0, 82.0)])
    filled = moving.closed(0.02)
    assert moving.closed(0.0) is moving
    assert filled.name != moving.name
    for k in range(2):
        own = closed(field_like(moving, k), 0.02)
        assert np.array_equal(filled.key(k), own.values)
        assert (filled.key(k) < moving.key(k)).any()


def field_like(moving: MovingGrid, k: int):
    return DistanceField(np.array(moving.origin), moving.cell, moving.key(k))
