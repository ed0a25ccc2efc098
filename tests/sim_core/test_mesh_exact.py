"""Predicates against exact rational arithmetic, on random and on adversarial points."""

from fractions import Fraction

import numpy as np
import pytest

from sim_core.mesh.exact import BITS, incircle, orient, snap_frame


def exact_incircle(a, b, c, d) -> int:
    rows = []
    for p in (a, b, c):
        x, y = Fraction(int(p[0])) - int(d[0]), Fraction(int(p[1])) - int(d[1])
        rows.append((x, y, x * x + y * y))
    (a1, a2, a3), (b1, b2, b3), (c1, c2, c3) = rows
    total = a1 * (b2 * c3 - b3 * c2) - a2 * (b1 * c3 - b3 * c1) + a3 * (b1 * c2 - b2 * c1)
    return (total > 0) - (total < 0)


def exact_orient(a, b, c) -> int:
    (ax, ay), (bx, by), (cx, cy) = (tuple(int(v) for v in p) for p in (a, b, c))
    total = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    return (total > 0) - (total < 0)


def nearly_cocircular(rng) -> np.ndarray:
    """Four points of one circle with whole coordinates, one of them moved by at most a grid step."""
    x, y = rng.integers(1, 2**23, 2)
    centre = np.full(2, 2**25)
    ring = np.array([[x, y], [-y, x], [-x, -y], [y, -x]]) + centre
    ring[3] += rng.integers(-1, 2, 2)
    return ring.astype(float)


def test_incircle_agrees_with_fractions_on_hard_cases():
    rng = np.random.default_rng(1)
    seen = set()
    for _ in range(4000):
        a, b, c, d = nearly_cocircular(rng)
        sign = incircle(*a, *b, *c, *d)
        assert sign == exact_incircle(a, b, c, d)
        seen.add(sign)
    assert seen == {-1, 0, 1}


def test_incircle_agrees_with_fractions_on_random_points():
    rng = np.random.default_rng(2)
    for points in rng.integers(0, 2**BITS + 1, (3000, 4, 2)).astype(float):
        assert incircle(*points.ravel()) == exact_incircle(*points)


def test_orient_is_exact_for_points_on_a_line():
    rng = np.random.default_rng(3)
    for _ in range(3000):
        step = rng.integers(1, 2**12, 2)
        a = rng.integers(0, 2**10, 2)
        b, c = a + step * int(rng.integers(1, 2**12)), a + step * int(rng.integers(1, 2**12))
        c[1] += rng.integers(-1, 2)
        assert np.sign(orient(*a.astype(float), *b.astype(float), *c.astype(float))) == exact_orient(a, b, c)


@pytest.mark.parametrize("size", [1e-3, 1.0, 37.5])
def test_snapping_moves_points_by_less_than_a_grid_step(size):
    points = np.random.default_rng(4).random((500, 2)) * size
    frame = snap_frame(points)
    snapped = frame.snap(points)
    assert snapped.min() >= 0
    assert snapped.max() <= 2**BITS
    back = np.column_stack([frame.x0 + snapped[:, 0] / frame.scale, frame.y0 - snapped[:, 1] / frame.scale])
    assert np.abs(back - points).max() <= size * 2.0**-BITS
