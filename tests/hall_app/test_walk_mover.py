"""The mover: never inside, the same path at any frame rate, all keys, slides, corners, wedges."""

import math
import threading

import numpy as np
import pytest
from walk_moves import FLOOR, KEYS, dense_floor, random_walk, room

from hall_app.walk import BODY, SPEED, Floor, Keys, Pose, Prism, Round, step, wall, world_of

EMPTY = Floor(((-30, -30), (30, -30), (30, 30), (-30, 30)))
STAND = Floor(((-5, -5), (5, -5), (5, 5), (-5, 5)), (Round(0, 0, 0.45),))


def walk(pose: Pose, keys: Keys, seconds: float, fps: float, floor: Floor) -> np.ndarray:
    """(frames + 1, 2) places."""
    places = [(pose.x, pose.z)]
    for _ in range(round(seconds * fps)):
        pose = step(pose, keys, 1 / fps, floor)
        places.append((pose.x, pose.z))
    return np.array(places)


def length(places: np.ndarray) -> float:
    return float(np.linalg.norm(np.diff(places, axis=0), axis=1).sum())


@pytest.mark.nightly
@pytest.mark.slow
def test_hundred_thousand_random_moves_never_end_inside():
    result = random_walk((dense_floor(np.random.default_rng(1)), 100_000, 1))
    assert result["penetrations"] == 0
    assert result["least"] >= BODY.skin - 1e-5  # not even the skin is used up
    assert result["blocked"] > 30_000  # the walk did press against things
    assert result["metres"] > 1000


@pytest.mark.nightly
def test_no_tunnelling_between_the_ends_of_a_long_move():
    """Five seconds in one step through a maze of 5 cm walls: cut into frames, every frame is clear as well."""
    floor = dense_floor(np.random.default_rng(7))
    rng = np.random.default_rng(8)
    spots = rng.uniform((0.5, 0.5), (23.5, 15.5), (400, 2))
    spots = spots[room(spots, floor) > 0.02].tolist()
    crossed = 0
    for x, z in spots[:80]:
        pose = Pose(x, z, rng.uniform(-math.pi, math.pi))
        far = step(pose, Keys(1, 0), 5.0, floor)
        fine = walk(pose, Keys(1, 0), 5.0, 60, floor)
        assert room(fine, floor).min() >= BODY.skin - 1e-5
        crossed += np.hypot(far.x - fine[-1, 0], far.z - fine[-1, 1]) > 0.1
    assert crossed <= 4  # a few decide otherwise at an edge, none may end behind a wall they cannot pass


