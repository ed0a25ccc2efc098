"""Walking through stalls: server, line and page stand still at random, and what was shown stays true."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest
from full_matrix import by_day
from walk_moves import FLOOR, KEYS
from walk_page import Crowd

from hall_app.walk import BUCKET, MAX_INPUT_DT, SPEED, Floor, Grid, Keys, Pose, WalkSession, bake

pytestmark = pytest.mark.browser

OPEN = Floor(((0, 0), (60, 0), (60, 3), (0, 3)), ())
START = Pose(58.0, 1.5, math.pi / 2)  # looking along the floor
JUMP = 0.05  # [m] that a view may leap
LONGEST = 0.5  # [s] a frame, as visit.js hands it on


@pytest.fixture(scope="module")
def tab(chromium):
    tab = chromium.new_page()
    yield tab
    tab.close()


@pytest.fixture(scope="module")
def long_grid() -> Grid:
    return bake(OPEN, cell=0.1)


@dataclass
class Visit:
    """One page and its session, with a line between them. `stalls`: [begin, end] of a server that stands still [s]."""

    walk: WalkSession
    times: np.ndarray  # (frames,) [s]
    one_way: np.ndarray  # (frames,) [s] of a message that leaves in this frame
    stalls: list[tuple[float, float]]
    keys: list[Keys]
    yaws: np.ndarray
    rate: float = 1.0  # of the server's clock
    answers: list[list[float]] = field(default_factory=list)
    arrived: float = 0.0  # [s] of the last message at the server, and
    heard: float = 0.0  # of the last answer at the page: a line keeps the order
    refused: int = 0
    shown: list[tuple[float, float]] = field(default_factory=list)
    dts: list[float] = field(default_factory=list)
    waited: list[bool] = field(default_factory=list)
    worst: float = 0.0

    def frame(self, k: int) -> list[Any]:
        """What the page hears before frame k, and the frame itself."""
        now, before = self.times[k], self.times[k - 1] if k else 0.0
        due = [answer for answer in self.answers if answer[3] <= now]
        self.answers = self.answers[len(due) :]
        still = now - before > LONGEST  # the page stood still and hears everything at once
        heard = [[seq, x, z, now if still else at] for seq, x, z, at in due]
        self.dts.append(min(now - before, LONGEST))
        keys = self.keys[k]
        return [heard, self.dts[-1], keys.forward, keys.right, float(self.yaws[k]), float(now)]

    def saw(self, k: int, told: list[Any]) -> None:
        """What the page showed in frame k; what it sent goes to the server, whose answer comes back in its time."""
        x, z, inputs, waiting, self.worst = told
        self.shown.append((x, z))
        self.waited.append(waiting)
        if not inputs:
            return
        self.arrived = max(self.arrived, self.times[k] + self.one_way[k])
        for begin, end in self.stalls:
            if begin <= self.arrived < end:
                self.arrived = end
        reply = self.walk.inputs(inputs, self.rate * self.arrived)
        self.refused += reply.refused
        self.heard = max(self.heard, self.arrived + self.one_way[k])
        self.answers.append([reply.seq, reply.x, reply.z, self.heard])

    def leap(self) -> float:
        """Longest displayed step beyond what is walked in that time [m]."""
        steps = np.hypot(*np.diff(np.array(self.shown), axis=0).T)
        return float((steps - SPEED * np.array(self.dts[1:])).max())

    def thrown_back(self) -> float:
        """Farthest the display ever was behind the place it had reached [m], for who walks straight on."""
        gone = START.x - np.array(self.shown)[:, 0]
        return float((np.maximum.accumulate(gone) - gone).max())


def play(tab: Any, grid: Grid, visits: list[Visit]) -> dict[str, float]:
    """All visits, frame by frame; the page's constants."""
    crowd = Crowd(tab, grid, [(visit.walk.pose.x, visit.walk.pose.z) for visit in visits])
    for k in range(len(visits[0].times)):
        for visit, told in zip(visits, crowd.step([visit.frame(k) for visit in visits]), strict=True):
            visit.saw(k, told)
    return crowd.pace


def frames(rng: np.random.Generator, count: int, period: float, stalls: int = 0) -> np.ndarray:
    """(count,) [s] times of frames about `period` apart; `stalls` of them are late by up to 3 s."""
    dts = period * rng.uniform(0.6, 1.4, count)
    dts[rng.integers(0, count, stalls)] += rng.uniform(0.3, 3.0, stalls)
    return np.cumsum(dts)


def line(rng: np.random.Generator, count: int, round_trip: float, jitter: float) -> np.ndarray:
    return round_trip / 2 + rng.uniform(0, jitter / 2, count)


def server_stalls(rng: np.random.Generator, end: float) -> list[tuple[float, float]]:
    """Up to four, of up to 5 s, in order."""
    times = np.sort(rng.uniform(0, end, 2 * rng.integers(0, 5)))
    return [(a, min(b, a + 5.0)) for a, b in times.reshape(-1, 2)]


