"""The published measures against shapes whose answer is known."""

import numpy as np
import pytest
import trimesh

from sim_core import metrics
from sim_core.cloth.scenes import equilateral_sheet
from sim_core.errors import SimCoreError


def plane(height: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    rest, faces = equilateral_sheet(1.0, 1.0, 0.1)
    return np.column_stack([rest[:, 0], np.full(len(rest), height), rest[:, 1]]), faces


def test_hausdorff_of_parallel_planes_is_their_distance() -> None:
    (a, f), (b, g) = plane(), plane(0.03)
    apart = metrics.hausdorff(a, f, b, g, spacing=0.02)
    assert (apart.mean, apart.p99, apart.max) == pytest.approx((0.03, 0.03, 0.03), abs=1e-12)
    assert metrics.hausdorff(a, f, a, f, spacing=0.02).max < 1e-12


def test_hausdorff_sees_a_single_spike_from_its_side() -> None:
    a, f = plane()
    b = a.copy()
    b[60, 1] = 0.2
    apart = metrics.hausdorff(a, f, b, f, spacing=0.01)
    assert apart.b_to_a[2] == pytest.approx(0.2, abs=1e-9)
    assert apart.a_to_b[2] < 0.2
    assert apart.max == apart.b_to_a[2]


def test_surface_distance_is_exact_for_mixed_face_sizes() -> None:
    box = trimesh.creation.box((1.0, 2.0, 3.0))
    fine = trimesh.creation.icosphere(subdivisions=3, radius=0.2).apply_translation([2.0, 0, 0])
    both = trimesh.Trimesh(
        np.vstack([box.vertices, fine.vertices]),
        np.vstack([box.faces, fine.faces + len(box.vertices)]),
        process=False,
    )
    points = np.random.default_rng(1).uniform(-3, 3, (120, 3))
    triangles = np.asarray(both.triangles)
    nearest = [
        trimesh.triangles.closest_point(triangles, np.repeat(p[None], len(triangles), 0)) for p in points
    ]
    expected = [np.linalg.norm(near - p, axis=1).min() for near, p in zip(nearest, points, strict=True)]
    vertices, faces = np.asarray(both.vertices), np.asarray(both.faces)
    assert metrics.surface_distance(points, vertices, faces) == pytest.approx(expected, abs=1e-9)
    capped = metrics.surface_distance(points, vertices, faces, limit=0.8)
    assert capped == pytest.approx(np.minimum(expected, 0.8), abs=1e-9)


def test_penetration_counts_vertices_midpoints_and_centroids() -> None:
    ball = trimesh.creation.icosphere(subdivisions=3, radius=0.1)
    triangle = np.array([[-1.0, 0, 0], [1.0, 0, 0], [0, 0, 2.0]])
    hit = metrics.penetration(triangle, np.array([[0, 1, 2]]), ball.vertices, ball.faces)
    assert (hit.vertices, hit.midpoints, hit.centroids) == (0, 1, 0)
    assert hit.total == 1
    assert hit.edges > 10  # half the ball's girth is cut by the triangle
    assert hit.clearance[1] == pytest.approx(-0.1, abs=2e-3)
    away = metrics.penetration(triangle + [0, 0.2, 0], np.array([[0, 1, 2]]), ball.vertices, ball.faces)
    assert away.total == 0
    assert away.clearance[1] == pytest.approx(0.1, abs=2e-3)
    assert away.clearance[0] == metrics.FAR


def test_penetration_counts_a_thumb_between_the_points_that_are_looked_at() -> None:
    cloth, face = np.array([[-0.1, 0, 0], [0.1, 0, 0], [0, 0, 0.2]]), np.array([[0, 1, 2]])
    thumb = trimesh.creation.icosphere(subdivisions=2, radius=0.01)
    for at, through in (((0.05, 0.0, 0.04), True), ((0.05, 0.0101, 0.04), False)):
        hit = metrics.penetration(cloth, face, np.asarray(thumb.vertices) + at, thumb.faces)
        assert (hit.vertices, hit.midpoints, hit.centroids) == (0, 0, 0)
        assert (hit.edges > 0) == through


def turned(rng: np.random.Generator, open_at: int) -> tuple[np.ndarray, np.ndarray]:
    """A dented ball of radius .1 m, without its last `open_at` faces."""
    ball = trimesh.creation.icosphere(subdivisions=3, radius=0.1)
    dents = 1 + 0.1 * rng.standard_normal((len(ball.vertices), 1))
    return np.asarray(ball.vertices) * dents, np.asarray(ball.faces)[: len(ball.faces) - open_at]


@pytest.mark.parametrize("open_at", [0, 3])
def test_inside_is_where_the_winding_number_says_so(open_at: int) -> None:
    """Rays through a closed mesh and solid angles of an open one, also where two solids overlap."""
    rng = np.random.default_rng(5)
    vertices, faces = turned(rng, open_at)
    points = rng.uniform(-0.15, 0.2, (900, 3))
    cloth = np.arange(900).reshape(-1, 3)
    both = (
        np.concatenate([vertices, vertices + [0.08, 0.01, 0]]),
        np.concatenate([faces, faces + len(vertices)]),
    )
    found = metrics.penetration(points, cloth, *both)
    inside = metrics.winding(points, vertices, faces) > 0.5
    other = metrics.winding(points - [0.08, 0.01, 0], vertices, faces) > 0.5
    assert found.vertices == (inside | other).sum() > 100


def test_area_strain_of_a_scaled_sheet() -> None:
    rest, faces = equilateral_sheet(0.3, 0.2, 0.05)
    bigger = np.column_stack([rest[:, 0] * 1.1, rest[:, 1] * 0.9, np.zeros(len(rest))])
    assert metrics.area_strain(rest, bigger, faces) == pytest.approx(
        np.full(len(faces), 1.1 * 0.9 - 1), abs=1e-12
    )


def test_intersections_are_counted() -> None:
    v = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.2, 0.2, -1], [0.2, 0.2, 1], [2, 2, 0.5]], float)
    crossing = np.array([[0, 1, 2], [3, 4, 5]])
    assert metrics.intersections(v, crossing) == 2
    v[3:, :2] += 5
    assert metrics.intersections(v, crossing) == 0
    assert metrics.intersections(*plane()) == 0


def test_bad_meshes_are_named() -> None:
    a, f = plane()
    with pytest.raises(SimCoreError, match="shapes"):
        metrics.surface_distance(a, a[:, :2], f)
    with pytest.raises(SimCoreError, match="not finite"):
        metrics.intersections(np.full_like(a, np.nan), f)
    with pytest.raises(SimCoreError, match="name no vertex"):
        metrics.intersections(a, f + len(a))


def test_components_are_numbered_in_the_order_of_their_first():
    found = metrics.components(6, np.array([4, 2, 5]), np.array([1, 5, 5]))
    assert found.tolist() == [0, 1, 2, 3, 1, 2]
    assert found.dtype == np.int32
    assert metrics.components(2, np.zeros(0, int), np.zeros(0, int)).tolist() == [0, 1]
