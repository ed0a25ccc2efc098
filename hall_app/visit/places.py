"""The places of the hall: who is inside, and who waits, in the order of coming. No sockets, an explicit clock."""

from __future__ import annotations

import asyncio
from collections import Counter
from collections.abc import Callable
from time import monotonic

__all__ = ["AWAY", "KEPT", "MOST_VISITORS", "WAITING_OF_ONE_ADDRESS", "Places", "Ticket"]

MOST_VISITORS = 100  # unless the settings say otherwise
_WAITING_PER_PLACE = 4  # a queue longer than that would not move within an afternoon
WAITING_OF_ONE_ADDRESS = 160  # a class and a half; no one fills the queue alone
KEPT = 10.0  # [s] that a place waits for a page that is loaded again or has lost its line
AWAY = 900.0  # [s] without a word after which a place is given to somebody who waits


class Ticket:
    """One visitor's right to a place. `place` counts from 1 while waiting, 0 inside; `changed` is set when it moves.

    `given_up` is set when he was away for long and others wait; `heard` [s] is when he last did something.
    """

    def __init__(self, places: Places, key: str, address: str, page: str = "") -> None:
        self._places, self.key, self.address, self.page = places, key, address, page
        self.place = 0
        self.inside = False
        self.changed = asyncio.Event()
        self.given_up = asyncio.Event()
        self.heard = places.clock()

    def here(self) -> None:
        """The visitor does something."""
        self.heard = self._places.clock()

    def step_out(self) -> None:
        """The page has gone, and may be back in a moment: keep the place for its browser, KEPT long."""
        self._places.keep(self)

    def leave(self) -> None:
        """Give the place up, inside or in the queue; a second time changes nothing."""
        self._places.end(self)


class Places:
    """`most` visitors inside, the others in a bounded queue; a kept place stays where it is. clock: [s], monotonic."""

    def __init__(self, most: int = MOST_VISITORS, clock: Callable[[], float] = monotonic) -> None:
        self.most, self.clock = most, clock
        self._kept: dict[Ticket, float] = {}  # of both, until when
        self._inside: dict[Ticket, None] = {}
        self._waiting: dict[Ticket, None] = {}  # in the order of coming
        self._of_address: Counter[str] = Counter()
        self._of_key: Counter[str] = Counter()

    def __len__(self) -> int:
        return len(self._inside)

    @property
    def most_waiting(self) -> int:
        return self.most * _WAITING_PER_PLACE

    def inside_with(self, key: str) -> int:
        """How many pages of one browser are inside."""
        return self._of_key[key]

    def waits(self, key: str) -> bool:
        """True for a browser that has pages in the queue and none inside."""
        return not self._of_key[key] and any(ticket.key == key for ticket in self._waiting)

    def ask(self, key: str, address: str, page: str = "") -> Ticket | None:
        """A place, or one in the queue; None where the queue is full as well.

        key: of the browser. page: of a page that may come again while its last line has died without a word.
        """
        ticket = Ticket(self, key, address, page)
        former = self._former(ticket)
        if former is not None:
            self._follow(former, ticket)
            return ticket
        if len(self._inside) < self.most:
            self._admit(ticket)
            return ticket
        too_many = self._of_address[address] >= WAITING_OF_ONE_ADDRESS
        if too_many or len(self._waiting) >= self.most_waiting:
            return None
        self._waiting[ticket] = None
        self._of_address[address] += 1
        ticket.place = len(self._waiting)
        return ticket

    def _former(self, ticket: Ticket) -> Ticket | None:
        """Whose place this one has: its own page's, or one that is kept for its browser."""
        of_browser = [other for other in (*self._inside, *self._waiting) if other.key == ticket.key]
        own = [other for other in of_browser if ticket.page and other.page == ticket.page]
        kept = [other for other in of_browser if other in self._kept]
        return next(iter(own + kept), None)

    def _follow(self, former: Ticket, ticket: Ticket) -> None:
        if former in self._inside:
            self._forget(former)
            self._admit(ticket)
        else:
            self._waiting = {ticket if other is former else other: None for other in self._waiting}
            self._kept.pop(former, None)
            _one_less(self._of_address, former.address)
            self._of_address[ticket.address] += 1
            ticket.place = former.place
            self._move_up()
        former.given_up.set()  # where its line is open still, it ends

    def keep(self, ticket: Ticket) -> None:
        """The ticket's page has gone: its place is for the same browser's next page, also one that waits already."""
        following = next((other for other in self._present() if other.key == ticket.key), None)
        if ticket in self._waiting or (ticket in self._inside and following is None):
            self._kept[ticket] = self.clock() + KEPT
        elif ticket in self._inside and following is not None:
            self._forget(ticket)
            self._forget(following)
            self._admit(following)
            self._move_up()

    def expire(self) -> None:
        """Give away what nobody came back for; to be called when KEPT has passed."""
        for ticket in [ticket for ticket, until in self._kept.items() if until <= self.clock()]:
            self.end(ticket)

    def give_away(self) -> None:
        """Ask those who were away for long to give their places to as many who wait, most of one address first."""
        present = [ticket for ticket in self._inside if ticket not in self._kept]
        asked = sum(ticket.given_up.is_set() for ticket in present)
        of_address = Counter(ticket.address for ticket in present)
        away = [t for t in present if self.clock() - t.heard >= AWAY and not t.given_up.is_set()]
        away.sort(key=lambda ticket: (-of_address[ticket.address], ticket.heard))
        coming = sum(ticket in self._inside for ticket in self._kept)
        for ticket in away[: max(0, len(self._present()) - asked - coming)]:
            ticket.given_up.set()

    def end(self, ticket: Ticket) -> None:
        self._forget(ticket)
        self._move_up()

    def _present(self) -> list[Ticket]:
        """Who waits and is there."""
        return [ticket for ticket in self._waiting if ticket not in self._kept]

    def _move_up(self) -> None:
        for following in self._present()[: max(0, self.most - len(self._inside))]:
            self._forget(following)
            self._admit(following)
        for place, waiting in enumerate(self._waiting, 1):
            if waiting.place != place:
                waiting.place = place
                waiting.changed.set()

    def _forget(self, ticket: Ticket) -> None:
        if ticket in self._inside:
            del self._inside[ticket]
            self._kept.pop(ticket, None)
            _one_less(self._of_key, ticket.key)
        elif ticket in self._waiting:
            del self._waiting[ticket]
            self._kept.pop(ticket, None)
            _one_less(self._of_address, ticket.address)

    def _admit(self, ticket: Ticket) -> None:
        self._inside[ticket] = None
        self._of_key[ticket.key] += 1
        ticket.place, ticket.inside = 0, True
        ticket.here()
        ticket.changed.set()


def _one_less(counts: Counter[str], name: str) -> None:
    counts[name] -= 1
    if not counts[name]:
        del counts[name]
