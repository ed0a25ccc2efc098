"""Pairs of patches that are no pairs, as the cloth goes: nothing of them comes within reach until it has strayed."""

from __future__ import annotations

from copy import deepcopy
from typing import NamedTuple

import numpy as np
import pytest

from sim_core import metrics
from sim_core.cloth import Contact, HalfSpace, Material, Phase, Sheet, drape
from sim_core.cloth.contact import (
    Mesh,
    Patches,
    Search,
    begin_pairs,
    feel,
    jerks_of,
    near_pairs_of,
    patches_of,
    shapes_of,
    stand_by,
    unsure_pairs,
)
from sim_core.cloth.run import Run, Setup
from sim_core.cloth.scenes import equilateral_sheet
from sim_core.cloth.step import FRAME

SIDE, REACH = 0.02, 0.012
HOW = Search(0.004, REACH, 0.0, SIDE, -0.5)


class Cloth(NamedTuple):
    """A sheet of some patches, as contact sees it."""

    rest: np.ndarray  # (V, 2) [m]
    mesh: Mesh
    patches: Patches


def cloth() -> Cloth:
    rest, faces = equilateral_sheet(0.3, 0.3, SIDE)
    edges = np.unique(np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0).astype(np.int32)
    same, count = np.arange(len(rest), dtype=np.int32), len(rest)
    length2 = ((rest[edges[:, 0]] - rest[edges[:, 1]]) ** 2).sum(1)
    mesh = Mesh(np.ones(count), rest, edges, faces, length2, same)
    return Cloth(rest, mesh, patches_of(edges, faces, same, rest[faces]))


class Fold(NamedTuple):
    """A sheet folded over, which turns and flies while its halves fly at each other."""

    x: np.ndarray  # (V, 3) [m]
    v: np.ndarray  # (V, 3) [m/s]
    above: np.ndarray  # (V,) 0 in the lower half, 1 in the upper, between them in the bend


def folded(rest: np.ndarray, radius: float, speed: float, rng: np.random.Generator) -> Fold:
    bend = rest[:, 1].max() / 2
    above = np.clip((rest[:, 1] - bend) / (np.pi * radius), 0.0, 1.0)
    turned = np.pi * above
    along = np.minimum(rest[:, 1], bend) - np.maximum(rest[:, 1] - bend - np.pi * radius, 0.0)
    x = np.column_stack([rest[:, 0], radius * (1 - np.cos(turned)), along + radius * np.sin(turned)])
    turn, fly = rng.normal(0, 2, 3), rng.normal(0, 3, 3)
    return Fold(x, np.cross(turn, x) + fly - np.outer(above, [0.0, speed, 0.0]), above)


def patch_of(count: int, of: np.ndarray, start: np.ndarray) -> np.ndarray:
    """The number of the patch of each of so many parts."""
    numbers = np.zeros(count, np.int64)
    numbers[of] = np.repeat(np.arange(len(start) - 1), np.diff(start))
    return numbers


@pytest.mark.parametrize("seed", range(6))
def test_what_is_no_pair_does_not_come_within_reach(seed: int) -> None:
    """Halves of a fold fly at each other until they are nearly within reach, and stray into it as far as they may."""
    made, rng, seconds, stray = cloth(), np.random.default_rng(seed), 0.008, 0.004
    rest, mesh, patches = made
    radius = rng.uniform(0.018, 0.028)
    x, v, above = folded(rest, radius, (2 * radius - REACH - stray) / seconds, rng)
    allowed = np.full((len(patches.bay), 2), stray)
    shapes, held = shapes_of(patches), np.zeros((64, 5), np.int32)
    pairs, count = unsure_pairs(x, v, mesh, patches, shapes, HOW, (seconds, allowed), held)
    unsure = {(int(p), int(q)) for p, q in pairs[:count, :2]}
    vertex = patch_of(len(rest), patches.vertices, patches.vertex_start)
    edge = patch_of(len(mesh.edges), patches.edges, patches.edge_start)
    face = patch_of(len(mesh.faces), patches.faces, patches.face_start)
    found: set[tuple[int, int]] = set()
    for share in (0.5, 1.0):
        there = x + share * seconds * v + share * stray * np.outer(1 - 2 * above, [0.0, 1.0, 0.0])
        lists = near_pairs_of(len(rest), len(mesh.edges), len(patches.bay))
        now = begin_pairs(there, mesh, patches, shapes, HOW, lists).now
        _, points, crossings = now.count
        met = [(vertex[i], face[f]) for i, f in now.points[:points, :2]]
        met += [(edge[e], edge[g]) for e, g in now.crossings[:crossings, :2]]
        found |= {(int(min(pair)), int(max(pair))) for pair in met}
    assert len(found) > 10
    assert found <= unsure


