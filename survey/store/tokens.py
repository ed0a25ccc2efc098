"""Bearer tokens of researchers: shown once, kept only as a hash, good for a time and for one questionnaire or all."""

from __future__ import annotations

import hashlib
import hmac
import secrets
from contextlib import suppress
from dataclasses import dataclass
from datetime import date, datetime, timedelta

from sqlalchemy import delete, select, update

from survey.errors import AnswerError, StoreError
from survey.store.audit import note
from survey.store.database import Session, in_utc, now, tables

__all__ = ["TOKEN_DAYS", "Token", "Tokens"]

TOKEN_DAYS = 90  # a token is good for so long unless told: a study's analysis, not its researcher's career


@dataclass(frozen=True)
class Token:
    """What is known of a token once it has been handed out.

    questionnaire: the only one it opens, None: all. expires: its last day, None: it has none. used: the day of its
    last use, None: never. Days are in UTC.
    """

    id: int
    label: str
    made: datetime
    questionnaire: str | None
    expires: date | None
    used: date | None

    def expired(self, today: date) -> bool:
        return self.expires is not None and self.expires < today


def _digest(secret: str) -> str:
    # The secret has 256 random bits, so a slow password hash would add nothing.
    return hashlib.sha256(secret.encode("utf-8", "replace")).hexdigest()


class Tokens:
    """The tokens of one store."""

    def __init__(self, write: Session, read: Session) -> None:
        self._write, self._read = write, read

    def make(self, label: str, *, questionnaire: str | None = None, days: int | None = TOKEN_DAYS) -> str:
        """A new token; this is the only time that it can be seen. days: how long it is good, None: for ever."""
        secret = "survey_" + secrets.token_urlsafe(32)
        made = now()
        row = {
            "label": label,
            "digest": _digest(secret),
            "made": made,
            "questionnaire": questionnaire,
            "expires": None if days is None else made.date() + timedelta(days=days),
        }
        with self._write() as connection:
            (number,) = connection.execute(tables.token.insert().values(**row)).inserted_primary_key or (0,)
            note(connection, "token made", _told(number, label))
        return secret

    def admit(self, secret: str, questionnaire: str) -> Token:
        """The token, for reading that questionnaire. Its day is kept as that of its last use.

        Raises AnswerError: 401 for one that was not made here, was revoked or has expired; 403 for one that opens
        another questionnaire only.
        """
        given, table, today = _digest(secret), tables.token, now().date()
        with self._read() as connection:
            known = connection.execute(select(table)).all()
        # Every hash is compared, each in constant time.
        found = [row for row in known if hmac.compare_digest(given, row.digest)]
        if not found:
            remedy = "send Authorization: Bearer TOKEN; `survey token` makes one"
            raise AnswerError("authorization", "no valid token", remedy, status=401)
        token = _token(found[0])
        if token.expired(today):
            problem, remedy = f"the token expired on {token.expires}", "ask for a new one (`survey token`)"
            raise AnswerError("authorization", problem, remedy, status=401)
        if token.questionnaire not in (None, questionnaire):
            problem = f"the token opens {token.questionnaire} only"
            remedy = "ask for that, or for a token that opens this one (`survey token --questionnaire ID`)"
            raise AnswerError("authorization", problem, remedy, status=403)
        if token.used != today:
            self._note_use(token.id, today)
        return token

    def _note_use(self, number: int, today: date) -> None:
        # Once a day. A full disk must not keep a researcher from reading.
        with suppress(StoreError), self._write() as connection:
            connection.execute(update(tables.token).where(tables.token.c.id == number).values(used=today))

    def all(self) -> tuple[Token, ...]:
        """Every token, without its secret."""
        with self._read() as connection:
            found = connection.execute(select(tables.token).order_by(tables.token.c.id))
            return tuple(_token(row) for row in found)

    def revoke(self, number: int) -> bool:
        """Forget a token. False when there is none of that number."""
        table = tables.token
        with self._write() as connection:
            label = connection.execute(select(table.c.label).where(table.c.id == number)).scalar_one_or_none()
            if label is None:
                return False
            connection.execute(delete(table).where(table.c.id == number))
            note(connection, "token revoked", _told(number, label))
            return True


def _token(row) -> Token:
    return Token(row.id, row.label, in_utc(row.made), row.questionnaire, row.expires, row.used)


def _told(number: int, label: str) -> str:
    return f"{number} {label}".strip()
