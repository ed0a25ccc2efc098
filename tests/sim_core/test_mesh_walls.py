"""Walls: what they hide, and how few of them a search looks at."""

import numpy as np
import pytest

from sim_core.mesh import panel_mesh
from sim_core.mesh.geometry import point_cells
from sim_core.mesh.measures import mesh_fault
from sim_core.mesh.triangulation import walls


def ring(count: int, gap: float) -> tuple[np.ndarray, np.ndarray]:
    """Points of two circles `gap` apart and the steps of the inner one."""
    turn = np.arange(count) * 2 * np.pi / count
    circle = np.column_stack([np.cos(turn), np.sin(turn)])
    inner = np.arange(count)
    return np.concatenate([circle * (1 - gap), circle]), np.column_stack([inner, np.roll(inner, -1)])


def sorted_ring(count: int):
    points, steps = ring(count, 1e-7)
    order, cells = point_cells(points)
    rank = np.zeros(len(points), dtype=np.int64)
    rank[order] = np.arange(len(points))
    found = walls.wall_cells(points[order], rank[steps], cells, np.zeros(1, np.int64), 10**6)
    return points[order], rank, cells, found


@pytest.mark.nightly
def test_hidden_agrees_with_every_wall_tried():
    places, rank, cells, found = sorted_ring(60)
    rng = np.random.default_rng(5)
    answers = []
    for a, b, c in rng.integers(0, len(places), (3000, 3)):
        if len({a, b, c}) < 3:
            continue
        told = walls.hidden(places, a, b, c, cells.grid, found)
        answers.append(told)
        assert told == any(
            walls.crosses(places, end, c, p, q) for end in (a, b) for p, q in found.ends.tolist()
        )
    assert 100 < sum(answers) < len(answers) - 100


def test_a_point_across_a_narrow_gap_is_hidden_after_few_walls(monkeypatch):
    """A triangle across the gap has a circle wider than the panel: every point under it is asked for."""
    count, tried = 1000, []

    def counted(*args):
        tried.append(args)
        return crosses(*args)

    crosses = walls.crosses.py_func
    places, rank, cells, found = sorted_ring(count)
    monkeypatch.setattr(walls, "crosses", counted)
    monkeypatch.setattr(walls, "_wall_between", walls._wall_between.py_func)
    a, b = rank[count], rank[count + 1]
    for far in range(count // 4, 3 * count // 4):
        assert walls.hidden.py_func(places, a, b, rank[far], cells.grid, found)
    assert len(tried) < 4 * count  # a few each, of a thousand


@pytest.mark.parametrize("kind", ["fair", "best"])
def test_a_ring_of_a_tenth_of_a_micron_is_sound(kind):
    points, _ = ring(90, 1e-7)
    mesh = panel_mesh(points[90:], edge=0.1, holes=[points[:90]], quality=kind)
    assert mesh_fault(mesh.vertices, mesh.faces, mesh.boundary) is None
