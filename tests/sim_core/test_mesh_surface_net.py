"""Surface nets on a ball: closed, wound outward, near the ball, mirrored where the samples are."""

from __future__ import annotations

import numpy as np
import pytest

from sim_core.mesh.geometry import split_quads, surface_net


@pytest.fixture(scope="module")
def ball() -> tuple[np.ndarray, np.ndarray]:
    half = np.r_[np.linspace(0, 0.5, 12), 0.58, 0.7]
    axes = (np.r_[-half[:0:-1], half], np.linspace(-0.7, 0.7, 30), np.linspace(-0.71, 0.73, 27))
    x, y, z = np.meshgrid(*axes, indexing="ij")
    return surface_net(np.sqrt(x * x + y * y + z * z) - 0.5, axes)


def test_the_net_is_closed_and_wound_outward(ball) -> None:
    vertices, quads = ball
    faces = split_quads(vertices, quads)
    assert len(faces) == 2 * len(quads)
    ahead = faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2).astype(np.int64)
    there, back = (ahead[:, k] * len(vertices) + ahead[:, 1 - k] for k in (0, 1))
    assert len(np.unique(there)) == len(there)
    assert np.array_equal(np.sort(there), np.sort(back))
    assert len(vertices) - 3 * len(faces) // 2 + len(faces) == 2
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    assert (a * np.cross(b, c)).sum() / 6 == pytest.approx(4 / 3 * np.pi * 0.125, rel=0.03)


def test_the_net_lies_within_a_fraction_of_a_cell_and_is_mirrored(ball) -> None:
    vertices, _ = ball
    assert np.abs(np.linalg.norm(vertices, axis=1) - 0.5).max() < 0.012
    turned = vertices * [-1.0, 1.0, 1.0]
    order = [np.lexsort(np.round(v, 9).T) for v in (vertices, turned)]
    assert np.allclose(vertices[order[0]], turned[order[1]], atol=1e-9)
