"""The page's own head.js: turning by keys is the same at any frame rate, and a tap is a step."""

import json
import math

import numpy as np
import pytest
from walk_page import HEAD

pytestmark = pytest.mark.browser

# Each play: {calm, pitch, dts, events: [[time, "press" | "lift" | "level", code, sign]…]} -> [yaw, pitch] a frame.
# An event is heard between two frames, as the page hears it.
SCRIPT = """
async ([source, plays]) => {
  const {Head, TURN} = await import(URL.createObjectURL(new Blob([source], {type: "text/javascript"})));
  const play = ({calm, pitch, dts, events}) => {
    const gaze = {yaw: 0, pitch}, head = new Head(gaze, () => calm), seen = [];
    let now = 0;
    for (const dt of dts) {
      now += dt;
      while (events.length && events[0][0] <= now) {
        const [at, what, code, sign] = events.shift();
        if (what === "press") head.press(code, sign, at);
        else if (what === "lift") head.lift(code, at);
        else head.level();
      }
      head.frame(Math.min(dt, 0.5), now);
      seen.push([gaze.yaw, gaze.pitch]);
    }
    return seen;
  };
  return JSON.stringify({turn: TURN, seen: JSON.parse(plays).map(play)});
}
"""
RATES = (240, 144, 60, 30, 12, 4)  # frames a second


@pytest.fixture(scope="module")
def play(chromium):
    tab = chromium.new_page()

    def run(*plays, calm=False, pitch=0.0):
        given = [{"calm": calm, "pitch": pitch, "dts": list(dts), "events": events} for dts, events in plays]
        told = json.loads(tab.evaluate(SCRIPT, [HEAD.read_text("utf-8"), json.dumps(given)]))
        return told["turn"], [np.array(seen) for seen in told["seen"]]

    yield run
    tab.close()


def held(code, sign, begin, end):
    return [[begin, "press", code, sign], [end, "lift", code, sign]]


def test_a_held_key_turns_equally_far_at_any_frame_rate(play):
    plays = [(np.full(4 * fps, 1 / fps), held("KeyQ", 1, 0.503, 2.507)) for fps in RATES]
    turn, seen = play(*plays)
    assert turn["rate"] == pytest.approx(math.radians(90))
    assert [track[-1, 0] for track in seen] == pytest.approx(
        [turn["rate"] * (2.004 - turn["ease"] / 2)] * len(RATES)
    )
    steps = np.diff(seen[2][:, 0])  # 60 frames a second
    assert steps.min() >= 0
    assert steps.max() <= turn["rate"] / 60 + 1e-9
    assert np.diff(steps).max() <= turn["rate"] / 60 / 10  # it eases in


def test_taps_are_steps_at_any_frame_rate_and_add_up(play):
    rng = np.random.default_rng(2)
    plays, wanted = [], []
    for fps in RATES * 40:
        events, time, sum_of_signs = [], 0.3, 0
        for _ in range(rng.integers(1, 6)):
            sign = int(rng.choice([-1, 1]))
            length = float(rng.uniform(0.001, 0.19))
            events += held("KeyQ" if sign > 0 else "KeyE", sign, time, time + length)
            time += length + float(rng.uniform(0.01, 0.4))
            sum_of_signs += sign
        plays.append((rng.uniform(0.5, 1.5, 6 * fps) / fps, events))
        wanted.append(sum_of_signs)
    turn, seen = play(*plays)
    assert turn["step"] == pytest.approx(math.radians(15))
    assert [track[-1, 0] / turn["step"] for track in seen] == pytest.approx(wanted, abs=1e-9)


def test_less_motion_finishes_a_tap_at_once(play):
    turn, (seen,) = play((np.full(60, 1 / 60), held("KeyE", -1, 0.5, 0.501)), calm=True)
    assert set(np.round(seen[:, 0] / turn["step"], 9)) == {0.0, -1.0}


def test_both_ways_at_once_cancel(play):
    events = sorted(held("KeyQ", 1, 0.5, 1.5) + held("KeyE", -1, 0.5, 1.5))
    _, (seen,) = play((np.full(120, 1 / 60), events))
    assert np.abs(seen[:, 0]).max() <= 1e-9


def test_home_comes_level_and_stays(play):
    for calm in (False, True):
        _, (seen,) = play((np.full(120, 1 / 60), [[0.5, "level", "Home", 0]]), pitch=-1.0, calm=calm)
        assert seen[-1, 1] == 0.0
        assert np.diff(seen[:, 1]).min() >= 0  # never past it
        assert np.count_nonzero(np.diff(seen[:, 1])) == (1 if calm else pytest.approx(16, abs=2))


def test_a_page_that_stood_still_does_not_spin(play):
    """A key held through three seconds without a frame turns as through one."""
    turn, (seen,) = play((np.array([1 / 60] * 60 + [3.0] + [1 / 60] * 60), [[0.5, "press", "KeyQ", 1]]))
    assert np.diff(seen[:, 0]).max() <= turn["rate"] * 0.5 + 1e-9
