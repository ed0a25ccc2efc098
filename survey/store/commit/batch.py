"""Committing a batch of answers in one transaction: each gets its own receipt or refusal."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass

from sqlalchemy import Connection, Table, select
from sqlalchemy.dialects import postgresql, sqlite

from survey.errors import AnswerError
from survey.questionnaire import Answer, Questionnaire
from survey.store.answers import WITHDRAWN
from survey.store.database import now, tables

__all__ = ["Entry", "Receipt", "commit_batch", "freeze_version", "insert_new"]

Entry = tuple[Questionnaire, Answer]


@dataclass(frozen=True)
class Receipt:
    """A committed submission. `replayed`: the same body had been committed before."""

    id: str
    replayed: bool


def commit_batch(connection: Connection, entries: Sequence[Entry]) -> list[Receipt | AnswerError]:
    """Write what is new; the caller commits. One outcome for each entry, in their order.

    An entry is new, or a replay of a stored one or of one earlier in the batch, or refused: 409 when the id
    stands for another answer or the version was changed after publication, 410 when it was withdrawn.
    """
    known = _known(connection, [answer.id for _, answer in entries])
    changed = {
        (asked.id, asked.version): not freeze_version(connection, asked)
        for asked in {id(asked): asked for asked, answer in entries if answer.id not in known}.values()
    }
    fresh: dict[str, Answer] = {}
    for asked, answer in entries:
        if answer.id not in known and not changed[asked.id, asked.version]:
            fresh.setdefault(answer.id, answer)
    mine = _insert(connection, list(fresh.values())) if fresh else set()
    if len(mine) < len(fresh):  # another process wrote the same id between our look and our insert
        known |= _known(connection, [key for key in fresh if key not in mine])
    outcomes: list[Receipt | AnswerError] = []
    for asked, answer in entries:
        if answer.id in mine and fresh[answer.id] is answer:
            outcomes.append(Receipt(answer.id, replayed=False))
        elif answer.id in mine:
            outcomes.append(_replay(answer, fresh[answer.id].digest, withdrawn=False))
        elif answer.id in known:
            digest, withdrawn = known[answer.id]
            outcomes.append(_replay(answer, digest, withdrawn=withdrawn))
        else:
            outcomes.append(_changed(asked))
    return outcomes


def insert_new(connection: Connection, table: Table):
    """INSERT that leaves an existing key as it is."""
    insert = postgresql.insert if connection.dialect.name == "postgresql" else sqlite.insert
    return insert(table).on_conflict_do_nothing()


def freeze_version(connection: Connection, questionnaire: Questionnaire) -> bool:
    """Keep the version as it is asked now. False when it was asked differently before."""
    table = tables.version
    query = select(table.c.digest).where(
        table.c.questionnaire == questionnaire.id, table.c.version == questionnaire.version
    )
    found = connection.execute(query).scalar_one_or_none()
    if found is None:
        row = {
            "questionnaire": questionnaire.id,
            "version": questionnaire.version,
            "digest": questionnaire.digest,
            "document": questionnaire.document(),
        }
        connection.execute(insert_new(connection, table).values(**row))
        found = connection.execute(query).scalar_one()
    return found == questionnaire.digest


def _known(connection: Connection, ids: Sequence[str]) -> dict[str, tuple[str, bool]]:
    """id → (digest, withdrawn) of those that are stored."""
    table = tables.submission
    query = select(table.c.id, table.c.digest, table.c.withdrawn).where(table.c.id.in_(ids))
    return {key: (digest, at is not None) for key, digest, at in connection.execute(query)}


def _insert(connection: Connection, answers: Sequence[Answer]) -> set[str]:
    """Insert whole answers; the ids that were new to the database."""
    received = now()
    heads = [
        {
            "id": answer.id,
            "questionnaire": answer.questionnaire,
            "version": answer.version,
            "language": answer.language,
            "exhibit": answer.exhibit,
            "digest": answer.digest,
            "received": received,
        }
        for answer in answers
    ]
    table = tables.submission
    if connection.dialect.name == "sqlite":
        # The transaction is the only writing one, so what was unknown a moment ago still is.
        connection.execute(table.insert(), heads)
        mine = {answer.id for answer in answers}
    else:
        found = connection.execute(insert_new(connection, table).returning(table.c.id), heads)
        mine = set(found.scalars())
    written = [answer for answer in answers if answer.id in mine]
    scores = [(answer.id, item, score) for answer in written for item, score in answer.scores]
    texts = [(answer.id, module, text) for answer in written for module, text in answer.suggestions]
    _add_rows(connection, tables.answer, scores)
    _add_rows(connection, tables.suggestion, texts)
    return mine


def _add_rows(connection: Connection, table: Table, rows: Sequence[tuple[object, ...]]) -> None:
    """Rows of plain texts and integers in the order of the columns."""
    if not rows:
        return
    names = table.columns.keys()
    if connection.dialect.name == "sqlite":
        # All rows in a single step: sqlite3 lets go of Python's lock for every step, and each time a busy server
        # makes the writer wait to have it back. A dozen rows an answer were most of what an answer cost.
        values = ", ".join(f"json_extract(value, '$[{at}]')" for at in range(len(names)))
        insert = f"INSERT INTO {table.name} ({', '.join(names)}) SELECT {values} FROM json_each(?)"
        connection.exec_driver_sql(insert, (json.dumps(rows, ensure_ascii=False),))
    else:
        connection.execute(table.insert(), [dict(zip(names, row, strict=True)) for row in rows])


def _replay(answer: Answer, digest: str, *, withdrawn: bool) -> Receipt | AnswerError:
    if withdrawn:
        return AnswerError("id", *WITHDRAWN, status=410)
    if digest != answer.digest:
        problem = "this id stands for another answer already"
        return AnswerError("id", problem, "send the same body again, or make a fresh id", status=409)
    return Receipt(answer.id, replayed=True)


def _changed(questionnaire: Questionnaire) -> AnswerError:
    problem = f"version {questionnaire.version} was changed after its first answer"
    return AnswerError("version", problem, "the curator raises `version` in the file", status=409)
