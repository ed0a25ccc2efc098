"""Following the curator: edits are shown, what they lack is baked and then shown, what nobody needs any more goes."""

from __future__ import annotations

import functools
from collections.abc import Callable

from hall_app.content.loading import Watcher
from hall_app.content.problems import Problem
from hall_app.house.background import in_thread
from hall_app.house.baking.preparation import wanted_bakes
from hall_app.house.baking.queue import STOPPED, BakingQueue
from hall_app.house.baking.retention import tidy
from hall_app.house.house import House

__all__ = ["Following"]


class Following:
    """Looks at the content folder and at the queue of bakes, and brings the house up to date.

    light: whether the room's light is baked as well; say: hears of problems that an edit has brought, in a line each.
    """

    def __init__(self, house: House, queue: BakingQueue, *, light: bool, say: Callable[[str], None]) -> None:
        self._house, self._queue, self._light, self._say = house, queue, light, say
        self._watcher = Watcher(house.content.folder, house.content)
        self._owed = False  # something has changed that is not shown yet
        self._before: frozenset[Problem] | None = None  # the problems before it was first tried to be shown
        self._untidy = False  # a bake was finished since the data folder was last tidied

    async def look(self) -> None:
        """One look. Where something raises, what it kept from being done is done at the next."""
        house, queue = self._house, self._queue
        await in_thread(self._watcher.poll)
        content, ended = self._watcher.content, await queue.ended()
        if ended is not None:
            self._owed = self._untidy = True  # the queue tells it once
            house.baked(*ended)
        for bake in queue.stopped():
            house.baked(bake, STOPPED)
            self._owed = True
        if set(house.content.problems) - set(content.problems):
            queue.forgive()
        lit = self._light and house.room.lacking is None
        running = queue.running
        wanted = await in_thread(
            functools.partial(wanted_bakes, content, house.data, light=lit, running=running)
        )
        house.expect(queue.to_come(wanted))
        self._owed = self._owed or content is not house.content
        if self._owed:
            await self._show()
        house.catch_up()
        await queue.want(wanted)  # ending a bake takes a moment, and no edit waits for it
        if self._untidy:
            await in_thread(functools.partial(tidy, content, house.data, shown=house.folders, wanted=wanted))
            self._untidy = False

    async def _show(self) -> None:
        """Show the content as it is now, and say what is wrong with it that was not before."""
        if self._before is None:
            self._before = frozenset(self._house.problems)
        await self._house.replace(self._watcher.content)
        for problem in self._house.problems:
            if problem not in self._before:
                self._say(f"Problem: {problem}")
        self._owed, self._before = False, None
