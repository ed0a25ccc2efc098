"""Slow work: shared while it is under way, few at once, kept per state."""

from __future__ import annotations

import asyncio
import threading
import time

import event_loop
import pytest

from hall_app.web.answers import Answers, Work


def test_who_asks_for_the_same_waits_for_the_same():
    calls = []

    def make() -> object:
        calls.append(1)
        time.sleep(0.05)
        return object()

    async def story() -> None:
        work = Work()
        assert len(set(await asyncio.gather(*(work.of("key", make) for _ in range(20))))) == 1
        assert len(calls) == 1
        await work.of("key", make)
        assert len(calls) == 2, "what is done is nobody's business here"

    event_loop.run(story())


def test_few_things_are_done_at_once():
    running, most, changing = 0, 0, threading.Lock()

    def make() -> None:
        nonlocal running, most
        with changing:
            running += 1
            most = max(most, running)
        time.sleep(0.01)
        with changing:
            running -= 1

    async def story() -> None:
        work = Work(at_once=2)
        await asyncio.gather(*(work.of(key, make) for key in range(30)))
        assert most == 2

    event_loop.run(story())


def test_a_failure_belongs_to_all_who_wait_and_is_not_kept():
    go = threading.Event()

    def fail() -> None:
        go.wait(20)
        raise LookupError("not today")

    async def story() -> None:
        answers = Answers(Work())
        asked = [asyncio.create_task(answers.of(1, "key", fail)) for _ in range(3)]
        await asyncio.sleep(0)
        go.set()
        assert [type(e) for e in await asyncio.gather(*asked, return_exceptions=True)] == [LookupError] * 3
        assert await answers.of(1, "key", lambda: "well") == "well"

    event_loop.run(story())


def test_who_leaves_takes_nothing_from_the_others():
    go = threading.Event()

    async def story() -> None:
        work = Work()
        first = asyncio.create_task(work.of("key", lambda: go.wait(20)))
        second = asyncio.create_task(work.of("key", lambda: go.wait(20)))
        await asyncio.sleep(0.01)
        first.cancel()
        with pytest.raises(asyncio.CancelledError):
            await first
        go.set()
        assert await second is True

    event_loop.run(story())


def test_what_comes_late_is_no_answer_of_the_next_state():
    go = threading.Event()

    async def story() -> None:
        answers = Answers(Work())
        late = asyncio.create_task(answers.of("old", "key", lambda: go.wait(20) and "old"))
        await asyncio.sleep(0.01)
        assert await answers.of("new", "key", lambda: "new") == "new"
        go.set()
        assert await late == "old"
        assert await answers.of("new", "key", lambda: "made again") == "new"
        assert await answers.of("old", "key", lambda: "made again") == "made again", "forgotten"

    event_loop.run(story())
