"""The queue of bakes: what runs, what waits, what is given up, and that nobody waits for it."""

from __future__ import annotations

import asyncio
from collections.abc import Coroutine
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hall_app.house.baking import Bake, BakingQueue, Decision, decide

ROBE, SCARF, LIGHT = Bake("robe", "1"), Bake("scarf", "1"), Bake("light", "1", patient=True)
NEWER = Bake("robe", "2")

CASES = {
    "nothing is wanted": ([], None, {}, None, ()),
    "the first begins": ([ROBE, SCARF], None, {}, ROBE, (SCARF,)),
    "what runs goes on, wherever it stands": ([ROBE, SCARF], SCARF, {}, SCARF, (ROBE,)),
    "other inputs are another bake": ([NEWER, SCARF], ROBE, {}, NEWER, (SCARF,)),
    "what is not wanted any more ends": ([], ROBE, {}, None, ()),
    "what failed is not tried again": ([ROBE, SCARF], None, {ROBE: "why"}, SCARF, ()),
    "with other inputs it is": ([NEWER], None, {ROBE: "why"}, NEWER, ()),
    "the patient one comes last": ([LIGHT, ROBE], None, {}, ROBE, (LIGHT,)),
    "it stands back for one that comes later": ([LIGHT, ROBE], LIGHT, {}, ROBE, (LIGHT,)),
    "not for one that failed": ([LIGHT, ROBE], LIGHT, {ROBE: "why"}, LIGHT, ()),
}


@pytest.mark.parametrize("case", CASES)
def test_what_to_do(case: str):
    wanted, running, failed, run, waiting = CASES[case]
    assert decide(wanted, running, failed) == Decision(run, waiting)


bakes = st.builds(Bake, st.sampled_from("abc"), st.sampled_from("12"), st.booleans())


@settings(deadline=None)
@given(st.lists(bakes, unique=True), st.none() | bakes, st.sets(bakes))
def test_everything_wanted_is_run_or_waits_or_has_failed(wanted, running, failed):
    found = decide(wanted, running, dict.fromkeys(failed, "why"))
    told = [*([found.run] if found.run else []), *found.waiting]
    assert sorted(told, key=str) == sorted(set(wanted) - failed, key=str)
    assert found.run is not None or not told
    assert decide(wanted, found.run, dict.fromkeys(failed, "why")) == found  # it does not waver


class Build:
    """A bake that ends when the test says so."""

    def __init__(self, log: list[str], bake: Bake) -> None:
        self.log, self.name, self.status = log, f"{bake.name}-{bake.key}", None
        log.append(f"begin {self.name}")

    def poll(self) -> int | None:
        return self.status

    def line(self) -> str:
        return "half"

    def outcome(self) -> str:
        return "done" if self.status == 0 else "no such yarn"

    def end(self) -> None:
        self.log.append(f"end {self.name}")


class Stand:
    """A queue with builds of the test's own."""

    def __init__(self) -> None:
        self.log: list[str] = []
        self.builds: dict[Bake, Build] = {}
        self.queue = BakingQueue(self._begin, lambda bake: self.log.append(f"forsake {bake.name}-{bake.key}"))

    def _begin(self, bake: Bake) -> Build:
        self.builds[bake] = Build(self.log, bake)
        return self.builds[bake]


def run_alone(work: Coroutine[Any, Any, None]) -> None:
    """asyncio.run in a thread of its own: a browser test before may have left its loop in the main thread."""
    with ThreadPoolExecutor(1) as pool:
        pool.submit(asyncio.run, work).result()


def test_a_superseded_bake_is_ended_and_cleared_away_before_the_next_begins():
    stand = Stand()

    async def story() -> None:
        await stand.queue.want([ROBE, SCARF])
        assert stand.queue.running == ROBE
        await stand.queue.want([ROBE, SCARF])
        await stand.queue.want([NEWER, SCARF])
        assert stand.queue.running == NEWER

    run_alone(story())
    assert stand.log == ["begin robe-1", "end robe-1", "forsake robe-1", "begin robe-2"]


def test_a_bake_that_is_put_off_keeps_what_it_has_done():
    stand = Stand()

    async def story() -> None:
        await stand.queue.want([LIGHT])
        await stand.queue.want([ROBE, LIGHT])

    run_alone(story())
    assert stand.log == ["begin light-1", "end light-1", "begin robe-1"]


def test_one_after_the_other_and_a_failure_is_told_once():
    stand = Stand()

    async def story() -> None:
        wanted = [ROBE, SCARF]
        await stand.queue.want(wanted)
        assert await stand.queue.ended() is None
        stand.builds[ROBE].status = 1
        assert await stand.queue.ended() == (ROBE, "no such yarn")
        assert await stand.queue.ended() is None
        await stand.queue.want(wanted)
        assert stand.queue.running == SCARF
        stand.builds[SCARF].status = 0
        assert await stand.queue.ended() == (SCARF, None)
        await stand.queue.want([ROBE])
        assert stand.queue.running is None
        stand.queue.forgive()
        await stand.queue.want([ROBE])
        assert stand.queue.running == ROBE
        stand.queue.close()
        assert stand.queue.running is None

    run_alone(story())
    assert stand.log == [
        "begin robe-1",
        "end robe-1",
        "begin scarf-1",
        "end scarf-1",
        "begin robe-1",
        "end robe-1",
    ]


def test_inputs_that_changed_and_changed_back_are_tried_again():
    stand = Stand()

    async def story() -> None:
        await stand.queue.want([ROBE])
        stand.builds[ROBE].status = 1
        await stand.queue.ended()
        for wanted in (ROBE, NEWER, ROBE):
            await stand.queue.want([wanted])

    run_alone(story())
    assert stand.log[2:] == ["begin robe-2", "end robe-2", "forsake robe-2", "begin robe-1"]
