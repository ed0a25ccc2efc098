"""Cloth that passed through itself is taken apart again; where it passes is found as the metrics find it."""

import numpy as np
import pytest

from sim_core import metrics
from sim_core.cloth import Contact, Material, Phase, Sheet, drape
from sim_core.cloth.contact import (
    Holds,
    Memory,
    Mesh,
    Untangling,
    crossings_of,
    faces_at_edges,
    finder_of,
    near_pairs_of,
    no_crossings,
    patches_of,
    shapes_of,
    untangle,
)
from sim_core.cloth.scenes import equilateral_sheet

CLOTH = Material(0.05, 50.0, 0.3, 1e-5, 0.3, 1.0)
ENOUGH = Untangling(step=3e-4, rounds=40)


def edges_of(faces: np.ndarray) -> np.ndarray:
    return np.unique(np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0).astype(np.int32)


def mesh_of(faces: np.ndarray, inverse: np.ndarray) -> Mesh:
    """The faces of a cloth whose vertices have these 1/m (V,)."""
    edges, faces = edges_of(faces), faces.astype(np.int32)
    same = np.arange(len(inverse), dtype=np.int32)
    return Mesh(inverse, np.zeros((len(inverse), 2)), edges, faces, np.zeros(len(edges)), same)


def untangled(x: np.ndarray, v: np.ndarray, mesh: Mesh, how: Untangling) -> tuple[int, int]:
    """Crossings before and after."""
    patches = patches_of(mesh.edges, mesh.faces, mesh.same, mesh.rest[mesh.faces])
    finder = finder_of(len(x), len(mesh.edges), len(mesh.faces))
    memory = Memory(finder, no_crossings(), patches, shapes_of(patches), near_pairs_of(0, 0, 0).now.patches)
    third = faces_at_edges(mesh.edges, mesh.faces)
    return untangle(x, v, mesh, third, Holds.of(len(x)), memory, how)[:2]


