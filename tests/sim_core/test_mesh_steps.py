"""The public steps before growth: outline samples, staggered points, inside, redundant points."""

import numpy as np
import pytest

from sim_core.mesh import inside, keep_points, quality, sampled_contours, staggered_points

SQUARE = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
CIRCLE = np.column_stack([np.cos(t := np.arange(200) * np.pi / 100), np.sin(t)])


def test_samples_keep_corners_and_step_at_most_the_edge():
    (samples,) = sampled_contours([SQUARE], 0.3)
    assert len(samples) == 16
    assert {tuple(p) for p in SQUARE} <= {tuple(p) for p in samples}
    steps = np.hypot(*(np.roll(samples, -1, axis=0) - samples).T)
    np.testing.assert_allclose(steps, 0.25, rtol=1e-12)


def test_samples_of_a_smooth_curve_are_even():
    (samples,) = sampled_contours([CIRCLE], 0.2)
    steps = np.hypot(*(np.roll(samples, -1, axis=0) - samples).T)
    assert len(samples) == 32
    assert np.ptp(steps) < 1e-4
    assert steps.max() <= 0.2


def test_lattice_is_equilateral_and_staggered_by_row():
    points = staggered_points(np.array([2.0, 3.0]), np.array([4.0, 5.0]), 0.5)
    np.testing.assert_allclose(points[:5, 0], [2, 2.5, 3, 3.5, 4])  # Eq. 1
    np.testing.assert_allclose(points[:5, 1], 3)  # Eq. 2
    second = points[np.isclose(points[:, 1], 3 + 0.5 * np.sqrt(3) / 2)]  # Eq. 4, 6
    np.testing.assert_allclose(second[:3, 0], [1.75, 2.25, 2.75])  # Eq. 3, 5
    gaps = np.sqrt(((points[:, None] - points) ** 2).sum(axis=2))
    assert gaps[gaps > 0].min() == pytest.approx(0.5, rel=1e-12)


def test_ray_through_corners_counts_once():
    diamond = np.array([[0.0, -1], [1, 0], [0, 1], [-1, 0]])
    points = np.array([[0, 0], [-0.5, 0], [-2, 0], [-1, -1], [-1, 1], [0.999, 0]])
    assert inside(points, [diamond]).tolist() == [True, True, False, False, False, True]


@pytest.mark.parametrize("turn", [1, -1])
def test_points_on_the_outline_are_redundant(turn):
    on = np.array([[0, 0], [0.25, 0], [1, 0.5], [0.3, 1], [0, 0.9]])
    assert not inside(on, [SQUARE[::turn]]).any()
    assert inside(np.array([[2.0**-20, 2.0**-20]]), [SQUARE[::turn]]).all()


def test_holes_are_outside():
    hole = 0.5 + 0.2 * CIRCLE
    points = np.random.default_rng(0).random((4000, 2))
    far = np.hypot(*(points - 0.5).T)
    clear = np.abs(far - 0.2) > 1e-3
    np.testing.assert_array_equal(inside(points, [SQUARE, hole])[clear], (far > 0.2)[clear])


def test_inside_agrees_with_winding_number_on_a_star():
    rng = np.random.default_rng(1)
    angle = np.arange(60) * 2 * np.pi / 60
    star = np.column_stack([np.cos(angle), np.sin(angle)]) * rng.uniform(0.3, 1, 60)[:, None]
    points = rng.uniform(-1, 1, (1000, 2))
    a = star[None] - points[:, None]
    b = np.roll(a, -1, axis=1)
    turn = np.arctan2(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0], (a * b).sum(axis=2)).sum(axis=1)
    np.testing.assert_array_equal(inside(points, [star]), np.abs(turn) > 1)


def test_kept_points_stay_off_the_outline():
    edge, threshold = 0.05, 0.7
    samples = sampled_contours([SQUARE], edge)
    lattice = staggered_points(SQUARE.min(axis=0), SQUARE.max(axis=0), edge)
    kept = keep_points(lattice, samples, edge=edge, threshold=threshold)
    clearance = np.minimum(kept, 1 - kept).min(axis=1)
    assert clearance.min() >= threshold * edge
    wanted = np.minimum(lattice, 1 - lattice).min(axis=1) >= threshold * edge
    assert len(kept) == wanted.sum()


def test_quality_of_known_triangles():
    vertices = np.array([[0, 0], [1, 0], [0.5, -np.sqrt(3) / 2], [0, -1], [2, 0]])
    angle, shape, ratio = quality(vertices, np.array([[0, 1, 2], [0, 1, 3], [0, 1, 4]]))
    np.testing.assert_allclose(angle, [60, 45, 0], atol=1e-9)
    np.testing.assert_allclose(shape, [1, np.sqrt(3) / 2, 0], atol=1e-12)
    np.testing.assert_allclose(ratio[:2], [1, 1 / np.sqrt(2)])


def foreign_in_circles(samples: list[np.ndarray]) -> np.ndarray:
    """Lengths of the steps whose diametral circle holds a sample other than their own ends and the next ones."""
    points, lengths = np.concatenate(samples), []
    for loop in samples:
        for k, point in enumerate(loop):
            ahead = loop[(k + 1) % len(loop)]
            own = [loop[k - 1], point, ahead, loop[(k + 2) % len(loop)]]
            near = points[
                np.hypot(*(points - (point + ahead) / 2).T) < np.hypot(*(ahead - point)) / 2 * (1 - 1e-9)
            ]
            if any(not any(np.array_equal(p, q) for q in own) for p in near):
                lengths.append(np.hypot(*(ahead - point)))
    return np.array(lengths)


def even_steps(polygon: np.ndarray, edge: float) -> np.ndarray:
    """The corners of a polygon (n, 2), and even steps of at most `edge` on its sides."""
    sides = zip(polygon, np.roll(polygon, -1, axis=0), strict=True)
    counts = [(a, b, int(np.ceil(np.hypot(*(b - a)) / edge))) for a, b in sides]
    return np.concatenate([a + (b - a) * np.arange(n)[:, None] / n for a, b, n in counts])


@pytest.mark.parametrize("gap", [0.09, 0.06, 0.03])
def test_steps_are_halved_where_contours_run_close(gap):
    """A panel with a slot of width `gap`, and a hole as near to its border."""
    x = 0.43
    outline = np.array([[0, 0], [1, 0], [1, 1], [x + gap, 1], [x + gap, 0.2], [x, 0.25], [x, 1], [0, 1.0]])
    hole = np.array([[gap, 0.31], [gap, 0.84], [0.3, 0.66]])
    contours, edge = [outline, hole], 0.2
    before = [even_steps(contour, edge) for contour in contours]
    assert len(foreign_in_circles(before)) > 0
    samples = sampled_contours(contours, edge)
    assert len(foreign_in_circles(samples)) == 0
    assert sum(map(len, samples)) < 12 * sum(map(len, before))
    for early, late in zip(before, samples, strict=True):
        gaps = np.hypot(*(early[:, None] - late).transpose(2, 0, 1))
        assert gaps.min(axis=1).max() < 1e-15  # halving moves nothing


def test_spikes_do_not_halve_for_ever():
    spike = np.array([[0, 0], [1, 0], [1, 1], [0.5, 1], [0.5005, 0.01], [0.4995, 0.93], [0, 1.0]])
    samples = sampled_contours([spike], 0.2)
    steps = np.hypot(*(np.roll(samples[0], -1, axis=0) - samples[0]).T)
    assert foreign_in_circles(samples).size  # it would halve on
    assert steps.min() >= 0.2 / 64
    assert len(steps) < 60  # across a gap that no step can match none is halved at all
