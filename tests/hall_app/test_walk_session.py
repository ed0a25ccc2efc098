"""The authority: what a page may say, how fast it may walk, where it may go."""

import itertools
import json
import math

import numpy as np
import pytest

from hall_app.walk import (
    ARREARS,
    BUCKET,
    EYE_MAX,
    EYE_MIN,
    HOLD,
    SPEED,
    Floor,
    Keys,
    Pose,
    Prism,
    Round,
    WalkSession,
    bake,
    step,
    wall,
)

FLOOR = Floor(((0, 0), (10, 0), (10, 6), (0, 6)), (wall((5, 0), (5, 6), 0.1), Round(2, 2, 0.4)))
GRID = bake(FLOOR, cell=0.05)
START = Pose(2.0, 5.0, 0.0)


def session(**options) -> WalkSession:
    return WalkSession(FLOOR, GRID, START, now=0.0, **options)


def forward(seq, dt=1 / 60, yaw=math.pi / 2, eye=1.6):
    return [seq, dt, 1, 0, yaw, eye]


def test_inputs_are_walked_in_order_and_answered():
    walk = session()
    reply = walk.inputs([forward(1), forward(2), forward(3, eye=1.2)], now=0.1)
    pose = START
    for _ in range(3):
        pose = step(Pose(pose.x, pose.z, math.pi / 2), Keys(1, 0), 1 / 60, FLOOR)
    assert (reply.seq, reply.x, reply.z, reply.eye, reply.refused) == (3, pose.x, pose.z, 1.2, 0)
    assert json.loads(json.dumps(reply.message())) == {
        "t": "pose", "seq": 3, "x": pose.x, "z": pose.z, "eye": 1.2,
    }  # fmt: skip


@pytest.mark.parametrize(
    "bad",
    [
        [1, 0.0, 1, 0, 0, 1.6],
        [1, -0.1, 1, 0, 0, 1.6],
        [1, 0.26, 1, 0, 0, 1.6],
        [1, math.nan, 1, 0, 0, 1.6],
        [1, 0.1, 1.1, 0, 0, 1.6],
        [1, 0.1, 1, -2, 0, 1.6],
        [1, 0.1, math.nan, 0, 0, 1.6],
        [1, 0.1, 1, 0, math.inf, 1.6],
        [1, 0.1, 1, 0, 0, math.nan],
        [0, 0.1, 1, 0, 0, 1.6],
        [1.5, 0.1, 1, 0, 0, 1.6],
        [10**400, 0.1, 1, 0, 0, 1.6],
        [True, 0.1, 1, 0, 0, 1.6],
        ["1", 0.1, 1, 0, 0, 1.6],
        [1, 0.1, 1, 0, 0],
        [1, 0.1, 1, 0, 0, 1.6, 0],
        "abcdef",
        None,
        7,
        {"seq": 1},
    ],
)
def test_invalid_input_moves_nothing(bad):
    walk = session()
    reply = walk.inputs([bad], now=1.0)
    assert (reply.refused, reply.seq, reply.x, reply.z) == (1, 0, START.x, START.z)


def test_repeated_and_old_inputs_are_left_out():
    walk = session()
    walk.inputs([forward(5)], now=0.1)
    x = walk.pose.x
    assert walk.inputs([forward(5), forward(4)], now=0.2).refused == 2
    assert walk.pose.x == x


def test_eye_is_clamped():
    walk = session()
    assert walk.inputs([forward(1, eye=99)], 0.1).eye == EYE_MAX
    assert walk.inputs([forward(2, eye=-1)], 0.2).eye == EYE_MIN


def test_speed_hack_gets_no_farther_than_real_time():
    """Ten times as many inputs as time allows: a full bucket in advance and 2 % of clock error, no more."""
    long = Floor(((0, 0), (60, 0), (60, 4), (0, 4)))
    walk = WalkSession(long, bake(long, cell=0.1), Pose(55, 2), now=0.0)
    begin, seq, refused = walk.pose.x, 0, 0
    for k in range(1, 61):
        batch = [forward(seq := seq + 1) for _ in range(20)]
        reply = walk.inputs(batch, now=k / 30)
        refused += reply.refused
        assert reply.seq == seq
    assert begin - walk.pose.x <= SPEED * (2.0 * 1.02 + BUCKET) + 1e-6
    assert refused > 800


def test_honest_page_is_never_refused():
    walk, rng, seq, time = session(), np.random.default_rng(3), 0, 0.0
    for _ in range(300):
        dts = rng.uniform(0.004, 0.05, 3)
        time += dts.sum()
        late = time + rng.uniform(0, 0.2)  # a jittery line
        batch = [[seq := seq + 1, dt, 1, 0, 0.1 * seq, 1.6] for dt in dts]
        assert walk.inputs(batch, now=late).refused == 0


def test_clock_running_backwards_gives_no_time():
    walk = session()
    for k in range(1, 40):
        walk.inputs([forward(k, dt=0.25)], now=-k)
    assert START.x - walk.pose.x <= SPEED * BUCKET + 1e-9


