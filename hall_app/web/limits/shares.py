"""Fair shares of the event loop: of all that waits, next is what the address that has had least of it asks for.

What comes begins at once, as long as a pass of the loop has not taken long; what comes then waits for the next pass. So
whoever else is there waits for a millisecond's work, and not for the hundreds of pieces that one address can send.
"""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from time import perf_counter

__all__ = ["Shares"]

_PASS = 0.001  # [s] of work that begin in one pass of the loop; at least one piece does
_UNKNOWN = 0.001  # [s] that the first piece of an address is thought to take
_LATEST = 0.3  # weight of the latest piece in what the next one is thought to take


@dataclass(eq=False)
class _Share:
    """What one address has had [s] since nobody waited, what its next piece may take [s], and what of it waits."""

    had: float
    piece: float = _UNKNOWN
    waiting: deque[asyncio.Future[None]] = field(default_factory=deque)


class Shares:
    """Whose turn it is. clock: seconds."""

    def __init__(self, clock: Callable[[], float] = perf_counter) -> None:
        self._clock = clock
        self._of: dict[str, _Share] = {}  # empty while nobody waits
        self._waiting: dict[str, _Share] = {}
        self._level = 0.0  # [s] had by whoever was let in last: where those begin who come now
        self._pass_began = self._piece_began = 0.0
        self._at_work: _Share | None = None

    async def turn(self, name: str) -> None:
        """Wait for a turn of the address of that name; it lasts until the caller next waits for something."""
        loop, now = asyncio.get_running_loop(), self._clock()
        self._charge(now)
        if not self._of:
            self._pass_began = now
            loop.call_soon(self._pass)
        share = self._of.setdefault(name, _Share(self._level))
        if self._waiting or now - self._pass_began >= _PASS:
            turn = loop.create_future()
            if not share.waiting:
                share.had = max(share.had, self._level)
                self._waiting[name] = share
            share.waiting.append(turn)
            await turn
            now = self._clock()
            self._charge(now)
        self._at_work, self._piece_began = share, now

    def _pass(self) -> None:
        """Let as much begin as one pass takes, as far as can be foreseen."""
        now, begins = self._clock(), 0.0
        self._charge(now)
        self._pass_began = now
        if not self._waiting:
            self._of.clear()
            self._level = 0.0
            return
        foreseen: dict[_Share, float] = {}
        while self._waiting and begins < _PASS:
            name, share = min(
                self._waiting.items(), key=lambda item: item[1].had + foreseen.get(item[1], 0.0)
            )
            turn = share.waiting.popleft()
            if not share.waiting:
                del self._waiting[name]
            if not turn.done():  # whoever waited may have gone
                self._level = max(self._level, share.had)
                foreseen[share] = foreseen.get(share, 0.0) + share.piece
                begins += share.piece
                turn.set_result(None)
        asyncio.get_running_loop().call_soon(self._pass)

    def _charge(self, now: float) -> None:
        """The piece at work has stopped to wait for something."""
        share, self._at_work = self._at_work, None
        if share is not None:
            took = now - self._piece_began
            share.had += took
            share.piece += _LATEST * (took - share.piece)
