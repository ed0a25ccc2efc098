"""The page's own walkmath.js in Chromium against the server's mover: parity, and prediction under latency."""

import math

import numpy as np
import pytest
from full_matrix import by_day
from walk_moves import FLOOR, KEYS, room
from walk_page import Page, hold

from hall_app.walk import (
    BODY,
    CELL,
    MAX_INPUT_DT,
    SLIDE,
    SPEED,
    STEEP,
    TOUCH,
    Keys,
    Pose,
    bake,
    step,
    world_of,
)

pytestmark = pytest.mark.browser


@pytest.fixture(scope="module")
def page(chromium):
    tab = chromium.new_page()
    yield Page(tab, bake(FLOOR))
    tab.close()


def test_page_and_server_use_the_same_constants(page):
    told = page.run("constants")
    expected = {
        "speed": SPEED,
        "radius": BODY.radius,
        "skin": BODY.skin,
        "maxDt": MAX_INPUT_DT,
        "touch": TOUCH,
        "slide": SLIDE,
        "steep": STEEP,
    }
    assert {key: told[key] for key in expected} == expected


def test_damaged_grid_is_refused(page):
    assert "reload" in page.run("refused", size=10)


def test_clearance_and_normal_near_contact(page):
    """Where visitors rest and slide the page's clearance must be far better than the skin."""
    places = np.random.default_rng(3).uniform((0, 0), (12, 8), (100_000, 2))
    places = places[np.abs(room(places, FLOOR) - BODY.skin) < 0.02]
    told = np.array(page.run("clearance", places=places.tolist()))
    world = world_of(FLOOR)
    true = np.array([world.contact(x, z) for x, z in places])
    assert len(places) > 2000
    error = told[:, 0] - true[:, 0]
    assert error.max() < 0.1 * BODY.skin
    assert error.min() > -0.1 * BODY.skin
    cosine = np.sum(told[:, 1:] * true[:, 1:], axis=1)
    assert np.quantile(cosine, 0.01) > math.cos(math.radians(1))


@pytest.mark.nightly
def test_ten_thousand_random_steps_agree(page):
    rng, world, moves = np.random.default_rng(1), world_of(FLOOR), []
    while len(moves) < 10_000:
        x, z = map(float, rng.uniform((0, 0), (12, 8)))
        if world.clearance(x, z) > BODY.skin:
            keys = KEYS[rng.integers(8)]
            moves.append(
                [x, z, keys.forward, keys.right, rng.uniform(-math.pi, math.pi), rng.uniform(1e-3, 0.25)]
            )
    told = np.array(page.run("move", moves=moves))
    true = [step(Pose(x, z, yaw), Keys(f, r), dt, FLOOR) for x, z, f, r, yaw, dt in moves]
    apart = np.hypot(*(told - [(pose.x, pose.z) for pose in true]).T)
    assert apart.max() < BODY.skin
    assert np.quantile(apart, 0.999) < 0.001
    assert np.quantile(apart, 0.8) < 1e-9  # free walking is the same to the bit, but for rounding
    assert room(told, FLOOR).min() > 0.8 * BODY.skin


HELD = {
    "wall, head on": (Pose(1.0, 2.5, -math.pi / 2), True),
    "wall, oblique": (Pose(1.0, 3.0, -math.pi / 3), False),
    "convex corner, oblique": (Pose(5.9, 6.2, math.radians(8)), False),
    "convex corner, other side": (Pose(3.6, 2.6, math.radians(-80)), False),
    "end of a thin wall": (Pose(1.96, 5.2, 0.0), False),
    "round stand, off centre": (Pose(9.3, 5.6, 0.0), False),
    "round stand, nearly central": (Pose(9.48, 5.6, 0.0), False),
    "round stand, central": (Pose(9.5, 5.6, 0.0), True),
    "edge of the dead cone": (Pose(9.5076, 5.6, 0.0), True),
    "corner of the room": (Pose(11.0, 1.5, math.radians(-40)), True),
    "inside an L": (Pose(2.2, 7.4, math.radians(30)), True),
}


