"""Who is in the hall: one visitor a page, tied to viser's client by a random mark."""

from __future__ import annotations

import asyncio
import hmac
import secrets
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from hall_app.walk import WalkSession

__all__ = ["Marks", "Visitor", "Visitors"]

MOST_WAITING = 256  # messages a page may lag behind before its socket is given up


@dataclass(eq=False)
class Visitor:
    """One open page. client: viser's client id, None until the page has found its mark; stands: whether its first view
    does; opened: the exhibit he sees from close by; compares: whether he sees what it compares instead; near: what has
    noticed him; turns: exhibit -> angle [rad], rate [rad/s] and time [s] that his page was told last."""

    walk: WalkSession
    client: int | None = None
    stands: bool = False
    display: str = "page"
    opened: str | None = None
    compares: bool = False
    near: set[tuple[str, int]] = field(default_factory=set)
    turns: dict[str, tuple[float, float, float]] = field(default_factory=dict)
    outbox: asyncio.Queue[dict[str, Any] | None] = field(default_factory=lambda: asyncio.Queue(MOST_WAITING))

    def say(self, message: dict[str, Any]) -> None:
        """Queue `message` for the page; a page that does not read is hung up on."""
        if self.outbox.full():
            while not self.outbox.empty():
                self.outbox.get_nowait()
            self.outbox.put_nowait(None)
            return
        self.outbox.put_nowait(message)


class Visitors:
    """The visitors now in the hall."""

    def __init__(self) -> None:
        self._here: list[Visitor] = []

    def __iter__(self) -> Iterator[Visitor]:
        return iter(tuple(self._here))

    def __len__(self) -> int:
        return len(self._here)

    def enter(self, visitor: Visitor) -> None:
        self._here.append(visitor)

    def leave(self, visitor: Visitor) -> None:
        if visitor in self._here:
            self._here.remove(visitor)

    def of_client(self, client: int) -> Visitor | None:
        return next((visitor for visitor in self._here if visitor.client == client), None)


class Marks:
    """Random marks that tell a page which of viser's clients it is: client ids alone are guessable."""

    def __init__(self) -> None:
        self._marks: dict[int, str] = {}

    def make(self, client: int) -> str:
        self._marks[client] = secrets.token_hex(8)
        return f"{client}.{self._marks[client]}"

    def forget(self, client: int) -> None:
        self._marks.pop(client, None)

    def client_of(self, mark: object) -> int | None:
        """The client a page claims to be, None for a claim that does not hold."""
        if not isinstance(mark, str):
            return None
        number, _, token = mark.partition(".")
        if not number.isdecimal() or len(number) > 9:
            return None
        known = self._marks.get(int(number))
        return int(number) if known and hmac.compare_digest(known.encode(), token.encode()) else None
