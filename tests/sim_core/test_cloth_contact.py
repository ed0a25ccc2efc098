"""Solids and contact: exact distances, friction, nothing ends inside, layers do not pass each other."""

import math
from functools import partial

import numpy as np
import pytest
from full_matrix import by_day

from sim_core import metrics
from sim_core.cloth import (
    Box,
    Capsule,
    Contact,
    Cylinder,
    GridSdf,
    HalfSpace,
    Material,
    Phase,
    Sheet,
    Solid,
    Union,
    drape,
)
from sim_core.cloth.contact import (
    Mesh,
    Push,
    Search,
    begin_pairs,
    collide_samples,
    distances,
    finder_of,
    hash_points,
    near_pairs_of,
    patches_of,
    shapes_of,
    solid_mesh,
)
from sim_core.cloth.scenes import bar, equilateral_sheet, scene
from sim_core.errors import SimCoreError

SOLIDS = [
    Capsule((0.1, 0.2, -0.1), (-0.2, 0.5, 0.3), 0.07),
    Capsule((0.0, 0.1, 0.0), (0.0, 0.1, 0.0), 0.1),
    Cylinder((0.1, -0.1, 0.0), (0.3, 0.4, 0.2), 0.12, 0.03),
    Cylinder((0.0, 0.0, 0.0), (0.0, 0.3, 0.0), 0.1),
    Box((0.1, 0.1, -0.2), (0.3, 0.2, 0.5), 0.04, 0.6),
    Box((0.0, 0.0, 0.0), (0.2, 0.2, 0.2)),
]


@pytest.mark.parametrize("solid", by_day(SOLIDS[::2], SOLIDS), ids=lambda s: type(s).__name__)
def test_distance_agrees_with_a_fine_mesh_of_the_solid(solid: Solid) -> None:
    vertices, faces = solid_mesh(solid, 160)
    assert np.abs(solid.distance(vertices)).max() < 1e-9
    points = np.random.default_rng(5).uniform(-0.6, 0.8, (400, 3))
    signed = solid.distance(points)
    outside = signed > 0
    assert outside.any()
    measured = metrics.surface_distance(points, vertices, faces)
    assert np.abs(measured[outside] - signed[outside]).max() < 4e-4
    deep = np.concatenate([vertices.mean(0)[None], 0.5 * (vertices + vertices.mean(0))])
    assert (solid.distance(deep) < 0).all()
    assert metrics.surface_distance(deep, vertices, faces) == pytest.approx(-solid.distance(deep), abs=4e-4)


def test_places_beyond_measure_lead_out_of_no_grid() -> None:
    """A frame that blows up asks for them before it is rolled back."""
    grid = GridSdf.sample(
        Capsule((0.0, 0.0, 0.0), (0.3, 0.0, 0.0), 0.1), np.full(3, -0.2), np.full(3, 0.5), 0.05
    )
    wild = np.random.default_rng(0).choice([np.nan, np.inf, -np.inf, 1e300, -1e300, 0.1], (2000, 3))
    found = distances(grid.packed(), wild)
    there = (wild == 0.1).all(1)
    assert there.any()
    assert np.isfinite(found[there]).all()
    assert (found[there] == found[there][0]).all()
    assert not np.isfinite(found[~there & np.isinf(wild).any(1) & ~np.isnan(wild).any(1)]).any()


@pytest.mark.parametrize("wrong", [np.nan, np.inf, 1e300])
def test_points_beyond_measure_lie_in_no_cell(wrong: float) -> None:
    points = np.random.default_rng(0).random((50, 3))
    finder = finder_of(50, 100, 60)
    assert min(hash_points(points, 0.1, finder)[0]) > 0
    for i in (0, 20, 49):
        wild = points.copy()
        wild[i, 1] = wrong
        assert hash_points(wild, 0.1, finder)[0] == (0, 0, 0)


def test_union_is_the_nearest_part_and_floor_counts() -> None:
    points = np.random.default_rng(6).uniform(-0.5, 1.0, (500, 3))
    union = Union((*SOLIDS, HalfSpace((0.0, -0.2, 0.0), (0.0, 1.0, 0.0))))
    expected = np.min([s.distance(points) for s in (*SOLIDS, HalfSpace((0.0, -0.2, 0.0), (0, 1, 0)))], axis=0)
    outside = expected > 0
    assert union.distance(points)[outside] == pytest.approx(expected[outside], abs=1e-12)
    assert ((union.distance(points) < 0) == (expected < 0)).all()


