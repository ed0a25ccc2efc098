"""One queue of bakes: what the content wants now decides what runs, what waits and what is given up.

One bake runs at a time. `decide` is the whole of the queue; the class below it starts and ends processes as it says.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Protocol

from hall_app.house.background import in_thread

__all__ = ["STOPPED", "Bake", "BakingQueue", "Build", "Decision", "Standing", "decide"]

STOPPED = "stopped in the office"  # why a bake failed that somebody stopped


@dataclass(frozen=True, slots=True)
class Bake:
    """Something to be baked.

    name: what of, unique among what is wanted at one time; key: of its inputs, so that another key is another bake;
    patient: the others change its inputs, so it waits for all of them and stands back for one that comes later.
    """

    name: str
    key: str
    patient: bool = False


@dataclass(frozen=True, slots=True)
class Decision:
    """run: what shall run now, None: nothing; waiting: what comes after it, in order."""

    run: Bake | None
    waiting: tuple[Bake, ...]


def decide(wanted: Iterable[Bake], running: Bake | None, failed: Mapping[Bake, str]) -> Decision:
    """What to do, given what is wanted, in its order, what runs, and which bakes failed (and why).

    What runs goes on while it is wanted; what failed is not tried again while its inputs stay.
    """
    left = sorted((bake for bake in wanted if bake not in failed), key=lambda bake: bake.patient)
    if not left:
        return Decision(None, ())
    urgent = any(not bake.patient for bake in left)
    run = running if running in left and not (running.patient and urgent) else left[0]
    return Decision(run, tuple(bake for bake in left if bake != run))


@dataclass(frozen=True, slots=True)
class Standing:
    """How a bake stands. state: "running", "waiting" or "failed"; line: what it is doing, or why it failed."""

    name: str
    state: str
    line: str = ""


class Build(Protocol):
    """A bake under way, in a process of its own (preparation.Preparation)."""

    def poll(self) -> int | None: ...
    def line(self) -> str: ...
    def outcome(self) -> str: ...
    def end(self) -> None: ...


class BakingQueue:
    """Bakes one after the other. Not thread-safe: lives on the server's event loop, and never keeps it waiting.

    begin: starts one; forsake: removes what a bake that nobody wants any more has left, in a thread beside the loop;
    tell: hears in a line what becomes of a bake (name, line, whether it is its last).
    """

    def __init__(
        self,
        begin: Callable[[Bake], Build],
        forsake: Callable[[Bake], None] = lambda bake: None,
        tell: Callable[[str, str, bool], None] = lambda name, line, last: None,
    ) -> None:
        self._begin, self._forsake, self._tell = begin, forsake, tell
        self._wanted: tuple[Bake, ...] = ()
        self._failed: dict[Bake, str] = {}
        self._running: tuple[Bake, Build] | None = None
        self._asked: deque[tuple[str, str]] = deque()  # by the office's threads, done at the next look

    def now(self) -> tuple[Standing, ...]:
        """All bakes, as they stand. For any thread."""
        running, failed, wanted = self._running, dict(self._failed), self._wanted
        found = [Standing(running[0].name, "running", running[1].line())] if running else []
        left = [bake for bake in wanted if bake not in failed and (running is None or bake != running[0])]
        found += [Standing(bake.name, "waiting") for bake in left]
        return (*found, *(Standing(bake.name, "failed", why) for bake, why in failed.items()))

    def ask(self, what: str, name: str) -> None:
        """what: "stop", or "again" for one that failed. For any thread; done at the next look."""
        self._asked.append((what, name))

    def stopped(self) -> tuple[Bake, ...]:
        """Do what was asked; the bakes that are given up by it, told once."""
        given_up: list[Bake] = []
        while self._asked:
            what, name = self._asked.popleft()
            if what == "again":
                self._failed = {bake: why for bake, why in self._failed.items() if bake.name != name}
            else:
                given_up += [bake for bake in self._wanted if bake.name == name and bake not in self._failed]
                self._failed |= dict.fromkeys(given_up, STOPPED)
        return tuple(given_up)

    @property
    def running(self) -> Bake | None:
        return self._running[0] if self._running is not None else None

    def to_come(self, wanted: Iterable[Bake]) -> tuple[Bake, ...]:
        """Those of `wanted` that will be baked: all that have not failed."""
        return tuple(bake for bake in wanted if bake not in self._failed)

    async def ended(self) -> tuple[Bake, str | None] | None:
        """The bake that has ended since the last look and why it failed (None: it is done), told once."""
        if self._running is None:
            return None
        bake, build = self._running
        status = build.poll()
        if status is None:
            self._tell(bake.name, build.line(), False)
            return None
        await in_thread(build.end)
        self._running = None
        failure = None if status == 0 else build.outcome()
        self._tell(bake.name, failure or build.outcome(), True)
        if failure is not None:
            self._failed[bake] = failure
        self._wanted = tuple(other for other in self._wanted if other != bake)
        return bake, failure

    def forgive(self) -> None:
        """Try again what has failed: a fault elsewhere in the content may have been the reason, and is mended."""
        self._failed.clear()

    async def want(self, wanted: Iterable[Bake]) -> None:
        """What is wanted from now on: begins the next bake, and ends the one that runs if it is not that."""
        self._wanted = tuple(wanted)
        self._failed = {bake: why for bake, why in self._failed.items() if bake in self._wanted}
        decision = decide(self._wanted, self.running, self._failed)
        if self._running is not None and self.running != decision.run:
            await self._give_up()
        if self._running is None and decision.run is not None:
            self._running = (decision.run, self._begin(decision.run))

    async def _give_up(self) -> None:
        assert self._running is not None
        bake, build = self._running
        await in_thread(build.end)
        self._running = None
        if bake in self._failed:
            self._tell(bake.name, STOPPED, True)
        elif bake in self._wanted:
            self._tell(bake.name, "put off, another goes first", True)
        else:
            self._tell(bake.name, "given up, what it is made from has changed", True)
            await in_thread(self._forsake, bake)

    def close(self) -> None:
        """End what runs; nothing is begun any more."""
        self._wanted = ()
        if self._running is not None:
            self._running[1].end()
            self._running = None