@pytest.mark.parametrize("fps", [2, 10, 60])
@pytest.mark.parametrize(
    ("start", "keys", "floor", "seconds"),
    [
        (Pose(0, 0, 0.3), Keys(1, 1), EMPTY, 5),
        (Pose(1.0, 3.0, -math.pi / 3), Keys(1, 0), FLOOR, 3),  # along a wall and past its end
        (Pose(0.2, 2.0, 0.0), Keys(1, 0), STAND, 3),  # round a stand
        (Pose(5.9, 6.2, 0.14), Keys(1, 0), FLOOR, 3),  # round a convex corner
    ],
)
def test_equal_path_at_every_frame_rate(start, keys, floor, seconds, fps):
    """The path is measured where all frame rates have a pose: twice a second."""
    reference = walk(start, keys, seconds, 120, floor)[::60]
    places = walk(start, keys, seconds, fps, floor)[:: max(1, fps // 2)]
    assert length(places) == pytest.approx(length(reference), rel=0.01)
    assert np.linalg.norm(places[-1] - reference[-1]) < 0.01 * seconds * SPEED


@pytest.mark.parametrize("keys", KEYS)
@pytest.mark.parametrize("yaw", [0.0, 0.7, -2.0])
def test_eight_directions_relative_to_the_view(keys, yaw):
    pose = step(Pose(0, 0, yaw, 1.7), keys, 1.0, EMPTY)
    forward, right = np.array([-math.sin(yaw), -math.cos(yaw)]), np.array([math.cos(yaw), -math.sin(yaw)])
    wish = keys.forward * forward + keys.right * right
    np.testing.assert_allclose([pose.x, pose.z], SPEED * wish / np.linalg.norm(wish), atol=1e-12)
    assert (pose.yaw, pose.eye) == (yaw, 1.7)


def test_half_a_stick_is_half_the_speed_and_no_key_stands():
    assert -step(Pose(0, 0), Keys(0.5, 0), 1.0, EMPTY).z == pytest.approx(SPEED / 2)
    assert step(Pose(1, 2), Keys(), 1.0, EMPTY) == Pose(1, 2)
    assert step(Pose(1, 2), Keys(1, 0), 0.0, EMPTY) == Pose(1, 2)


def test_head_on_stops_at_the_skin_and_stays():
    places = walk(Pose(1.0, 2.5, -math.pi / 2), Keys(1, 0), 3, 60, FLOOR)
    assert places[-1] == pytest.approx([2 - 0.025 - BODY.radius - BODY.skin, 2.5], abs=1e-4)
    assert np.ptp(places[-60:], axis=0).max() == 0


@pytest.mark.parametrize("degrees", [10, 30, 60, 80])
def test_slides_with_the_share_of_the_speed_along_the_wall(degrees):
    """Into the boundary at x = 30 at an angle to its normal: what remains is its sine."""
    start = Pose(30 - BODY.radius - BODY.skin, 0, -math.pi / 2 + math.radians(degrees))
    after = step(start, Keys(1, 0), 1.0, EMPTY)
    assert -after.z == pytest.approx(SPEED * math.sin(math.radians(degrees)), rel=1e-6)
    assert after.x == pytest.approx(start.x, abs=1e-9)


CORNER = BODY.radius + BODY.skin
RESTS = {
    "right angle": ((Pose(11.0, 1.5, math.radians(-40)), FLOOR), (12 - CORNER, CORNER)),
    "inside an L": ((Pose(2.2, 7.4, math.radians(30)), FLOOR), (1.4 + CORNER, 6.4 + CORNER)),
}


@pytest.mark.parametrize("case", RESTS)
@pytest.mark.parametrize("fps", [2, 60])
def test_comes_to_rest_in_a_concave_corner(case, fps):
    (pose, floor), rest = RESTS[case]
    places = walk(pose, Keys(1, 0), 4, fps, floor)
    assert places[-1] == pytest.approx(rest, abs=2e-4)
    assert np.ptp(places[-2:], axis=0).max() == 0


@pytest.mark.parametrize("angle", [20, 50, 80, 110])
@pytest.mark.parametrize("aim", [-25, -10, 0, 10, 25])
def test_no_corner_makes_the_visitor_tremble(angle, aim):
    """Two walls that meet at `angle`, walked into from inside: a rest, not a cycle between the two."""
    half = math.radians(angle / 2)
    ends = [(4 * math.sin(side * half), 4 * math.cos(side * half)) for side in (-1, 1)]
    floor = Floor(((-9, -9), (9, -9), (9, 9), (-9, 9)), tuple(wall((0, 0), end, 0.05) for end in ends))
    places = walk(Pose(0, 3.0, math.radians(aim) if angle > 40 else 0), Keys(1, 0), 8, 60, floor)
    wish = math.radians(abs(aim)) if angle > 40 else 0
    if wish < math.radians(90) - half - 0.03:  # pressed against both walls
        assert np.ptp(places[-60:], axis=0).max() <= 1e-6
    assert room(places, floor).min() >= BODY.skin - 1e-5


@pytest.mark.nightly
def test_nowhere_does_a_held_key_tremble():
    """Wherever a held key leads on a crowded floor: after ten seconds it goes on, or rests to the micrometre."""
    floor = dense_floor(np.random.default_rng(5))
    rng, rests = np.random.default_rng(6), 0
    starts = rng.uniform((0.5, 0.5), (23.5, 15.5), (300, 2))
    for x, z in starts[room(starts, floor) > 0.02][:70].tolist():
        places = walk(Pose(x, z, rng.uniform(-math.pi, math.pi)), Keys(1, 0), 10, 30, floor)[-30:]
        if np.linalg.norm(places[-1] - places[0]) < 0.005:
            rests += 1
            assert np.ptp(places, axis=0).max() <= 1e-6
    assert rests > 40


def test_obtuse_corner_is_walked_through():
    """Two walls of 150°: pressed into the first, the visitor slides on along the second."""
    bend = Prism(((-4, 0), (0, 0), (3.4641, 2), (3.4641, -1), (-4, -1)))
    floor = Floor(((-5, -2), (5, -2), (5, 6), (-5, 6)), (bend,))
    places = walk(Pose(-2, 1.0, math.radians(-60)), Keys(1, 0), 3, 60, floor)
    assert places[-1, 0] > 1.0
    assert room(places, floor).min() >= BODY.skin - 1e-5


def test_wedge_holds_without_trembling():
    """Two walls that close to a gap too narrow for the body."""
    floor = Floor(
        ((-4, -4), (4, -4), (4, 4), (-4, 4)),
        (wall((-2, 2), (-0.2, -2), 0.05), wall((2, 2), (0.2, -2), 0.05)),
    )
    places = walk(Pose(0.3, 2.5, 0.0), Keys(1, 0), 5, 60, floor)
    assert -1.9 < places[-1, 1] < 0
    assert np.ptp(places[-60:], axis=0).max() < 1e-6
    assert room(places, floor).min() >= BODY.skin - 1e-5


@pytest.mark.parametrize(("gap", "passes"), [(0.60, False), (0.615, False), (0.63, True)])
def test_gap_is_passed_only_if_the_body_and_its_skin_fit(gap, passes):
    floor = Floor(
        ((-4, -4), (4, -4), (4, 4), (-4, 4)),
        (wall((-4, 0), (-gap / 2, 0), 0.05), wall((gap / 2, 0), (4, 0), 0.05)),
    )
    assert (walk(Pose(0.0, 2.0), Keys(1, 0), 3, 60, floor)[-1, 1] < -1) == passes


def test_a_body_inside_a_solid_stays_there():
    assert step(Pose(0, 0, 0.4), Keys(1, 0), 1.0, STAND) == Pose(0, 0, 0.4)
    assert step(Pose(0.5, 0, 0.4), Keys(1, 0), 1.0, STAND) == Pose(0.5, 0, 0.4)


@pytest.mark.parametrize(
    ("pose", "keys", "dt"),
    [
        (Pose(math.nan, 0), Keys(1, 0), 0.1),
        (Pose(0, 0, math.inf), Keys(1, 0), 0.1),
        (Pose(0, 0), Keys(math.nan, 0), 0.1),
        (Pose(0, 0), Keys(1, 0), -0.1),
        (Pose(0, 0), Keys(1, 0), math.nan),
    ],
)
def test_non_finite_input_is_refused(pose, keys, dt):
    with pytest.raises(ValueError, match="finite|domain"):
        step(pose, keys, dt, EMPTY)


def test_long_silence_is_cut():
    assert step(Pose(0, 0), Keys(1, 0), 1e6, EMPTY) == step(Pose(0, 0), Keys(1, 0), 5.0, EMPTY)


def test_threads_have_worlds_of_their_own_and_agree():
    mine, others = world_of(FLOOR), []

    def work():
        others.append((world_of(FLOOR), walk(Pose(5.9, 6.2, 0.14), Keys(1, 0), 1, 30, FLOOR)))

    threads = [threading.Thread(target=work) for _ in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len({id(world) for world, _ in others} | {id(mine)}) == 4
    expected = walk(Pose(5.9, 6.2, 0.14), Keys(1, 0), 1, 30, FLOOR)
    assert all(np.array_equal(places, expected) for _, places in others)
