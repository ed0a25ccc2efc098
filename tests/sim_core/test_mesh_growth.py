"""Growth triangulation: against the naive oracle, scipy's Delaunay, and the degenerate table."""

import numpy as np
import pytest
from scipy.spatial import Delaunay

from sim_core.errors import OutlineError
from sim_core.mesh import grow
from sim_core.mesh.naive import grow_naive
from sim_core.mesh.quality import triangle_areas


def triangles(faces) -> set:
    return {tuple(np.roll(face, -int(np.argmin(face)))) for face in np.asarray(faces)}


def hull_area(points) -> float:
    from scipy.spatial import ConvexHull

    return float(ConvexHull(points).volume)


def square_lattice(n: int) -> np.ndarray:
    return np.stack(np.meshgrid(np.arange(n), np.arange(n)), axis=-1).reshape(-1, 2).astype(float)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("n", [3, 4, 10, 300])
def test_equals_the_naive_form_of_eq_9(n, seed):
    points = np.random.default_rng(seed).random((n, 2))
    assert triangles(grow(points)) == triangles(grow_naive(points))


def test_equals_scipy_delaunay_on_generic_points():
    points = np.random.default_rng(5).random((2000, 2))
    faces = grow(points)
    ours = {tuple(sorted(face)) for face in faces.tolist()}
    assert ours == {tuple(sorted(face)) for face in Delaunay(points).simplices.tolist()}
    assert triangle_areas(points, faces).min() > 0


@pytest.mark.parametrize("order", ["rows", "shuffled"])
@pytest.mark.parametrize("move", [0.0, 1e3])
def test_square_lattice_is_tiled_exactly(order, move):
    points = square_lattice(40) + move
    if order == "shuffled":
        np.random.default_rng(6).shuffle(points)
    faces = grow(points)
    assert len(faces) == 3042
    assert triangle_areas(points, faces).min() == 0.5
    assert triangle_areas(points, faces).sum() == 39**2


@pytest.mark.parametrize("degrees", [1.0, 30.0, 45.0])
def test_turned_square_lattice_is_tiled(degrees):
    t = np.radians(degrees)
    points = square_lattice(40) @ np.array([[np.cos(t), np.sin(t)], [-np.sin(t), np.cos(t)]])
    areas = triangle_areas(points, grow(points))
    solid = (
        areas > 1e-4
    )  # rounding bends the sides of the turned square: slivers of 1e-6 may stand along them
    assert solid.sum() == 3042
    assert abs(areas).sum() == pytest.approx(39**2, rel=1e-6)


def test_cocircular_points_make_a_fan_without_overlap():
    t = np.arange(64) * 2 * np.pi / 64
    points = np.column_stack([np.cos(t), np.sin(t)])
    faces = grow(points)
    assert len(faces) == 62
    assert triangle_areas(points, faces).sum() == pytest.approx(hull_area(points), rel=1e-12)


def test_exactly_cocircular_whole_points():
    x, y = np.meshgrid(np.arange(-65, 66), np.arange(-65, 66))
    on = x**2 + y**2 == 65**2
    points = np.column_stack([x[on], y[on]]).astype(float)
    faces = grow(points)
    assert len(points) == 36
    assert len(faces) == 34
    assert triangle_areas(points, faces).min() > 0
    assert triangle_areas(points, faces).sum() == pytest.approx(hull_area(points), rel=1e-14)


@pytest.mark.parametrize("gap", [0.0, 1e-9])
def test_duplicates_count_once(gap):
    points = np.random.default_rng(7).random((200, 2))
    doubled = np.concatenate([points, points[:50] + gap])
    assert triangles(grow(doubled)) == triangles(grow(points))


def test_index_order_and_quarter_turn_do_not_change_the_triangles():
    rng = np.random.default_rng(8)
    points = rng.random((500, 2))
    wanted = triangles(grow(points))
    shuffle = rng.permutation(500)
    assert triangles(shuffle[grow(points[shuffle])]) == wanted
    assert triangles(grow(points[:, ::-1] * (1, -1))) == wanted
    mirrored = grow(points * (-1, 1))[:, ::-1]
    assert triangles(mirrored) == wanted


@pytest.mark.parametrize("points", [np.zeros((0, 2)), np.zeros((5, 2)), [[0, 0], [1, 0]]])
def test_too_few_points_are_named(points):
    with pytest.raises(OutlineError, match="a triangle needs three"):
        grow(np.array(points, dtype=float))


def test_points_on_one_line_give_no_triangle():
    assert len(grow(np.column_stack([np.arange(5.0), np.zeros(5)]))) == 0