def random_visit(rng: np.random.Generator, grid: Grid, floor: Floor, count: int, *, straight: bool) -> Visit:
    """A visit with anything in it that may stand still."""
    period = float(rng.choice([1 / 144, 1 / 60, 1 / 30, 0.1, 0.3], p=[0.1, 0.4, 0.3, 0.1, 0.1]))
    times = frames(rng, count, period, int(rng.integers(0, 3)))
    start = START
    if not straight:
        start = Pose(*grid.nearest_free(*rng.uniform((0, 0), (12, 8))))
    change = int(rng.integers(5, 40))
    spells = count // change + 1
    keys = [[*KEYS, Keys()][k] for k in rng.integers(0, 9, spells)]
    if straight:
        keys = [Keys(1, 0) if rng.random() < 0.8 else Keys() for _ in range(spells)]
    yaws = np.full(spells, START.yaw) if straight else rng.uniform(-math.pi, math.pi, spells)
    return Visit(
        walk=WalkSession(floor, grid, start, now=0.0),
        times=times,
        one_way=line(
            rng, count, float(rng.choice([0.0, 0.03, 0.08, 0.3, 0.6, 1.5])), float(rng.choice([0, 0.05, 0.3]))
        ),
        stalls=server_stalls(rng, times[-1]),
        keys=[keys[k // change] for k in range(count)],
        yaws=np.repeat(yaws, change)[:count],
        rate=float(rng.uniform(0.99, 1.01)),
    )


@pytest.mark.nightly
def test_no_stall_takes_back_what_was_shown(tab, long_grid):
    """Straight on, 2000 visits with stalls of server, line and page: nothing is refused, nobody is thrown back."""
    rng = np.random.default_rng(18)
    visits = [random_visit(rng, long_grid, OPEN, 120, straight=True) for _ in range(2000)]
    pace = play(tab, long_grid, visits)
    assert pace["horizon"] < BUCKET
    assert sum(bool(visit.stalls) for visit in visits) > 1000
    assert sum(visit.refused for visit in visits) == 0
    assert max(visit.thrown_back() for visit in visits) <= JUMP
    assert max(visit.leap() for visit in visits) <= JUMP


@pytest.mark.nightly
def test_no_stall_takes_back_a_walk_among_solids(tab):
    """Any keys, any heading: what the grid does not know exactly may differ, a stall adds nothing."""
    rng, grid = np.random.default_rng(4), bake(FLOOR)
    visits = [random_visit(rng, grid, FLOOR, 120, straight=False) for _ in range(400)]
    play(tab, grid, visits)
    assert sum(visit.refused for visit in visits) == 0
    assert max(visit.leap() for visit in visits) <= JUMP
    assert max(visit.worst for visit in visits) <= JUMP


@pytest.mark.parametrize("stall", by_day([4.0], [1.5, 2.5, 4.0, 5.0]))
def test_a_held_key_through_a_stall(tab, long_grid, stall):
    """Walks on for the horizon, stands and says so, and walks on at once when the server answers again."""
    times = np.arange(1, 60 * 12) / 60
    visit = Visit(
        walk=WalkSession(OPEN, long_grid, START, now=0.0),
        times=times,
        one_way=np.full(len(times), 0.04),
        stalls=[(3.0, 3.0 + stall)],
        keys=[Keys(1, 0)] * len(times),
        yaws=np.full(len(times), START.yaw),
    )
    pace = play(tab, long_grid, [visit])
    gone, waited = START.x - np.array(visit.shown)[:, 0], np.array(visit.waited)
    assert visit.refused == 0
    assert visit.thrown_back() <= JUMP
    assert visit.leap() <= JUMP
    during = (times > 3.0) & (times < 3.0 + stall)
    assert np.ptp(gone[during]) <= SPEED * (pace["horizon"] + 0.1)
    told = times[waited]
    assert 3.0 + pace["patience"] - 0.2 < told[0] < 3.0 + pace["patience"] + 0.2
    assert told[-1] < 3.0 + stall + 0.2
    assert np.all(np.diff(np.flatnonzero(waited)) == 1)  # once, without flickering
    after = times > 3.0 + stall + 0.1
    assert np.ptp(gone[after]) >= 0.97 * SPEED * np.ptp(times[after])


@pytest.mark.parametrize("fps", [60, 24])
@pytest.mark.parametrize("round_trip", by_day([0.6], [0.0, 0.3, 0.6]))
def test_ordinary_latency_neither_slows_nor_speaks(tab, long_grid, round_trip, fps):
    rng = np.random.default_rng(7)
    times = frames(rng, 8 * fps, 1 / fps)
    visit = Visit(
        walk=WalkSession(OPEN, long_grid, START, now=0.0),
        times=times,
        one_way=line(rng, len(times), round_trip, 0.1),
        stalls=[],
        keys=[Keys(1, 0)] * len(times),
        yaws=np.full(len(times), START.yaw),
    )
    play(tab, long_grid, [visit])
    assert visit.refused == 0
    assert not any(visit.waited)
    assert START.x - visit.shown[-1][0] == pytest.approx(SPEED * times[-1], rel=0.005)


def test_a_hacked_page_gains_a_bucket_and_no_more(long_grid):
    """It never waits, sends what it likes when it likes, through stalls of the server."""
    rng = np.random.default_rng(9)
    for _ in range(60):
        walk, time, seq = WalkSession(OPEN, long_grid, START, now=0.0), 0.0, 0
        for _ in range(40):
            time += float(rng.choice([0.001, 0.03, 0.3, 2.0]))
            batch = [[seq := seq + 1, MAX_INPUT_DT, 1, 0, START.yaw, 1.6] for _ in range(rng.integers(1, 20))]
            walk.inputs(batch, time)
            assert START.x - walk.pose.x <= SPEED * (1.02 * time + BUCKET) + 1e-6
            if walk.pose.x < 5:
                break
