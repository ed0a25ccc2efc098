"""Predicates against exact rational arithmetic, on random and on adversarial points."""

import numpy as np
import pytest
from exact_delaunay import incircle_sign, orient_sign

from sim_core.mesh.geometry import incircle, orient


def on_one_circle(rng) -> np.ndarray:
    """Four points of one circle with dyadic coordinates, one of them moved by at most one step of 2^-30."""
    x, y = rng.integers(1, 2**40, 2)
    ring = np.array([[x, y], [-y, x], [-x, -y], [y, -x]]) + rng.integers(0, 2**44, 2)
    ring[3] += rng.integers(-1, 2, 2)
    return ring * 2.0**-30


def rounded_circle(rng) -> np.ndarray:
    angle = np.sort(rng.random(4)) * 2 * np.pi
    return np.column_stack([np.cos(angle), np.sin(angle)]) * rng.random() + 10 ** rng.uniform(-3, 3, 2)


def tenths(rng) -> np.ndarray:
    return 0.1 + rng.integers(0, 40, (4, 2)) * 0.01


def far_apart_in_size(rng) -> np.ndarray:
    return rng.random((4, 2)) * 10.0 ** rng.uniform(-30, 20, (4, 2))


def close_together(rng) -> np.ndarray:
    """Neighbouring floats around a far place: every difference is a few units in the last place."""
    return 1000.1 + rng.integers(-3, 4, (4, 2)) * 2.0**-43


def plain(rng) -> np.ndarray:
    return rng.random((4, 2)) - 0.5


KINDS = [on_one_circle, rounded_circle, tenths, far_apart_in_size, close_together, plain]


@pytest.mark.parametrize("kind", KINDS)
def test_incircle_and_orient_agree_with_fractions(kind):
    rng = np.random.default_rng(1)
    seen = set()
    for _ in range(1500):
        a, b, c, d = kind(rng)
        turn = orient_sign(a, b, c)
        assert np.sign(orient(*a, *b, *c)) == turn
        if turn < 0:
            a, b = b, a
        if turn:
            sign = incircle_sign(a, b, c, d)
            assert incircle(*a, *b, *c, *d) == sign
            seen.add(sign)
    assert {-1, 1} <= seen
    if kind in (on_one_circle, tenths, close_together):
        assert 0 in seen


def test_orient_is_exact_for_points_on_a_line():
    rng = np.random.default_rng(3)
    seen = set()
    for _ in range(3000):
        a, b = rng.random((2, 2))
        c = a + (b - a) * rng.random() * 3  # on the line but for rounding
        if rng.random() < 0.3:
            step = rng.integers(1, 2**20, 2) * 2.0**-20
            b, c = a + step, a + 3 * step
            b, c = (b, c) if (b - a == step).all() and (c - a == 3 * step).all() else (a + 0.0, c)
        sign = orient_sign(a, b, c)
        assert np.sign(orient(*a, *b, *c)) == sign
        seen.add(sign)
    assert seen == {-1, 0, 1}