def test_sampled_grid_approximates_the_solid() -> None:
    solid = Capsule((-0.1, 0.0, 0.0), (0.1, 0.0, 0.0), 0.08)
    grid = GridSdf.sample(solid, np.array([-0.3, -0.2, -0.2]), np.array([0.3, 0.2, 0.2]), 0.01)
    points = np.random.default_rng(7).uniform([-0.25, -0.15, -0.15], [0.25, 0.15, 0.15], (2000, 3))
    off = np.abs(grid.distance(points) - solid.distance(points))
    assert off[solid.distance(points) > 0.0].max() < 4e-4
    with pytest.raises(SimCoreError, match="more than one grid"):
        Union((grid, grid)).packed()


@pytest.mark.parametrize(
    ("make", "word"),
    [
        (lambda: Capsule((0, 0, 0), (1, 0, 0), -1.0), "capsule.radius"),
        (lambda: Capsule((0, 0, float("nan")), (1, 0, 0), 1.0), "capsule.start"),
        (lambda: Cylinder((0, 0, 0), (0, 0, 0), 1.0), "cylinder"),
        (lambda: Cylinder((0, 0, 0), (0, 1, 0), 1.0, 0.7), "rounding"),
        (lambda: Box((0, 0, 0), (1, 0, 1)), "box"),
        (lambda: GridSdf((0, 0, 0), 0.1, np.zeros((1, 2, 2))), "grid"),
        (lambda: Union(()), "union"),
    ],
)
def test_impossible_solids_are_named(make, word: str) -> None:
    with pytest.raises(SimCoreError, match=word):
        make().packed()


def slide(mu: float, slope: float, seconds: float) -> float:
    """Distance [m] a small sheet slides down an incline of tan = slope."""
    angle = math.atan(slope)
    normal, along = (
        np.array([0.0, math.cos(angle), math.sin(angle)]),
        np.array([0.0, -math.sin(angle), math.cos(angle)]),
    )
    material = Material(0.1, 50.0, 0.3, 1e-5, mu, 0.0, 2e-5)
    sheet = Sheet.of(*equilateral_sheet(0.08, 0.08, 0.02), material)
    start = sheet.rest[:, :1] * [1.0, 0, 0] + sheet.rest[:, 1:] * along + 0.003 * normal
    contact = Contact(clearance=0.003, sample_clearance=0.002)
    ramp = HalfSpace((0, 0, 0), (normal[0], normal[1], normal[2]))
    end = drape(sheet, start, [Phase(seconds)], collider=ramp, contact=contact)
    return float(((end.positions - start) @ along).mean())


@pytest.mark.parametrize("slope", [0.3, 0.6])
def test_slips_exactly_when_the_slope_exceeds_friction(slope: float) -> None:
    assert abs(slide(slope * 1.02, slope, 0.4)) < 1e-4
    assert slide(slope * 0.98, slope, 0.4) > 1e-3
    moved, angle = slide(slope * 0.9, slope, 0.4), math.atan(slope)
    expected = 0.5 * 9.81 * (math.sin(angle) - 0.9 * slope * math.cos(angle)) * 0.4**2
    assert moved == pytest.approx(expected, rel=0.02)


@pytest.mark.slow
def test_after_a_drape_over_a_bar_nothing_is_inside_and_no_layer_crosses() -> None:
    made = bar(0.025, seconds=1.2)
    end = drape(made.sheet, made.positions, made.phases, collider=made.collider, contact=made.contact)
    assert isinstance(made.collider, Capsule)
    inside = metrics.penetration(end.positions, made.sheet.faces, *solid_mesh(made.collider, 64))
    assert (inside.vertices, inside.midpoints, inside.centroids) == (0, 0, 0)
    assert min(inside.clearance) > 0.0005
    assert metrics.intersections(end.positions, made.sheet.faces) == 0
    assert end.positions[:, 1].max() < 1.04
    assert end.positions[:, 1].min() > 0.5
    strain = metrics.area_strain(made.sheet.rest, end.positions, made.sheet.faces)
    assert np.percentile(np.abs(strain), 95) < 0.03


@pytest.mark.slow
@pytest.mark.parametrize("case", by_day([14], [2, 13, 14, 16]))
def test_no_sample_sinks_into_the_teapot(case: int) -> None:
    """The cases whose cloth hangs from the lip of the spout, thinner than a cell, while it falls and swings."""
    made = scene("teapot", case, frames=60)
    solid, contact = made.collider, made.contact
    assert solid is not None
    assert contact is not None
    deepest: list[float] = []

    def heard(_: int, now: np.ndarray) -> None:
        x = now.astype(float)
        samples = np.concatenate([x, x[made.sheet.edges].mean(1), x[made.sheet.faces].mean(1)])
        deepest.append(float(solid.distance(samples).min()))

    drape(made.sheet, made.positions, made.phases, collider=solid, contact=contact, on_frame=heard)
    assert len(deepest) == 60
    assert min(deepest) > -0.1 * contact.clearance


