"""Withdrawal codes of answers, of who asked that his account keep them: all that leads from a person to answers."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime

from sqlalchemy import delete, insert, select
from sqlalchemy.exc import IntegrityError

from hall_app.house.people.database import Ledger, tables
from hall_app.house.people.errors import PeopleError
from survey import AnswerError
from survey.questionnaire import submission_id
from survey.store.database import in_utc, now

__all__ = ["MOST_CODES", "AnswerCodes", "KeptCode", "checked_code"]

MOST_CODES = 50
_ACT = "answer codes"  # the journal tells that something was kept or forgotten, never which code


@dataclass(frozen=True)
class KeptCode:
    """made: when the account was given it (UTC)."""

    code: str
    made: datetime


def checked_code(text: str) -> str:
    """A code as it is kept, typed in any case. Raises PeopleError."""
    try:
        return submission_id(text.strip().lower())
    except AnswerError:
        raise PeopleError("answer-code") from None


class AnswerCodes:
    """What people asked their accounts to keep."""

    def __init__(self, ledger: Ledger) -> None:
        self._ledger = ledger

    def of(self, person: str) -> tuple[KeptCode, ...]:
        """The newest first."""
        table = tables.answer_code
        query = select(table).where(table.c.user == person).order_by(table.c.made.desc(), table.c.code)
        with self._ledger.read() as connection:
            return tuple(KeptCode(row.code, in_utc(row.made)) for row in connection.execute(query))

    def keep(self, person: str, code: str) -> None:
        """Keep a code; one that is kept stays so. Raises PeopleError."""
        known, table = checked_code(code), tables.answer_code
        kept = {one.code for one in self.of(person)}
        if known in kept:
            return
        if len(kept) >= MOST_CODES:
            raise PeopleError("codes-full", most=MOST_CODES)
        try:
            with self._ledger.change(person, _ACT, person) as connection:
                connection.execute(insert(table).values(user=person, code=known, made=now()))
        except IntegrityError:
            return  # kept by another window just now, or the account is gone: neither leaves anything to do

    def forget(self, person: str, code: str) -> None:
        """Keep it no longer; the answers stay as they are, and nothing leads to them from here. Raises PeopleError."""
        table = tables.answer_code
        with self._ledger.change(person, _ACT, person) as connection:
            gone = delete(table).where(table.c.user == person, table.c.code == checked_code(code))
            if not connection.execute(gone).rowcount:
                raise PeopleError("no-answer")
        self._ledger.scrub()