def two_layers(rest: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Rest (2V, 2), faces and positions of a flat layer and one 2 mm above whose corner dips 3 mm through it."""
    both = np.concatenate([rest, rest + [0.5, 0.0]])
    dip = np.clip(1 - np.linalg.norm(rest - rest.max(0) * 0.8, axis=1) / 0.04, 0, 1)
    low = np.column_stack([rest[:, 0], np.zeros(len(rest)), rest[:, 1]])
    high = low + [0.0051, 0.002, 0.0037]
    high[:, 1] -= 0.005 * dip
    return both, np.concatenate([faces, faces + len(rest)]).astype(np.int32), np.concatenate([low, high])


def test_crossings_are_those_of_the_metrics_on_a_crumpled_sheet() -> None:
    rest, faces = equilateral_sheet(0.2, 0.2, 0.02)
    x, mesh = np.random.default_rng(2).normal(0, 0.03, (len(rest), 3)), mesh_of(faces, np.ones(len(rest)))
    finder = finder_of(len(x), len(mesh.edges), len(faces))
    (pairs, place), count = crossings_of(x, mesh, finder, no_crossings())
    assert count == metrics.intersections(x, faces) > 64
    ends, corners = x[mesh.edges[pairs[:count, 0]]], x[mesh.faces[pairs[:count, 1]]]
    t, weights = place[:count, :1], place[:count, 1:]
    there = (1 - t) * ends[:, 0] + t * ends[:, 1]
    assert there == pytest.approx((weights[:, :, None] * corners).sum(1), abs=1e-9)
    assert weights.min() >= 0.0
    sewn = mesh._replace(same=np.zeros(len(rest), np.int32))
    assert crossings_of(x, sewn, finder, no_crossings())[1] == 0


def test_every_edge_knows_its_faces() -> None:
    """In whatever order faces name their corners: an edge may stand at the same place of both of its faces."""
    _, faces = equilateral_sheet(0.1, 0.1, 0.02)
    turns = np.random.default_rng(1).integers(0, 3, len(faces))
    faces = np.stack([np.roll(face, turn) for face, turn in zip(faces, turns, strict=True)])
    edges = edges_of(faces)
    third = faces_at_edges(edges, faces)
    met = {tuple(sorted(map(int, face))) for face in faces}
    told = [
        {tuple(sorted((int(a), int(b), int(c)))) for c in row if c >= 0}
        for (a, b), row in zip(edges, third, strict=True)
    ]
    assert all(0 < len(own) <= 2 and own <= met for own in told)
    assert sum(len(own) for own in told) == 3 * len(faces)


def test_a_corner_that_dips_through_is_drawn_back() -> None:
    _, faces, x = two_layers(*equilateral_sheet(0.2, 0.2, 0.02))
    start, v = x.copy(), np.tile([0.0, 1.0, 0.0], (len(x), 1))
    before, after = untangled(x, v, mesh_of(faces, np.ones(len(x))), ENOUGH)
    assert before == metrics.intersections(start, faces) > 0
    assert after == metrics.intersections(x, faces) == 0
    moved = np.linalg.norm(x - start, axis=1)
    assert moved.max() < 0.006
    assert (moved > 0).sum() < 0.2 * len(x)  # what does not cross stays where it is
    assert x.mean(0) == pytest.approx(start.mean(0), abs=1e-5)  # one side as far as the other
    going = ((x - start) * v).sum(1)
    assert going.min() >= -1e-12


def slit() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A level sheet cut open in its middle by 30 mm; one side of the slit lies over the other and dips through it."""
    n, step = 17, 0.01
    u, w = np.meshgrid(np.arange(n), np.arange(n), indexing="ij")
    rest = step * np.stack([u.ravel(), w.ravel()], axis=1).astype(float)
    a = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    faces = np.concatenate([np.stack([a, a + n, a + 1], 1), np.stack([a + 1, a + n, a + n + 1], 1)])
    middle, half = n // 2, 3
    cut = middle * n + np.arange(half)
    other = np.arange(n * n)
    other[cut] = n * n + np.arange(half)
    right = rest[faces].mean(1)[:, 0] > middle * step
    faces[right] = other[faces[right]]
    rest = np.concatenate([rest, rest[cut]])
    x = np.column_stack([rest[:, 0], np.zeros(len(rest)), rest[:, 1]])
    opened = np.clip(1 - rest[:, 1] / (half * step), 0, 1)
    opened *= np.clip(1 - np.abs(rest[:, 0] - middle * step) / (middle * step), 0, 1)
    side = np.isin(np.arange(len(x)), faces[right]) & (opened > 0)
    x[side, 0] -= 0.006 * opened[side]
    x[side, 1] += 0.0015 * opened[side] * np.cos(90 * rest[side, 1])
    return rest, x, faces.astype(np.int32)


def test_sides_of_a_slit_that_lie_in_one_plane_are_seen_to_cross() -> None:
    rest, x, faces = slit()
    mesh = mesh_of(faces, np.ones(len(x)))._replace(rest=rest)
    before, after = untangled(x.copy(), np.zeros_like(x), mesh, ENOUGH)
    assert before == metrics.intersections(x, faces) > 0
    assert after == 0


@pytest.mark.parametrize("partly", [False, True])
def test_what_cannot_be_undone_is_left_as_it_is_unless_some_of_it_may_be(partly: bool) -> None:
    _, faces, x = two_layers(*equilateral_sheet(0.2, 0.2, 0.02))
    start, too_few = x.copy(), Untangling(step=3e-4, rounds=6, partly=partly)
    before, after = untangled(x, np.zeros_like(x), mesh_of(faces, np.ones(len(x))), too_few)
    assert 0 < after <= before
    assert after == metrics.intersections(x, faces)
    assert (after < before) == partly == bool((x != start).any())


def test_what_is_held_is_not_moved() -> None:
    _, faces, x = two_layers(*equilateral_sheet(0.2, 0.2, 0.02))
    start, half = x.copy(), len(x) // 2
    mesh = mesh_of(faces, np.r_[np.zeros(half), np.ones(half)])
    assert untangled(x, np.zeros_like(x), mesh, ENOUGH)[1] == 0
    assert (x[:half] == start[:half]).all()


def test_a_run_ends_untangled_where_repulsion_alone_keeps_it_tangled() -> None:
    both, faces, x = two_layers(*equilateral_sheet(0.2, 0.2, 0.02))
    sheet = Sheet.of(both, faces, CLOTH)
    left = {}
    for rounds in (0, 20):
        contact = Contact(thickness=0.002, spring=0.001, speed_limit=0.1, untangle=rounds)
        end = drape(sheet, x, [Phase(0.2, (0.0, 0.0), 5.0)], contact=contact)
        left[rounds] = metrics.intersections(end.positions, faces)
        assert end.worst_stretch < 1.2
    assert left[20] == 0 < left[0]


def test_a_tangle_comes_free_though_another_does_not() -> None:
    """Two corners dip through; the cloth at the second is held on both sides, and stays to the bit."""
    rest, faces = equilateral_sheet(0.2, 0.2, 0.02)
    _, faces, x = two_layers(rest, faces)
    second = np.clip(1 - np.linalg.norm(rest - rest.max(0) * 0.2, axis=1) / 0.04, 0, 1)
    x[len(rest) :, 1] -= 0.005 * second
    near = np.tile(second > 0, 2) | np.r_[np.linalg.norm(rest - rest.max(0) * 0.2, axis=1) < 0.06, second > 0]
    start = x.copy()
    before, after = untangled(x, np.zeros_like(x), mesh_of(faces, np.where(near, 0.0, 1.0)), ENOUGH)
    assert before == metrics.intersections(start, faces)
    assert 0 < after == metrics.intersections(x, faces) < before
    moved = np.linalg.norm(x - start, axis=1) > 0
    assert moved.any()
    assert not moved[near].any()
    far = np.tile(np.linalg.norm(rest - rest.max(0) * 0.2, axis=1) < 0.08, 2)
    assert not moved[far].any()