def test_grid_and_analytic_bar_hold_the_cloth_alike() -> None:
    made = bar(0.05, seconds=0.4)
    assert made.collider is not None
    grid = GridSdf.sample(made.collider, np.array([-0.4, 0.8, -0.2]), np.array([0.4, 1.2, 0.2]), 0.008)
    ends = [
        drape(made.sheet, made.positions, made.phases[:1], collider=c, contact=made.contact).positions
        for c in (made.collider, grid)
    ]
    assert made.collider.distance(ends[1]).min() > 0.002
    assert ends[0].mean(0) == pytest.approx(
        ends[1].mean(0), abs=0.01
    )  # single folds part, the whole does not


def bars(rng: np.random.Generator, *, sampled: bool) -> tuple[float, Solid]:
    """Four thin bars side by side, nearer to each other than threads are long, and how far off them cloth falls [m]."""
    aside, rise, radius = rng.uniform(-0.04, 0.05), rng.uniform(0.0, 0.03), rng.uniform(0.005, 0.012)
    bars = Union(
        tuple(
            Capsule((0.022 * k - 0.033, 0.0, -0.06), (0.022 * k - 0.033, rise, 0.06), radius)
            for k in range(4)
        )
    )
    box = np.array([-0.12, -0.1, -0.15]), np.array([0.12, 0.12, 0.15])
    return aside, GridSdf.sample(bars, *box, 0.008) if sampled else bars


@pytest.mark.parametrize("pinned", [(), (0,), (0, 1), (0, 1, 2)])
def test_no_corner_is_pushed_further_than_its_sample(pinned: tuple[int, ...]) -> None:
    """A pinned one bears its part: the others would be thrown by a lever."""
    x = np.array([[0.0, 5e-4, 0.0], [0.01, 5e-4, 0.0], [0.0, 5e-4, 0.01]])
    v, lightness, before = np.full((3, 3), -1.0), np.array([2.0, 2.0, 2.0]), x.copy()
    lightness[list(pinned)] = 0.0
    push = Push(clearance=0.002, cap=4e-4, friction=0.0, dt=1e-4)
    collide_samples(HalfSpace().packed(), lightness, x, v, np.array([[0, 1, 2]], np.int32), push)
    moved = x[:, 1] - before[:, 1]
    free = lightness > 0.0
    assert moved[free] == pytest.approx(np.full(free.sum(), 4e-4))
    assert v[free, 1] == pytest.approx(np.zeros(free.sum()))
    assert not moved[~free].any()


def heard(frames: list[np.ndarray], _: int, x: np.ndarray) -> None:
    frames.append(np.array(x))


@pytest.mark.nightly
def test_cloth_that_bears_on_midpoints_comes_to_rest() -> None:
    """Most of it: how cloth falls is chance, and now and then a fold still creeps."""
    rng = np.random.default_rng(3)
    rest, faces = equilateral_sheet(0.3, 0.3, 0.018)
    sheet = Sheet.of(rest, faces, Material(0.06, 300.0, bend=2e-6))
    middle = rest - rest.mean(0)
    still = Phase(4.0, damping=10.0, friction=0.45)
    contact = Contact(clearance=0.003, sample_clearance=0.0015, thickness=0.0025)
    moves: list[float] = []
    for number in range(24):
        aside, solid = bars(rng, sampled=number % 2 == 1)
        start = np.column_stack([middle[:, 0] + aside, np.full(len(rest), 0.08), -middle[:, 1]])
        frames: list[np.ndarray] = []
        hear = partial(heard, frames)
        drape(sheet, start, [still], collider=solid, contact=contact, on_frame=hear)
        ways = np.linalg.norm(np.diff(frames[-13:], axis=0), axis=2)
        moves.append(float(np.median(np.quantile(ways, 0.99, axis=1))))
    assert np.sum(np.array(moves) > 10e-6) <= 6, np.round(1e6 * np.array(moves), 1)