def test_a_fold_at_rest_is_a_pair_only_where_it_is_bent() -> None:
    made, rng = cloth(), np.random.default_rng(0)
    rest, mesh, patches = made
    counts = []
    for speed in (0.0, 4.0):
        x, v, _ = folded(rest, 0.02, speed, rng)
        allowed, held = np.full((len(patches.bay), 2), 0.001), np.zeros((64, 5), np.int32)
        _, count = unsure_pairs(x, v, mesh, patches, shapes_of(patches), HOW, (0.008, allowed), held)
        counts.append(count)
    assert counts[1] > 2 * counts[0]


def test_cloth_that_hangs_has_no_pairs_and_is_seldom_looked_at() -> None:
    """Held along a side it swings down without touching itself; a frame has more than a hundred substeps."""
    rest, faces = equilateral_sheet(0.4, 0.4, SIDE)
    sheet = Sheet.of(rest, faces, Material(0.05, 50.0, 0.3, 1e-5, 0.3, 1.0))
    x = np.column_stack([rest[:, 0], np.zeros(len(rest)), rest[:, 1]])
    pins = np.flatnonzero(rest[:, 1] < 1e-9).tolist()
    run = Run(Setup(sheet, [Phase(20 / 25, (1.0, 1.0))], pins=pins, contact=Contact(thickness=0.003)))
    state, pairs = run.begun(x, np.zeros_like(x)), 0
    for _ in range(20):
        run.frame(state)
        pairs += int(run.engine.near.now.count[0])
    looks, renewals, _, _, through = run.engine.near.tally
    assert state.substeps > 20 * 50
    assert looks < state.substeps / 8
    assert renewals < 20 * 12
    assert through == 0
    assert pairs < 20 * 4


def test_a_sheet_that_only_turns_and_flies_has_no_pairs() -> None:
    """What all go along with, straight, brings nothing nearer."""
    made = cloth()
    rest, mesh, patches = made
    x = np.column_stack([rest[:, 0], 0.01 * np.sin(20 * rest[:, 1]), rest[:, 1]])
    v = np.cross(np.array([3.0, -8.0, 5.0]), x) + np.array([20.0, 5.0, -9.0])
    allowed = np.full((len(patches.bay), 2), 0.001)
    _, count = unsure_pairs(
        x, v, mesh, patches, shapes_of(patches), HOW, (0.02, allowed), np.zeros((64, 5), np.int32)
    )
    assert count == 0


def square(count: int, size: float) -> tuple[np.ndarray, np.ndarray]:
    """Rest (V, 2) [m] and faces of a square of so many vertices a side."""
    u, w = np.meshgrid(*[np.linspace(-size / 2, size / 2, count)] * 2, indexing="ij")
    a = (np.arange(count - 1)[:, None] * count + np.arange(count - 1)).ravel()
    faces = [np.stack([a, a + 1, a + count], 1), np.stack([a + 1, a + count + 1, a + count], 1)]
    return np.column_stack([u.ravel(), w.ravel()]), np.concatenate(faces).astype(np.int32)


