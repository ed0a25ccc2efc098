"""Growth triangulation: exactly Delaunay, whole, alike in any order; against the naive oracle and scipy."""

import numpy as np
import pytest
from exact_delaunay import delaunay_faults
from naive_growth import grow_naive
from scipy.spatial import ConvexHull, Delaunay

from sim_core.errors import OutlineError
from sim_core.mesh import panel_mesh, triangulate
from sim_core.mesh.measures import triangle_areas
from sim_core.mesh.outline import signed_area


def triangles(faces) -> set:
    return {tuple(np.roll(face, -int(np.argmin(face))).tolist()) for face in np.asarray(faces)}


def turned(points, degrees: float):
    t = np.radians(degrees)
    return points @ np.array([[np.cos(t), np.sin(t)], [-np.sin(t), np.cos(t)]])


def square_lattice(n: int) -> np.ndarray:
    return np.stack(np.meshgrid(np.arange(n), np.arange(n)), axis=-1).reshape(-1, 2).astype(float)


def hexagonal_lattice(n: int) -> np.ndarray:
    points = square_lattice(n)
    return np.column_stack([points[:, 0] - (points[:, 1] % 2) / 2, points[:, 1] * np.sqrt(0.75)])


def circle(n: int, radius: float = 1.0) -> np.ndarray:
    t = np.arange(n) * 2 * np.pi / n
    return radius * np.column_stack([np.cos(t), np.sin(t)])


def assert_whole(points, faces) -> None:
    """Exactly Delaunay, every different point used, Euler's formula, and the area of the convex hull."""
    assert delaunay_faults(points, faces) == []
    different = len(np.unique(points, axis=0))
    assert len(np.unique(faces)) == different
    ahead = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    edges = len(np.unique(np.sort(ahead, axis=1), axis=0))
    assert different - edges + len(faces) == 1
    hull = ConvexHull(points - points.mean(axis=0)).volume
    assert triangle_areas(points, faces).sum() == pytest.approx(hull, rel=1e-9)


CLOUDS = {
    "square lattice": square_lattice(30),
    "square lattice far off": square_lattice(30) + 1e3,
    "square lattice turned": turned(square_lattice(30), 30),
    "square lattice turned far off": turned(square_lattice(30), 10.7) + 1e3,
    "square lattice turned by 45 degrees": turned(square_lattice(20), 45),
    "hexagonal lattice": hexagonal_lattice(30),
    "hexagonal lattice turned far off": turned(hexagonal_lattice(30), 17) * 0.01 + 1e3,
    "tenths": square_lattice(25) * 0.1,
    "circle": circle(64),
    "circle far off": circle(300) + 1e3,
    "circle of 1000": circle(1000, 0.3),
    "two circles and their centre": np.vstack([circle(90), circle(90, 0.5), [[0, 0]]]),
    "strip": np.random.default_rng(1).random((400, 2)) * (1, 1e-6),
    "pairs 1e-9 apart": np.repeat(np.random.default_rng(2).random((200, 2)), 2, axis=0)
    + np.tile([[0, 0], [1e-9, 0]], (200, 1)),
    "pairs of neighbouring floats": np.vstack(
        [p := np.random.default_rng(3).random((200, 2)), np.nextafter(p, 2)]
    ),
    "nearly one line": np.column_stack([x := np.linspace(0, 1, 300), 1e-15 * np.sin(40 * x)]),
    "two far clusters": np.random.default_rng(4).random((300, 2))
    + np.repeat([[0, 0], [1e6, 1e5]], 150, axis=0),
    "one point far away": np.vstack([np.random.default_rng(5).random((300, 2)), [[1e5, 1e5]]]),
    "generic": np.random.default_rng(6).random((1000, 2)) - 0.5,
    "sizes from 1e-30": np.random.default_rng(7).random((200, 2))
    * 10.0 ** -np.random.default_rng(8).integers(0, 30, (200, 1)),
}


@pytest.mark.parametrize("name", CLOUDS)
def test_every_cloud_is_whole_and_exactly_delaunay(name):
    points = CLOUDS[name]
    assert_whole(points, triangulate(points))


@pytest.mark.parametrize("name", CLOUDS)
def test_order_of_the_points_does_not_matter_even_in_ties(name):
    points = CLOUDS[name]
    shuffle = np.random.default_rng(9).permutation(len(points))
    assert triangles(shuffle[triangulate(points[shuffle])]) == triangles(triangulate(points))


