"""Global alignment (Eq. 13-14): exact, never a mirror image, and what it says of points that cannot tell a rotation."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sim_core.errors import SimCoreError
from sim_core.track import align

EXACT = 1e-12


def points(seed: int = 0, count: int = 25) -> np.ndarray:
    return np.random.default_rng(seed).normal(size=(count, 3))


def turn(seed: int = 1) -> np.ndarray:
    return Rotation.random(random_state=seed).as_matrix()


@pytest.mark.parametrize("scale", [1e-9, 1e-3, 1.0, 1e3, 1e9])
@pytest.mark.parametrize("flat", [False, True])
def test_it_is_exact(scale: float, flat: bool) -> None:
    body = points() * scale * ([1.0, 1.0, 0.0] if flat else [1.0, 1.0, 1.0])
    wanted, shift = turn(), np.array([0.3, -2.0, 5.0]) * scale
    found = align(body @ wanted.T + shift, body)
    assert np.abs(found.rotation - wanted).max() <= EXACT
    assert np.abs(found.translation - shift).max() <= EXACT * scale
    assert found.kind == ("coplanar" if flat else "solid")
    assert not found.mirrored
    assert np.abs(found.of(body) - (body @ wanted.T + shift)).max() <= 1e-14 * 20 * scale


def test_far_from_the_origin_it_is_as_exact_as_the_numbers_there() -> None:
    body, wanted = points(), turn()
    far = np.array([1e6, -1e6, 1e6])
    target = body @ wanted.T + far
    found = align(target, body)
    assert np.abs(found.rotation - wanted).max() <= 1e-10  # of a number of a million 1e-10 is the last digit
    assert np.abs(found.of(body) - target).max() <= 1e-15 * 1e6
    both = align(target, body + far)
    assert np.abs(both.of(body + far) - target).max() <= EXACT * 1e6
    # Where the numbers can hold it, so does the rotation: eighths beside a million are exact.
    grid = np.round(body * 8.0) / 8.0
    quarter = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    assert np.abs(align(grid @ quarter.T + far, grid + far).rotation - quarter).max() <= EXACT


def test_a_mirrored_set_still_gives_a_rotation() -> None:
    body = points()
    found = align(body * [-1.0, 1.0, 1.0], body)
    assert np.linalg.det(found.rotation) == pytest.approx(1.0, abs=EXACT)
    assert found.mirrored
    assert np.abs(found.rotation @ found.rotation.T - np.eye(3)).max() <= EXACT


@pytest.mark.parametrize("seed", range(20))
def test_it_agrees_with_scipy_under_noise_and_weights(seed: int) -> None:
    random = np.random.default_rng(seed)
    body = random.normal(size=(9, 3))
    target = body @ turn(seed).T + 0.1 * random.normal(size=(9, 3)) + [1.0, 2.0, 3.0]
    weights = random.uniform(0.1, 2.0, 9)
    share = weights / weights.sum()
    peer, _ = Rotation.align_vectors(target - share @ target, body - share @ body, weights)
    assert np.abs(align(target, body, weights).rotation - peer.as_matrix()).max() <= 1e-10


def test_a_point_of_no_weight_says_nothing() -> None:
    body, wanted = points(), turn()
    target = body @ wanted.T
    target[3] += 100.0
    weights = np.ones(len(body))
    weights[3] = 0.0
    assert np.abs(align(target, body, weights).rotation - wanted).max() <= EXACT


@pytest.mark.parametrize(
    ("body", "kind"),
    [
        (np.zeros((1, 3)), "few"),
        (points(count=2), "few"),
        (np.ones((5, 3)), "coincident"),
        (np.outer(np.arange(5.0), [1.0, 2.0, -1.0]), "collinear"),
        (points(count=3), "coplanar"),
    ],
)
def test_sets_that_leave_a_rotation_open_are_named_and_keep_the_last(body: np.ndarray, kind: str) -> None:
    before = turn(5)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = align(body @ before.T + 3.0, body, previous=before)
        alone = align(body @ before.T + 3.0, body)
    assert found.kind == alone.kind == kind
    assert np.abs(found.rotation - before).max() <= 1e-7
    for one in (found, alone):
        assert np.isfinite(one.rotation).all()
        assert np.linalg.det(one.rotation) == pytest.approx(1.0, abs=EXACT)
    if kind == "collinear":  # what it does say is exact without a prior, too
        assert np.abs(alone.of(body) - (body @ before.T + 3.0)).max() <= 1e-9


def test_opposite_vectors_turn_by_half() -> None:
    """scipy was wrong for those (scipy/scipy#20660)."""
    body = np.outer([-1.0, 0.0, 1.0], [0.0, 1.0, 0.0])
    found = align(-body, body)
    assert np.abs(found.of(body) + body).max() <= 1e-9


def test_the_twist_of_collinear_points_stays_with_a_prior() -> None:
    """A bone of five points at 1 mm noise: at most 2 degrees about itself in a frame, at the same fit error."""
    random = np.random.default_rng(0)
    along = np.array([0.36, -0.8, 0.48])
    rod = np.outer(np.linspace(0.0, 0.25, 5), along)
    turns, before, fits, free = [], np.eye(3), [], []
    loose = np.eye(3)
    for frame in range(600):
        swing = Rotation.from_euler(
            "ZX", [40.0 * np.sin(frame / 12.0), 25.0 * np.sin(frame / 19.0)], degrees=True
        )
        target = swing.apply(rod) + 0.001 * random.standard_normal(rod.shape)
        found = align(target, rod, previous=before)
        direction = found.rotation @ along
        change = Rotation.from_matrix(found.rotation @ before.T).as_rotvec(degrees=True)
        turns.append(abs(change @ direction))
        fits.append(found.rms)
        before = found.rotation
        there, shape = target - target.mean(0), rod - rod.mean(0)
        u, _, vh = np.linalg.svd(shape.T @ there)
        plain = vh.T @ np.diag([1.0, 1.0, np.linalg.det(vh.T @ u.T)]) @ u.T
        free.append(np.degrees(np.arccos(np.clip((np.trace(plain @ loose.T) - 1.0) / 2.0, -1.0, 1.0))))
        loose = plain
    assert max(turns[1:]) <= 2.0
    assert np.sqrt(np.mean(np.square(fits))) <= 0.002
    assert np.median(free) > 30.0  # what the prior is for


@pytest.mark.nightly
def test_a_hundred_thousand_frames_stay_rotations() -> None:
    random = np.random.default_rng(2)
    body = points(3, 7) * 0.3
    before, worst = np.eye(3), 0.0
    steps = Rotation.from_rotvec(0.05 * random.standard_normal((100_000, 3))).as_matrix()
    wanted = np.eye(3)
    for step in steps:
        wanted = step @ wanted
        u, _, vh = np.linalg.svd(wanted)
        wanted = u @ vh
        before = align(body @ wanted.T, body, previous=before).rotation
        worst = max(worst, float(np.abs(before @ before.T - np.eye(3)).max()))
    assert worst <= EXACT
    assert np.abs(before - wanted).max() <= 1e-3  # the prior's share of one step, not a sum over all


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (lambda b: align(b[:3], b), "the target has"),
        (lambda b: align(b, b, -np.ones(len(b))), "weights"),
        (lambda b: align(b, b, np.zeros(len(b))), "all are 0"),
        (lambda b: align(b * np.nan, b), "point 0 is not finite"),
        (lambda b: align(b, b, np.full(len(b), np.inf)), "weights"),
        (lambda b: align(b, b, previous=np.eye(2)), "previous"),
        (lambda b: align("abc", b), "target"),
    ],
)
def test_wrong_arrays_are_told(words, told: str) -> None:
    with pytest.raises(SimCoreError, match=told):
        words(points())
