"""What a part of the store is given to work with: a connection for as long as it needs one, and the time."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager
from datetime import UTC, datetime

from sqlalchemy import Connection

__all__ = ["Session", "in_utc", "now"]

Session = Callable[[], AbstractContextManager[Connection]]


def now() -> datetime:
    """To the second: finer times could tell who sat next to whom."""
    return datetime.now(UTC).replace(microsecond=0)


def in_utc(at: datetime) -> datetime:
    """A time as the database gives it."""
    # SQLite gives the time back without its zone; it was written in UTC.
    return at.astimezone(UTC) if at.tzinfo else at.replace(tzinfo=UTC)