@pytest.mark.parametrize("seed", range(40))
def test_small_clouds_of_neighbouring_floats(seed):
    """The first edge too is chosen exactly: many points are nearest but for rounding."""
    rng = np.random.default_rng(seed)
    points = np.concatenate([[[0.1, 0.1]], 0.1 + rng.random((6, 2))])
    points = np.concatenate([points, np.nextafter(points, 2), np.nextafter(points[:, ::-1], 0)])
    assert_whole(points, triangulate(points))


def same_up_to_ties(points, faces, others) -> bool:
    """Whether two triangulations differ in nothing but how cocircular polygons are cut (both are whole)."""
    assert_whole(points, faces)
    assert_whole(points, others)
    return len(faces) == len(others)


@pytest.mark.nightly
@pytest.mark.parametrize("name", CLOUDS)
def test_commutes_with_quarter_turns_and_mirroring(name):
    points = CLOUDS[name]
    faces = triangulate(points)
    for moved, flip in (
        (points[:, ::-1] * (1, -1), 1),
        (points * (-1, -1), 1),
        (points * (-1, 1), -1),
        (points[:, ::-1].copy(), -1),
    ):
        others = triangulate(moved)[:, ::flip]
        if name in ("generic", "strip", "sizes from 1e-30"):
            assert triangles(others) == triangles(faces)
        assert same_up_to_ties(points, faces, others)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("n", [3, 4, 10, 300])
def test_equals_the_naive_form_of_eq_9(n, seed):
    points = np.random.default_rng(seed).random((n, 2))
    assert triangles(triangulate(points)) == triangles(grow_naive(points))


@pytest.mark.slow
def test_equals_the_naive_form_of_eq_9_on_6000_points():
    points = np.random.default_rng(11).random((6000, 2))
    assert triangles(triangulate(points)) == triangles(grow_naive(points))


OUTLINES = {
    "rectangle": ([[0, 0], [1, 0], [1, 0.7], [0, 0.7]], ()),
    "round hole": ([[0.2, 0], [0.8, 0], [1, 0.9], [0, 0.9]], (circle(64, 0.15) + (0.5, 0.45),)),
    "concave": ([[0, 0], [0.7, 0.02], [0.7, 0.3], [0.35, 0.32], [0.26, 0.4], [0.38, 1.2], [0, 1.22]], ()),
}


