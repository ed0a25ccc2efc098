"""What comes out of the store: the answers that stand, and what of its version one of them was asked."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from datetime import datetime
from typing import Literal

from sqlalchemy import ColumnElement, Connection, Table, select

from survey.errors import AnswerError
from survey.questionnaire import Answer, Language, Questionnaire
from survey.store.database import in_utc, tables

__all__ = ["WITHDRAWN", "Given", "Stored", "given_of", "given_answer", "standing", "stored_rows"]

WITHDRAWN = ("this answer was withdrawn", "make a fresh id to answer anew")


@dataclass(frozen=True)
class Stored:
    """One row for the researcher: the answer and when it was received (UTC)."""

    answer: Answer
    received: datetime


@dataclass(frozen=True)
class Given:
    """An answer as its code leads to it: to which questionnaire, and whether it can still be withdrawn ("standing")."""

    questionnaire: str
    state: Literal["standing", "frozen", "withdrawn"]


def given_of(connection: Connection, codes: Iterable[str]) -> dict[str, Given]:
    """Code -> its answer; what is no code of an answer is left out."""
    table = tables.submission
    query = select(table.c.id, table.c.questionnaire, table.c.withdrawn, table.c.frozen)
    found = connection.execute(query.where(table.c.id.in_(set(codes))))
    return {
        row.id: Given(
            row.questionnaire,
            "withdrawn" if row.withdrawn is not None else "standing" if row.frozen is None else "frozen",
        )
        for row in found
    }


def standing(questionnaire: str, version: int) -> tuple[ColumnElement[bool], ...]:
    table = tables.submission
    return (table.c.questionnaire == questionnaire, table.c.version == version, table.c.withdrawn.is_(None))


def stored_rows(connection: Connection, questionnaire: Questionnaire) -> tuple[Stored, ...]:
    """All answers to this version that stand, in the order in which they were received."""
    table = tables.submission
    of_submission = standing(questionnaire.id, questionnaire.version)
    heads = connection.execute(
        select(table).where(*of_submission).order_by(table.c.received, table.c.id)
    ).all()
    scored = _grouped(connection, tables.answer, "item", "score", of_submission)
    texts = _grouped(connection, tables.suggestion, "module", "text", of_submission)
    none: dict = {}
    return tuple(
        _stored(questionnaire, head, scored.get(head.id, none), texts.get(head.id, none)) for head in heads
    )


def given_answer(
    connection: Connection, questionnaire: str, submission: str
) -> tuple[int, frozenset[str]] | None:
    """(version, items that were asked) of the answer with this id; None: no such answer.

    The rows say what was asked, also of what was left out, which a submission need not name.
    Raises AnswerError 410 when it was withdrawn: its rows are gone.
    """
    table, rows = tables.submission, tables.answer
    mine = (table.c.id == submission, table.c.questionnaire == questionnaire)
    found = connection.execute(select(table.c.version, table.c.withdrawn).where(*mine)).first()
    if found is None:
        return None
    if found.withdrawn is not None:
        raise AnswerError("id", *WITHDRAWN, status=410)
    items = connection.execute(select(rows.c.item).where(rows.c.submission == submission)).scalars()
    return found.version, frozenset(items)


def _grouped(connection: Connection, table: Table, key: str, value: str, of_submission) -> dict[str, dict]:
    """submission → {key: value} in one query."""
    query = (
        select(table.c.submission, table.c[key], table.c[value]).join(tables.submission).where(*of_submission)
    )
    groups: dict[str, dict] = {}
    for submission, name, content in connection.execute(query):
        groups.setdefault(submission, {})[name] = content
    return groups


def _stored(questionnaire: Questionnaire, head, scores: dict, texts: dict) -> Stored:
    language: Language = "zh" if head.language == "zh" else "en"
    answer = Answer(
        id=head.id,
        questionnaire=head.questionnaire,
        version=head.version,
        language=language,
        # An item without a row was not asked; one that was asked and not answered has a row without a score.
        scores=tuple((item, scores[item]) for item in questionnaire.item_ids if item in scores),
        suggestions=tuple((m.id, texts[m.id]) for m in questionnaire.modules if m.id in texts),
        exhibit=head.exhibit,
    )
    return Stored(answer, in_utc(head.received))
