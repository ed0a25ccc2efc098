"""The TCP connections that are open: whose they are, and which of them makes room. An explicit clock, no sockets."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from time import monotonic
from typing import Protocol

from hall_app.web.limits.addresses import name_of

__all__ = ["MOST_OF_ONE_ADDRESS", "OpenLine", "OpenLines"]

MOST_OF_ONE_ADDRESS = 1000  # a class of a hundred: two sockets and six plain connections each, and some
ASKS_WITHIN = 15.0  # [s] for a whole request
TAKES_WITHIN = 30.0  # [s] in which something of an answer is taken


class Connection(Protocol):
    """What is needed of a connection: an end at once, and the bytes that wait to be sent."""

    def abort(self) -> None: ...
    def get_write_buffer_size(self) -> int: ...


class OpenLine:
    """One connection. `idle` [s]: since when it owes a request, None while one is answered and for WebSockets."""

    def __init__(self, lines: OpenLines, connection: Connection, name: str, now: float) -> None:
        self._lines, self._connection, self.name = lines, connection, name
        self.idle: float | None = now
        self._unsent, self._moved = 0, now

    def asked(self) -> None:
        """A whole request has come."""
        self.idle = None

    def answered(self) -> None:
        """All has been said: it is its turn to ask again."""
        self.idle = self._lines.clock()

    def end(self) -> None:
        """It has gone; a second time changes nothing."""
        self._lines.forget(self)

    def cut(self) -> None:
        self._connection.abort()
        self.end()

    def overdue(self, now: float) -> bool:
        """True when it has not asked, or has taken nothing of its answer, for too long."""
        unsent = self._connection.get_write_buffer_size()
        if unsent == 0 or unsent < self._unsent:
            self._moved = now
        self._unsent = unsent
        if unsent:
            self.idle = now if self.idle is not None else None  # it is still reading
            return now - self._moved > TAKES_WITHIN
        return self.idle is not None and now - self.idle > ASKS_WITHIN


class OpenLines:
    """`most` connections at a time. clock: seconds, monotonic."""

    def __init__(self, most: int, clock: Callable[[], float] = monotonic) -> None:
        self.most, self.clock = most, clock
        self._of: dict[str, dict[OpenLine, None]] = {}
        self._count = 0

    def __len__(self) -> int:
        return self._count

    def come(self, connection: Connection, address: str, *, proxy: bool = False) -> OpenLine | None:
        """A connection begins; at a limit the oldest idle one makes room. None where nobody idles: it is cut.

        proxy: it stands for many, and may open any number.
        """
        name = name_of(address)
        full = not proxy and len(self._of.get(name, ())) >= MOST_OF_ONE_ADDRESS
        if (full and not self._make_room([name])) or (
            self._count >= self.most
            and not self._make_room(sorted(self._of, key=lambda other: -len(self._of[other])))
        ):
            connection.abort()
            return None
        line = OpenLine(self, connection, name, self.clock())
        self._of.setdefault(name, {})[line] = None
        self._count += 1
        return line

    def forget(self, line: OpenLine) -> None:
        own = self._of.get(line.name, {})
        if line in own:
            del own[line]
            self._count -= 1
            if not own:
                del self._of[line.name]

    def sweep(self) -> None:
        """Cut what is overdue; to be called every few seconds."""
        now = self.clock()
        for line in [line for own in self._of.values() for line in own if line.overdue(now)]:
            line.cut()

    def _make_room(self, names: Iterable[str]) -> bool:
        """Cut the oldest idle connection of the first of these addresses that has one."""
        for name in names:
            idle = [(line.idle, n, line) for n, line in enumerate(self._of[name]) if line.idle is not None]
            if idle:
                min(idle)[2].cut()
                return True
        return False