def test_two_layers_falling_on_each_other_stay_apart() -> None:
    rest, faces = equilateral_sheet(0.2, 0.2, 0.02)
    both = np.concatenate([rest, rest + [0.5, 0.0]])
    sheet = Sheet.of(
        both, np.concatenate([faces, faces + len(rest)]), Material(0.05, 50.0, 0.3, 1e-5, 0.3, 1.0)
    )
    low = np.column_stack([rest[:, 0], np.full(len(rest), 0.003), rest[:, 1]])
    high = low + [0.007, 0.05, 0.011]
    contact = Contact(clearance=0.002, sample_clearance=0.001, thickness=0.004)
    end = drape(sheet, np.concatenate([low, high]), [Phase(0.4)], collider=HalfSpace(), contact=contact)
    assert metrics.intersections(end.positions, sheet.faces) == 0
    assert end.positions[len(rest) :, 1].min() > end.positions[: len(rest), 1].max() - 0.001
    without = Contact(clearance=0.002, sample_clearance=0.001)
    sunk = drape(sheet, np.concatenate([low, high]), [Phase(0.4)], collider=HalfSpace(), contact=without)
    assert sunk.positions[len(rest) :, 1].max() < 0.0035


Found = tuple[set[tuple[int, int]], set[tuple[int, int]]]


def near(x: np.ndarray, mesh: Mesh, how: Search) -> Found:
    """The (vertex, face) pairs and the (edge, edge) pairs, lower first, that a search finds."""
    patches = patches_of(mesh.edges, mesh.faces, mesh.same, mesh.rest[mesh.faces])
    lists = near_pairs_of(len(x), len(mesh.edges), len(patches.bay))
    found = begin_pairs(x, mesh, patches, shapes_of(patches), how, lists).now
    _, points, crossings = found.count
    met = np.sort(found.crossings[:crossings, :2], axis=1)
    return {(int(v), int(f)) for v, f, _ in found.points[:points]}, {(int(a), int(b)) for a, b in met}


def test_candidate_pairs_are_all_pairs_within_reach() -> None:
    """Against the brute force, on a crumpled sheet."""
    rng = np.random.default_rng(8)
    rest, faces = equilateral_sheet(0.2, 0.2, 0.04)
    edges = np.unique(np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0).astype(np.int32)
    x, reach, same = rng.normal(0, 0.03, (len(rest), 3)), 0.01, np.arange(len(rest), dtype=np.int32)
    mesh = Mesh(np.ones(len(rest)), rest, edges, faces, np.zeros(len(edges)), same)
    found, met = near(x, mesh, Search(reach, reach, 0.0, 0.04))
    expected = {
        (v, f)
        for f, face in enumerate(faces)
        for v in range(len(x))
        if v not in face and metrics.surface_distance(x[v : v + 1], x, face[None])[0] < reach
    }
    assert found == expected
    t = np.linspace(0, 1, 60)
    dense = x[edges[:, 0], None] * (1 - t[:, None]) + x[edges[:, 1], None] * t[:, None]
    for a in range(len(edges)):
        for b in range(a + 1, len(edges)):
            if set(edges[a]) & set(edges[b]):
                continue
            gap = np.sqrt(((dense[a][:, None] - dense[b][None]) ** 2).sum(-1)).min()
            if gap < reach - 1e-4:
                assert (a, b) in met
            elif gap > reach + 2e-3:
                assert (a, b) not in met


def test_neighbours_that_a_fold_brings_together_are_candidates_at_any_angle() -> None:
    """Did they come and go with the angle of their normals, the fold would never rest."""
    rng = np.random.default_rng(5)
    rest, faces = equilateral_sheet(0.2, 0.2, 0.02)
    edges = np.unique(np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0).astype(np.int32)
    x = np.column_stack([rest[:, 0], rest[:, 1], np.zeros(len(rest))]) + rng.normal(0, 0.012, (len(rest), 3))
    mesh = Mesh(
        np.ones(len(rest)), rest, edges, faces, np.zeros(len(edges)), np.arange(len(rest), dtype=np.int32)
    )
    every, some = (near(x, mesh, Search(0.004, 0.01, within, 0.02)) for within in (0.0, 0.07))
    assert some[0] < every[0]  # what is flat is left out
    assert some[1] < every[1]
    for v, f in every[0] - some[0]:
        apart = np.linalg.norm(rest[faces[f]] - rest[v], axis=1).min()
        assert metrics.surface_distance(x[v : v + 1], x, faces[f][None])[0] >= min(
            max(apart / 3, 0.004), apart / 2
        )
    t = np.linspace(0, 1, 200)[:, None]
    for a, b in every[1] - some[1]:
        apart = np.linalg.norm(rest[edges[a]][:, None] - rest[edges[b]], axis=2).min()
        first, second = (x[edges[e, 0]] * (1 - t) + x[edges[e, 1]] * t for e in (a, b))
        assert (
            np.linalg.norm(first[:, None] - second, axis=2).min()
            >= min(max(apart / 3, 0.004), apart / 2) - 1e-4
        )