def sheets(heights: list[float], count: int, size: float) -> tuple[Sheet, np.ndarray]:
    """Level squares one over the other, each a little aside."""
    rest, faces = square(count, size)
    flat = np.concatenate([rest + [2 * size * k, 0.0] for k in range(len(heights))])
    every = np.concatenate([faces + len(rest) * k for k in range(len(heights))])
    places = [
        np.column_stack(
            [rest[:, 0] + 0.0013 * size * k, np.full(len(rest), y), rest[:, 1] + 0.0007 * size * k]
        )
        for k, y in enumerate(heights)
    ]
    return Sheet.of(flat, every, Material(0.1, 49.0, bend=5e-6)), np.concatenate(places)


def after_a_frame(
    sheet: Sheet, x: np.ndarray, v: np.ndarray, thickness: float, solid: HalfSpace | None = None
) -> np.ndarray:
    """Places (V, 3) [m] a frame later, with gravity where there is a solid to fall on."""
    pull = 9.81 if solid else 0.0
    contact = Contact(thickness=thickness)
    run = Run(Setup(sheet, [Phase(FRAME, (pull, pull))], contact=contact, collider=solid))
    state = run.begun(x, v)
    run.frame(state)
    return state.positions


STRUCK = [  # [m] from the first to the second and to the third, m/s, [m] that layers keep
    (0.008, 0.020, 2.0, 0.0025),
    (0.008, 0.020, 3.0, 0.0025),
    (0.008, 0.020, 5.0, 0.0025),
    (0.008, 0.025, 5.0, 0.0025),
    (0.008, 0.003, 8.0, 0.0025),
    (0.008, 0.0035, 6.0, 0.0025),
    (0.008, 0.004, 4.0, 0.0025),
    (0.008, 0.004, 8.0, 0.0025),
    (0.005, 0.0045, 3.0, 0.0025),
    (0.012, 0.0018, 2.0, 0.001),
]


@pytest.mark.parametrize(("first", "second", "speed", "thickness"), STRUCK)
def test_a_sheet_that_is_struck_does_not_pass_through_the_next(
    first: float, second: float, speed: float, thickness: float
) -> None:
    """The middle one was at rest when its pairs were foreseen or fell asleep, and flies from a substep to the next."""
    sheet, x = sheets([0.0, first, first + second], 24 if second > 0.01 else 16, 0.3)
    v, own = np.zeros_like(x), len(x) // 3
    v[:own, 1] = speed
    there = after_a_frame(sheet, x, v, thickness)
    heights = there[:, 1].reshape(3, own).mean(1)
    assert (np.diff(heights) > 0.4 * thickness).all()
    assert metrics.intersections(there, sheet.faces) == 0


FALLEN = [  # [m] the lower sheet's height, the gap, m/s, [m] that layers keep
    (0.07, 0.004, 3.0, 0.0025),
    (0.07, 0.003, 4.0, 0.0025),
    (0.035, 0.003, 5.0, 0.0025),
    (0.02, 0.018, 5.0, 0.0025),
    (0.05, 0.018, 5.0, 0.0025),
    (0.05, 0.022, 5.0, 0.0025),
    (0.02, 0.004, 10.0, 0.0025),
    (0.05, 0.002, 2.0, 0.001),
]


@pytest.mark.parametrize(("height", "gap", "speed", "thickness"), FALLEN)
def test_sheets_that_fall_together_keep_their_order_on_the_floor(
    height: float, gap: float, speed: float, thickness: float
) -> None:
    """Nothing comes nearer to anything until the floor stops the lower one from one substep to the next."""
    sheet, x = sheets([height, height + gap], 16, 0.3)
    v = np.zeros_like(x)
    v[:, 1] = -speed
    there = after_a_frame(sheet, x, v, thickness, HalfSpace())
    lower, upper = there[:, 1].reshape(2, -1)
    assert (upper > lower).all()
    assert metrics.intersections(there, sheet.faces) == 0