@pytest.mark.parametrize("rtt", by_day([0.08], [0.0, 0.08, 0.25]))
@pytest.mark.parametrize("fps", [60, 12])
@pytest.mark.parametrize("case", HELD)
def test_w_held_for_three_seconds(page, case, fps, rtt):
    start, rests = HELD[case]
    track = hold(page, FLOOR, start, [1 / fps] * (4 * fps), rtt)
    assert room(track.shown, FLOOR).min() >= 0.8 * BODY.skin  # 0 mm intrusion, most of the skin in reserve
    assert track.misses.max() <= 0.010
    if rests:
        assert np.ptp(track.server[-12:], axis=0).max() == 0
        assert track.jitter(fps) <= 1e-4
        assert np.linalg.norm(track.shown[-1] - track.server[-1]) <= 0.003
    else:
        assert np.linalg.norm(track.server[-1] - track.server[0]) > 1.0


def test_whatever_is_pressed_the_display_is_never_inside(page):
    """Keys changing at random, frames of 4 to 250 ms, three latencies."""
    rng = np.random.default_rng(11)
    worst = []
    for k in range(45):
        x, z = page.grid.nearest_free(*rng.uniform((0, 0), (12, 8)))
        dts = rng.uniform(0.004, rng.choice([0.02, 0.05, 0.25]), 150).tolist()
        keys = [(KEYS + [Keys()])[i] for i in np.repeat(rng.integers(0, 9, 10), 15)]
        pose = Pose(x, z, rng.uniform(-math.pi, math.pi))
        track = hold(page, FLOOR, pose, dts, (0.0, 0.08, 0.2)[k % 3], keys)
        assert room(track.shown, FLOOR).min() >= 0
        worst.append(track.misses.max())
    assert max(worst) <= 0.03
    assert np.median(worst) <= 0.001


def trace(page, events, start=(8.0, 6.5)):
    return page.run("trace", start=list(start), events=events)


def push(seq, forward=1.0, dt=1 / 60):
    return ["push", seq, dt, forward, 0.0, 0.0, 1.6]


def test_small_disagreement_moves_nothing_while_standing(page):
    """Two millimetres apart: not a tremble; the walk takes it away later."""
    still = [push(k, forward=0.0) for k in range(1, 30)]
    told = trace(page, [*still, ["ack", 29, 8.002, 6.5], *[push(k, forward=0.0) for k in range(30, 60)]])
    assert np.ptp(np.array(told["shown"]), axis=0).max() == 0
    walked = trace(page, [push(1, 0.0), ["ack", 1, 8.002, 6.5], *[push(k) for k in range(2, 62)]])
    assert walked["shown"][-1][0] == pytest.approx(8.002, abs=1e-6)


def test_larger_disagreement_fades_and_a_huge_one_jumps(page):
    fading = trace(page, [push(1, 0.0), ["ack", 1, 8.2, 6.5], *[push(k, 0.0) for k in range(2, 62)]])
    xs = np.array(fading["shown"])[1:, 0]
    assert np.all(np.diff(xs) >= 0)
    assert xs[0] < 8.05
    assert xs[-1] == pytest.approx(8.2, abs=0.001)
    assert np.abs(np.diff(xs)).max() < 0.2 * 0.2
    jumping = trace(page, [push(1, 0.0), ["ack", 1, 10.5, 6.5], push(2, 0.0)])
    assert jumping["shown"][-1] == pytest.approx([10.5, 6.5])


def test_teleport_and_skipped_inputs(page):
    told = trace(page, [push(1), push(2), ["moved", 4.0, 5.0], push(3, 0.0), ["skip", 3]])
    assert told["shown"][-1] == pytest.approx([4.0, 5.0])
    assert told["pending"] == 0


def test_silent_server_does_not_fill_the_memory(page):
    told = trace(page, [push(k, 0.0) for k in range(1, 2000)])
    assert told["pending"] <= 600


def test_refused_walking_is_taken_back(page):
    """The server did not walk: the page returns to it, never through a solid."""
    told = trace(
        page,
        [*[push(k) for k in range(1, 31)], ["ack", 30, 8.0, 6.5], *[push(k, 0.0) for k in range(31, 91)]],
    )
    assert told["misses"][0] == pytest.approx(SPEED / 2, abs=1e-6)
    assert told["shown"][-1] == pytest.approx([8.0, 6.5], abs=0.001)


def test_shipped_cell_keeps_the_grid_small():
    assert 24 * 16 / CELL**2 * 2 <= 600_000  # bytes of the hall's grid before compression
