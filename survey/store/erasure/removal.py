"""Taking answers out: one by its code, or all of a version whose retention has ended."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import date

from sqlalchemy import ColumnElement, Connection, delete, func, select, update

from survey.errors import AnswerError
from survey.questionnaire import Questionnaire
from survey.store.answers import standing
from survey.store.audit import note_withdrawal
from survey.store.database import in_utc, now, tables
from survey.store.erasure.eraser import add_trace
from survey.store.erasure.leftovers import Erased, erased_answer

__all__ = ["Overdue", "erase", "overdue", "withdraw"]

TOO_LATE = (
    "the answers were frozen for evaluation, so this one cannot be withdrawn any more",
    "ask the curator; no name was stored with it",
)


@dataclass(frozen=True)
class Overdue:
    """What stands of a version whose retention has ended. oldest, newest: days (UTC) of receipt."""

    questionnaire: str
    version: int
    kept_until: date
    answers: int
    oldest: date
    newest: date


def withdraw(connection: Connection, questionnaire: str, submission: str) -> Erased | bool:
    """Delete scores and texts of an answer; the caller commits. What is to be looked for in the files then.

    True when it had been withdrawn before, False when there is no such answer. Raises AnswerError 409 once it was
    frozen for evaluation.
    """
    table = tables.submission
    mine = (table.c.id == submission, table.c.questionnaire == questionnaire)
    # Held until the commit: another process must not freeze between this look and the erasure. SQLite's
    # writing transaction holds everything already.
    asked = select(table.c.withdrawn, table.c.frozen, table.c.digest).where(*mine).with_for_update()
    found = connection.execute(asked).first()
    if found is None:
        return False
    if found.withdrawn is not None:
        return True
    if found.frozen is not None:
        raise AnswerError("id", *TOO_LATE, status=409)
    rows, texts = tables.answer, tables.suggestion
    items = connection.execute(select(rows.c.item).where(rows.c.submission == submission)).scalars().all()
    said = connection.execute(select(texts.c.module, texts.c.text).where(texts.c.submission == submission))
    written = {module: text for module, text in said}
    erase(connection, (table.c.id == submission,))
    note_withdrawal(connection, questionnaire)
    return erased_answer(add_trace(connection), submission, found.digest, items, written)


def erase(connection: Connection, which: tuple[ColumnElement[bool], ...]) -> int:
    """Delete scores and texts of the submissions; the rows stay as tombstones."""
    table = tables.submission
    ids = select(table.c.id).where(*which)
    for part in (tables.answer, tables.suggestion):
        connection.execute(delete(part).where(part.c.submission.in_(ids)))
    empty = {"withdrawn": now(), "digest": "", "exhibit": None}
    return connection.execute(update(table).where(*which).values(**empty)).rowcount


def overdue(connection: Connection, asked: Questionnaire, today: date) -> Overdue | None:
    """What `purge` would erase of a version; None: nothing, or its day has not passed."""
    if asked.retain_until is None or asked.retain_until >= today:
        return None
    received = tables.submission.c.received
    query = select(func.count(), func.min(received), func.max(received))
    number, oldest, newest = connection.execute(query.where(*standing(asked.id, asked.version))).one()
    if not number:
        return None
    return Overdue(
        asked.id, asked.version, asked.retain_until, number, in_utc(oldest).date(), in_utc(newest).date()
    )