def test_server_mode_walks_held_keys_at_sixty_hertz():
    walk = session(mode="server")
    assert walk.keys(1, 0, math.pi / 2, 1.6, now=1.0).refused == 0
    for k in range(1, 16):
        reply = walk.tick(1.0 + k / 30)
        if k % 6 == 0:  # as a page repeats them
            assert walk.keys(1, 0, math.pi / 2, 1.6, now=1.0 + k / 30).refused == 0
    assert START.x - reply.x == pytest.approx(SPEED * 0.5, abs=SPEED / 60 + 1e-9)
    walk.keys(0, 0, math.pi / 2, 1.6, now=1.5)
    still = walk.tick(1.5).x
    assert walk.tick(3.0).x == still
    assert walk.keys(9, 0, 0, 1.6, now=3.0).refused == 1
    assert walk.keys(None, 0, 0, 1.6, now=3.0).refused == 1


def test_server_mode_lets_go_of_keys_that_are_not_repeated():
    """A page whose own thread stands still says neither that a key is held nor that it came up."""
    walk = session(mode="server")
    walk.keys(1, 0, math.pi / 2, 1.6, now=1.0)
    for k in range(1, 181):
        reply = walk.tick(1.0 + k / 60)
    assert START.x - reply.x == pytest.approx(SPEED * HOLD, abs=SPEED / 60 + 1e-9)


def test_server_mode_does_not_leap_after_a_stall():
    """A late tick is made up for in small steps; what the server slept through nobody walked."""
    walk = session(mode="server")
    walk.keys(1, 0, math.pi / 2, 1.6, now=0.0)
    places = [START.x] + [walk.tick(100.0).x for _ in range(200)]
    assert max(a - b for a, b in itertools.pairwise(places)) <= SPEED * 2 / 60 + 1e-9
    assert START.x - places[-1] <= SPEED * ARREARS + SPEED / 60
    assert SPEED * (ARREARS + 2 / 60) < 0.25


def test_server_mode_makes_up_for_a_burst_of_keys_once():
    """What was held through a stall, told many times, arrives at once."""
    walk = session(mode="server")
    walk.keys(1, 0, math.pi / 2, 1.6, now=0.0)
    for _ in range(20):
        walk.keys(1, 0, math.pi / 2, 1.6, now=4.0)
    assert START.x - walk.pose.x <= SPEED * 3 / 60 + 1e-9


def test_nobody_walks_on_out_of_a_jump():
    """Where the server walks, keys are up after a jump until the page tells them again."""
    walk = session(mode="server")
    walk.keys(1, 0, math.pi / 2, 1.6, now=0.0)
    assert walk.tick(now=0.1).x < START.x
    walk.goto(math.nan, 1)  # no jump
    walked = walk.tick(now=0.2)
    moved = walk.goto(8.0, 3.0)
    assert walked.x < START.x - SPEED * 3 / 60
    for now in (0.25, 0.3, 0.4):
        reply = walk.tick(now=now)
        assert (reply.x, reply.z) == (moved.x, moved.z)
    walk.keys(1, 0, math.pi / 2, 1.6, now=0.41)  # still held
    assert walk.tick(now=0.5).x < moved.x


def test_goto_finds_the_nearest_reachable_spot():
    walk = session()
    moved = walk.goto(9.0, 3.0)  # beyond the wall
    assert moved.x == pytest.approx(5 - 0.05 - 0.31, abs=0.05)
    assert moved.z == pytest.approx(3.0, abs=0.05)
    inside = walk.goto(2.0, 2.0)  # into the column
    assert 0.71 <= math.hypot(inside.x - 2, inside.z - 2) < 0.78
    for bad in ((math.nan, 1), (None, 1), ("2", 1), (1, math.inf)):
        assert walk.goto(*bad) == inside
    assert inside.message() == {"t": "moved", "x": inside.x, "z": inside.z, "yaw": 0.0}


def test_start_inside_a_solid_is_moved_out():
    walk = WalkSession(FLOOR, GRID, Pose(2.0, 2.1), now=0.0)
    assert 0.71 <= math.hypot(walk.pose.x - 2, walk.pose.z - 2) < 0.78


def test_changed_plan_moves_only_whom_it_must():
    walk = session()
    farther = Floor(FLOOR.outline, (*FLOOR.solids, Round(3.8, 1, 0.3)))
    assert not walk.change_floor(farther, bake(farther, cell=0.05))
    assert (walk.pose.x, walk.pose.z) == (START.x, START.z)
    upon = Floor(FLOOR.outline, (*FLOOR.solids, Round(2.1, 5, 0.3)))
    assert walk.change_floor(upon, bake(upon, cell=0.05))
    assert math.hypot(walk.pose.x - 2.1, walk.pose.z - 5) >= 0.61


def test_full_floor_leaves_the_visitor_standing():
    walk = session()
    full = Floor(FLOOR.outline, (Prism(((-1, -1), (11, -1), (11, 7), (-1, 7))),))
    assert not walk.change_floor(full, bake(full, cell=0.1))
    assert walk.inputs([forward(1)], now=1.0).x == START.x
    assert walk.goto(1, 1).x == START.x
    assert walk.change_floor(FLOOR, GRID) is False
    assert walk.inputs([forward(2)], now=2.0).x < START.x


def test_batch_is_bounded():
    walk = session()
    reply = walk.inputs([forward(k, dt=0.001) for k in range(1, 1000)], now=9.0)
    assert reply.seq == 64
    assert reply.refused == 999 - 64