@pytest.mark.parametrize("edge", [0.03, pytest.param(0.012, marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", OUTLINES)
def test_equals_the_naive_form_of_eq_9_within_outlines(name, edge):
    """From the outline inward on the points of a panel, many of them in ties: the same but for how ties are cut."""
    outline, holes = OUTLINES[name]
    mesh = panel_mesh(outline, edge=edge, holes=holes, quality="fair")
    steps = np.concatenate([np.column_stack([loop, np.roll(loop, -1)]) for loop in mesh.boundary])
    ours, naive = triangulate(mesh.vertices, steps), grow_naive(mesh.vertices, steps)
    assert triangles(ours) == triangles(mesh.faces)
    assert (
        delaunay_faults(mesh.vertices, ours, steps) == []
    )  # the naive form is rounded: it takes near ties for ties
    for faces in (ours, naive):
        assert triangle_areas(mesh.vertices, faces).min() > 0
        assert triangle_areas(mesh.vertices, faces).sum() == pytest.approx(
            sum(signed_area(mesh.vertices[loop]) for loop in mesh.boundary), rel=1e-12
        )
    assert len(ours) == len(naive)


def test_equals_scipy_delaunay_on_generic_points():
    points = np.random.default_rng(5).random((2000, 2))
    ours = {tuple(sorted(face)) for face in triangulate(points).tolist()}
    assert ours == {tuple(sorted(face)) for face in Delaunay(points).simplices.tolist()}


@pytest.mark.parametrize("order", ["rows", "shuffled"])
@pytest.mark.parametrize("move", [0.0, 1e3])
def test_square_lattice_is_tiled_exactly(order, move):
    points = square_lattice(40) + move
    if order == "shuffled":
        np.random.default_rng(6).shuffle(points)
    faces = triangulate(points)
    assert len(faces) == 3042
    assert triangle_areas(points, faces).min() == 0.5
    assert triangle_areas(points, faces).sum() == 39**2


def test_a_tie_is_cut_as_a_fan_from_the_first_point_in_growth_order():
    x, y = np.meshgrid(np.arange(-65, 66), np.arange(-65, 66))
    on = x**2 + y**2 == 65**2
    points = np.column_stack([x[on], y[on]]).astype(float)
    faces = triangulate(points)
    assert len(points) == 36
    assert len(faces) == 34
    common = set(faces[0].tolist()).intersection(*map(set, faces.tolist()))
    assert len(common) == 1  # every triangle has the same first point
    assert triangle_areas(points, faces).sum() == pytest.approx(ConvexHull(points).volume, rel=1e-14)


def test_equal_points_count_once_and_the_first_of_them_stands():
    points = np.random.default_rng(7).random((200, 2))
    doubled = np.concatenate([points, points[:50], points[:3]])
    assert triangles(triangulate(doubled)) == triangles(triangulate(points))
    signed = np.vstack([[[0.0, 0.0]], points, [[-0.0, 0.0]]])  # -0.0 and 0.0 are one place
    assert triangles(triangulate(signed)) == triangles(triangulate(signed[:-1]))


@pytest.mark.parametrize(
    "points",
    [
        np.zeros((0, 2)),
        np.zeros((5, 2)),
        np.zeros((2000, 2)),
        [[0, 0], [1, 0]],
        [[0, 0], [1, 0], [0, 0], [1, 0]],
    ],
)
def test_too_few_points_are_named(points):
    with pytest.raises(OutlineError, match="a triangle needs three"):
        triangulate(np.array(points, dtype=float))


@pytest.mark.parametrize("odd", [np.nan, np.inf, 1e70, 1e-70])
def test_points_out_of_range_are_named(odd):
    with pytest.raises(OutlineError, match="point 2 is"):
        triangulate(np.array([[0, 0], [1, 0], [0, odd], [1, 1]]))


@pytest.mark.parametrize("edges", [[[0, 5]], [[-1, 0]], [0, 1], [[0.5, 1]]])
def test_edges_out_of_range_are_named(edges):
    with pytest.raises(OutlineError, match="edges: give"):
        triangulate(np.array([[0.0, 0], [1, 0], [0, 1], [1, 1]]), np.array(edges))


def test_shape_is_named():
    with pytest.raises(OutlineError, match="shape"):
        triangulate(np.zeros((4, 3)))


def test_points_on_one_line_give_no_triangle():
    assert len(triangulate(np.column_stack([np.arange(5.0), np.zeros(5)]))) == 0


def test_edges_that_leave_a_gap_do_not_close():
    square = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
    with pytest.raises(OutlineError, match="does not close"):
        triangulate(square, np.array([[0, 1], [1, 2]]))


def test_inner_lines_that_are_not_delaunay_are_kept():
    """A long line through a cloud: constrained Delaunay, every inner edge but the line locally Delaunay."""
    rng = np.random.default_rng(12)
    cloud = rng.random((400, 2)) * 0.98 + 0.01
    cloud = cloud[np.abs(cloud[:, 1] - 0.5 - 0.1 * cloud[:, 0]) > 1e-3]
    frame = np.array([[0.0, 0], [0, 1], [1, 1], [1, 0]])  # cloth on the left in (x, -y)
    line = np.array([[0.02, 0.502], [0.97, 0.597]])
    points = np.vstack([frame, line, cloud])
    loop = np.array([[0, 1], [1, 2], [2, 3], [3, 0]])
    faces = triangulate(points, np.vstack([loop, [[4, 5], [5, 4]]]))
    assert delaunay_faults(points, faces, np.vstack([loop, [[4, 5]]])) == []
    assert triangle_areas(points, faces).sum() == pytest.approx(1.0, rel=1e-12)
    edges = {tuple(sorted(e)) for f in faces.tolist() for e in ((f[0], f[1]), (f[1], f[2]), (f[2], f[0]))}
    assert (4, 5) in edges
    assert (4, 5) not in {
        tuple(sorted(e))
        for f in triangulate(points).tolist()
        for e in ((f[0], f[1]), (f[1], f[2]), (f[2], f[0]))
    }  # it is no Delaunay edge, so the line did the work
