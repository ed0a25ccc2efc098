"""Size fields of many points: the same sizes as by trying all, from a few of them."""

import numpy as np
import pytest

from sim_core.mesh import SizeField, panel_mesh
from sim_core.mesh.geometry import nearest, size_boxes
from sim_core.mesh.measures import mesh_fault


@pytest.mark.parametrize("count", [1, 7, 8, 9, 64, 65, 3000])
@pytest.mark.parametrize("gradation", [1e-3, 0.2, 1.0])
def test_sizes_are_those_of_all_points_tried(count, gradation):
    rng = np.random.default_rng(count)
    points, sizes = rng.random((count, 2)), 10 ** rng.uniform(-2, 0, count)
    points[::5] = points[0]  # points in one place count by their least size
    places = np.concatenate([rng.uniform(-0.5, 1.5, (300, 2)), points[:50]])
    gaps = np.sqrt(((places[:, None] - points) ** 2).sum(axis=2))
    wanted = np.minimum(0.3, (sizes + gradation * gaps).min(axis=1))
    np.testing.assert_array_equal(SizeField(points, sizes, gradation).at(places, 0.3), wanted)


def test_few_of_many_points_are_looked_at(monkeypatch):
    """Bounds that are asked for at a place: a few boxes a level, of two thousand boxes."""
    rng = np.random.default_rng(3)
    points = rng.random((16_000, 2))
    asked = []

    def counted(*args):
        asked.append(args[1])
        return bound(*args)

    bound = nearest._bound.py_func
    monkeypatch.setattr(nearest, "_bound", counted)
    boxes = size_boxes(points, np.full(len(points), 0.01))
    places = rng.random((20, 2))
    nearest.least_sizes.py_func(places, 1.0, 0.2, *boxes)
    assert len(asked) < 400 * len(places)


@pytest.mark.parametrize("kind", ["fair", "best"])
def test_a_border_of_thousands_of_points_is_meshed(kind):
    turn = np.linspace(0, 2 * np.pi, 20_000)
    points = 0.5 + 0.25 * np.column_stack([np.cos(turn), np.sin(turn)])
    field = SizeField(points, np.full(len(points), 0.03))
    mesh = panel_mesh([[0, 0], [1, 0], [1, 1], [0, 1]], edge=0.1, sizes=field, quality=kind)
    assert mesh_fault(mesh.vertices, mesh.faces, mesh.boundary) is None
    steps = np.hypot(*(mesh.vertices[mesh.faces] - mesh.vertices[np.roll(mesh.faces, -1, axis=1)]).T)
    middle = mesh.vertices[mesh.faces].mean(axis=1)
    near = np.abs(np.hypot(*(middle - 0.5).T) - 0.25) < 0.02
    assert steps[:, near].mean() < 0.04
