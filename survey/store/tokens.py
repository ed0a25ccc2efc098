"""Bearer tokens of researchers: shown once, kept only as a hash."""

from __future__ import annotations

import hashlib
import hmac
import secrets
from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass
from datetime import UTC, datetime

from sqlalchemy import Connection, delete, select

from survey.store import tables

__all__ = ["Token", "Tokens"]

Session = Callable[[], AbstractContextManager[Connection]]


@dataclass(frozen=True)
class Token:
    """What is known of a token once it has been handed out."""

    id: int
    label: str
    made: datetime


def _digest(secret: str) -> str:
    # The secret has 256 random bits, so a slow password hash would add nothing.
    return hashlib.sha256(secret.encode("utf-8", "replace")).hexdigest()


class Tokens:
    """The tokens of one store."""

    def __init__(self, write: Session, read: Session) -> None:
        self._write, self._read = write, read

    def make(self, label: str) -> str:
        """A new token; this is the only time that it can be seen."""
        secret = "survey_" + secrets.token_urlsafe(32)
        row = {"label": label, "digest": _digest(secret), "made": datetime.now(UTC).replace(microsecond=0)}
        with self._write() as connection:
            connection.execute(tables.token.insert().values(**row))
        return secret

    def admits(self, secret: str) -> bool:
        """True for a token that was made here and not revoked. Every hash is compared, each in constant time."""
        given = _digest(secret)
        with self._read() as connection:
            known = connection.execute(select(tables.token.c.digest)).scalars().all()
        matches = [hmac.compare_digest(given, digest) for digest in known]
        return any(matches)

    def all(self) -> tuple[Token, ...]:
        """Every token, without its secret."""
        table = tables.token
        query = select(table.c.id, table.c.label, table.c.made).order_by(table.c.id)
        with self._read() as connection:
            return tuple(Token(*row) for row in connection.execute(query))

    def revoke(self, number: int) -> bool:
        """Forget a token. False when there is none of that number."""
        with self._write() as connection:
            return connection.execute(delete(tables.token).where(tables.token.c.id == number)).rowcount == 1
