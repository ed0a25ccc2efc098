"""Thinning: flat cloth loses its triangles, borders and seams keep their lines, folds keep their shape."""

import numpy as np
import pytest

from sim_core import metrics
from sim_core.errors import SimCoreError
from sim_core.garment.levels import Thinning
from sim_core.mesh import panel_mesh


def square(edge: float = 0.05) -> tuple[np.ndarray, np.ndarray]:
    mesh = panel_mesh(np.array([[0, 0], [1, 0], [1, 1], [0, 1]], float), edge=edge)
    return mesh.vertices, mesh.faces.astype(np.int32)


def draped(flat: np.ndarray, height) -> np.ndarray:
    return np.column_stack([flat[:, 0], -flat[:, 1], height])


def area_in_pattern(flat: np.ndarray, faces: np.ndarray) -> np.ndarray:
    a, b, c = (flat[faces[:, k]] for k in range(3))
    u, v = b - a, c - a
    return 0.5 * (u[:, 1] * v[:, 0] - u[:, 0] * v[:, 1])


def test_a_flat_square_needs_few_triangles_and_keeps_its_outline() -> None:
    flat, faces = square()
    mesh = Thinning(draped(flat, np.zeros(len(flat))), faces, np.arange(len(flat)), flat)
    mesh.to(12)
    left = mesh.faces()
    assert mesh.count == len(left) <= 12
    area = area_in_pattern(flat, left)
    assert area.min() > 0
    assert area.sum() == pytest.approx(1.0, abs=1e-12)
    assert len(mesh.numbers()) == len(left)


def test_folds_are_kept_where_they_are() -> None:
    flat, faces = square(0.03)
    x = draped(flat, 0.03 * np.sin(14 * flat[:, 0]) * flat[:, 1])
    mesh = Thinning(x, faces, np.arange(len(flat)), flat)
    seen = []
    for count in (1200, 600, 300):
        mesh.to(count)
        left = mesh.faces()
        apart = metrics.hausdorff(x, faces, x, left, spacing=0.01)
        seen.append(apart.p99)
        assert area_in_pattern(flat, left).sum() == pytest.approx(1.0, abs=1e-9)
    assert seen == sorted(seen)
    assert seen[-1] < 0.0015  # a vertex takes over the planes of those that slid onto it


def test_what_hangs_flat_keeps_its_triangles_where_it_is_bent_a_moment_later() -> None:
    flat, faces = square(0.03)
    still = draped(flat, np.zeros(len(flat)))
    bent = [
        draped(flat, 0.2 * np.maximum(0.0, 0.15 - np.abs(flat[:, 0] - at))) for at in (0.3, 0.7)
    ]  # over a knee, here or there
    apart = {}
    for name, moments in (("still", []), ("moving", bent)):
        mesh = Thinning(still, faces, np.arange(len(flat)), flat, moments=moments)
        mesh.to(60)
        assert area_in_pattern(flat, mesh.faces()).sum() == pytest.approx(1.0, abs=1e-9)
        apart[name] = max(metrics.hausdorff(x, faces, x, mesh.faces(), spacing=0.01).p99 for x in bent)
    assert apart["still"] > 0.02
    assert apart["moving"] < 0.25 * apart["still"]


@pytest.mark.parametrize("wrong", [lambda x: x[:-1], lambda x: np.full_like(x, np.nan), lambda x: x[:, :2]])
def test_a_moment_of_another_mesh_is_refused(wrong) -> None:
    flat, faces = square()
    x = draped(flat, np.zeros(len(flat)))
    with pytest.raises(SimCoreError, match=r"moments\[1\]"):
        Thinning(x, faces, np.arange(len(flat)), flat, moments=[x, wrong(x)])


def test_twins_of_a_seam_stay_together() -> None:
    """Two halves with coordinates of their own, welded along a slanting seam and folded there."""
    left = panel_mesh(np.array([[0, 0], [0.5, 0], [0.6, 1], [0, 1]], float), edge=0.05)
    turn = left.vertices * [-1, 1] + [1.1, 0]
    shift = np.array([3.0, 0.0])
    pattern = np.concatenate([left.vertices, turn + shift])
    faces = np.concatenate([left.faces, left.faces[:, [0, 2, 1]] + len(turn)]).astype(np.int32)
    x = np.concatenate([draped(left.vertices, 0 * turn[:, 0]), draped(left.vertices, -0.4 * turn[:, 0])])
    x[len(turn) :, 0] = turn[:, 0]
    on = np.flatnonzero(np.abs(left.vertices[:, 0] - 0.5 - 0.1 * left.vertices[:, 1]) < 1e-9)
    weld = np.arange(2 * len(turn))
    weld[on + len(turn)] = on
    weld = np.unique(weld, return_inverse=True)[1].reshape(-1)
    vertices = np.zeros((weld.max() + 1, 3))
    vertices[weld[::-1]] = x[::-1]
    mesh = Thinning(vertices, faces, weld, pattern)
    mesh.to(30)
    kept = mesh.faces()
    area = area_in_pattern(pattern, kept)
    assert area.min() > 0
    assert area.sum() == pytest.approx(1.1, abs=1e-9)
    welded = np.sort(weld[kept][:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    edges, uses = np.unique(welded, axis=0, return_counts=True)
    assert uses.max() == 2
    seam = np.isin(edges, weld[on]).all(1) & (uses == 2)
    assert seam.any()  # the two halves still hang together


def test_fixed_vertices_stay() -> None:
    flat, faces = square(0.1)
    fixed = np.zeros(len(flat), bool)
    fixed[::3] = True
    mesh = Thinning(draped(flat, np.zeros(len(flat))), faces, np.arange(len(flat)), flat, fixed)
    mesh.to(2)
    assert np.isin(np.flatnonzero(fixed), mesh.faces()).all()


@pytest.mark.parametrize("triangles", [400, 60, 12])
@pytest.mark.parametrize("in_pattern", [True, False])
def test_no_face_becomes_a_needle_or_turns_over(triangles: int, in_pattern: bool) -> None:
    """Also where no pattern tells which side is up, as on a figure."""
    flat, faces = square()
    x = draped(flat, np.zeros(len(flat)))
    mesh = Thinning(x, faces, np.arange(len(flat)), flat if in_pattern else None)
    mesh.to(triangles)
    a, b, c = (x[mesh.faces()[:, k]] for k in range(3))
    twice = np.cross(b - a, c - a)[:, 2]
    longest = np.max([((p - q) ** 2).sum(1) for p, q in ((a, b), (b, c), (c, a))], axis=0)
    assert (0.5 * twice / longest).min() >= 0.05
    assert twice.sum() / 2 == pytest.approx(1.0, abs=1e-12)
    assert mesh.count <= triangles