@pytest.mark.parametrize("after", [0, 2])
def test_sheets_on_a_floor_go_on_to_the_same_bits(after: int) -> None:
    """Whoever resumes begins with new lists, in which nobody sleeps: sleep and foresight may change nothing."""
    sheet, x = sheets([0.09, 0.096, 0.103], 16, 0.3)
    setup = Setup(
        sheet, [Phase(4 * FRAME, (9.81, 9.81))], contact=Contact(thickness=0.0025), collider=HalfSpace()
    )
    v = np.zeros_like(x)
    v[:, 1] = -2.0
    run = Run(setup)
    state = run.begun(x, v)
    for frame in range(4):
        run.frame(state)
        if frame == after:
            other, again = Run(setup), deepcopy(state)
    for _ in range(after + 1, 4):
        other.frame(again)
    assert np.array_equal(again.positions, state.positions)


def test_who_goes_otherwise_is_woken() -> None:
    """By a velocity, and by a push that no velocity knows of; by less than the sway nobody is."""
    dt, count, straight = 4e-4, 50, (4e-4, 1e-3)
    x, v = np.random.default_rng(3).normal(0, 1, (2, 3, count))
    for off, pushed, woken in ((0.0, 0.0, 0), (0.09, 0.0, 0), (0.11, 0.0, 1), (0.0, 5e-5, 1)):
        jerks = jerks_of(count)
        stand_by(x, v, jerks)
        there, now = x + dt * v, v.copy()
        now[0, 7] += off
        there[1, 7] += pushed
        assert not feel(there, now, jerks, dt, straight)
        assert jerks.jerked.sum() == woken
        assert jerks.jerked[7] == bool(woken)
        assert jerks.some[0] == bool(woken)
        there, now = there + dt * now, now + [[0.0], [0.0], [1.0]]
        feel(there, now, jerks, dt, straight)
        assert jerks.jerked.all()


def test_a_push_in_every_substep_wakes_once() -> None:
    """What lies on a body is pushed back as far as it went, in every substep alike; harder pushes wake again."""
    dt, jerks, straight = 4e-4, jerks_of(9), (0.0, np.inf)
    x, v = np.zeros((3, 9)), np.zeros((3, 9))
    v[1] = -0.5
    stand_by(x, v, jerks)
    woken = []
    for push in [0.5] * 5 + [0.55, 0.65, 0.5]:
        x = x + dt * (v + [[0.0], [push], [0.0]])
        feel(x, v, jerks, dt, straight)
        woken.append(bool(jerks.jerked.all()))
        assert jerks.jerked.all() or not jerks.jerked.any()
    assert woken == [True, False, False, False, False, False, True, False]


def test_who_leaves_a_straight_way_is_looked_at() -> None:
    """By how far it is from where it was bound for, or will be a step later, whatever its speed meanwhile."""
    dt, jerks, (x, v) = 4e-4, jerks_of(9), np.random.default_rng(4).normal(0, 1, (2, 3, 9))
    for off, turn, astray in ((0.0, 0.0, False), (9e-5, 0.24, False), (1.1e-4, 0.0, True), (0.0, 0.26, True)):
        stand_by(x, v, jerks)
        there, now = x + dt * v, v.copy()
        there[2, 3] += off
        now[0, 4] += turn
        assert feel(there, now, jerks, dt, (dt, 1e-4)) == astray
        assert not feel(there + dt * now, now, jerks, dt, (2 * dt, 1.0))


@pytest.mark.parametrize("gap", [0.06, 0.07, 0.08, 0.09, 0.1, 0.105, 0.11, 0.115, 0.13, 0.15])
def test_sheets_that_meet_at_forty_metres_a_second_do_not_cross_themselves(gap: float) -> None:
    """Whatever the instant of the frame in which they meet: where they crumple, what was flat is none any more."""
    sheet, x = sheets([0.0, gap], 17, 0.3)
    v, own = np.zeros_like(x), len(x) // 2
    v[:own, 1], v[own:, 1] = 20.0, -20.0
    contact = Contact(thickness=0.003, untangle=20, partly=True)
    end = drape(sheet, x, [Phase(FRAME, (0.0, 0.0))], velocities=v, contact=contact)
    assert metrics.intersections(end.positions, sheet.faces) == 0
    lower, upper = end.positions[:, 1].reshape(2, own).mean(1)
    assert lower < upper
