"""The answers to one version column by column: a byte a score, read without making an object of every one."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from datetime import timedelta

import numpy as np
from numpy.typing import NDArray
from sqlalchemy import Connection, Text, case, cast, func, literal_column, select

from survey.questionnaire import Questionnaire
from survey.store.answers.rows import standing
from survey.store.database import tables

__all__ = ["ABSENT", "UNSCORED", "Columns", "Heads", "read_columns", "read_heads", "read_texts"]

UNSCORED, ABSENT = 0, -1  # asked, but not seen or left out; not asked at all
_AT_A_TIME = 100_000  # rows of the table of scores that SQLite hands out as three texts
_ID = np.dtype("S36")
_FIRST = 0x21  # an item's place is told by one character from here on: "!", '"', "#", …

# What a piece of the table of scores comes as: ids of its rows (m,), and of each row item and point.
_Piece = tuple[NDArray[np.bytes_], NDArray[np.int64], NDArray[np.int8]]


@dataclass(frozen=True)
class Columns:
    """Answers that stand, in the order in which they were received.

    ids: (n,) 36 bytes each. scores: (n, p) int8 in the questionnaire's order, a point, UNSCORED or ABSENT.
    """

    questionnaire: Questionnaire
    ids: NDArray[np.bytes_]
    scores: NDArray[np.int8]

    @property
    def asked(self) -> NDArray[np.int64]:
        """(p,) in how many answers an item was asked."""
        return (self.scores != ABSENT).sum(axis=0)

    def of(self, part: Questionnaire) -> Columns:
        """The same answers to a part of the questionnaire."""
        places = [self.questionnaire.item_ids.index(item) for item in part.item_ids]
        return Columns(part, self.ids, self.scores[:, places])


@dataclass(frozen=True)
class Heads:
    """What is known of the answers beside their scores, in the same order.

    language: (n,); exhibit: (n,), "" for none; received: (n,) datetime64[s], UTC.
    """

    language: NDArray[np.str_]
    exhibit: NDArray[np.str_]
    received: NDArray[np.datetime64]


def read_columns(connection: Connection, questionnaire: Questionnaire) -> Columns:
    """All standing answers to this version. connection: of a snapshot.

    Takes about 70 bytes and p more for each answer, however many there are.
    """
    head = tables.submission.c
    query = select(head.id).where(*standing(questionnaire.id, questionnaire.version))
    found = connection.execute(query.order_by(head.received, head.id)).scalars()
    ids = np.array([key.encode() for key in found], dtype=_ID)
    order = np.argsort(ids)
    known = ids[order]
    scores = np.full((len(ids), len(questionnaire.items)), ABSENT, dtype=np.int8)
    if len(ids):
        for owners, items, points in _pieces(connection, questionnaire):
            _place(scores, known, order, (owners, items, points))
    return Columns(questionnaire, ids, scores)


def read_heads(connection: Connection, questionnaire: Questionnaire) -> Heads:
    """Language, exhibit and time of the same answers in the same order."""
    head = tables.submission.c
    query = (
        select(head.language, func.coalesce(head.exhibit, ""), head.received)
        .where(*standing(questionnaire.id, questionnaire.version))
        .order_by(head.received, head.id)
    )
    rows = connection.execute(query, execution_options={"yield_per": 5000}).all()
    # SQLite gives the time back without its zone; it was written in UTC.
    times = [when.replace(tzinfo=None) - (when.utcoffset() or timedelta()) for _, _, when in rows]
    return Heads(
        np.array([language for language, _, _ in rows], dtype=np.str_),
        np.array([exhibit for _, exhibit, _ in rows], dtype=np.str_),
        np.array(times, dtype="datetime64[s]"),
    )


def read_texts(connection: Connection, questionnaire: Questionnaire) -> Iterator[tuple[bytes, str, str]]:
    """(id, module, text) of every suggestion, in the order of the answers; only a few are in memory at a time."""
    head, text = tables.submission.c, tables.suggestion.c
    query = (
        select(text.submission, text.module, text.text)
        .join(tables.submission)
        .where(*standing(questionnaire.id, questionnaire.version))
        .order_by(head.received, head.id)
    )
    for key, module, written in connection.execute(query, execution_options={"yield_per": 1000}):
        yield key.encode(), module, written


def _place(
    scores: NDArray[np.int8], known: NDArray[np.bytes_], order: NDArray[np.int64], piece: _Piece
) -> None:
    """Put a piece where it belongs. known: (n,) ids sorted, order: (n,) the answer of each."""
    owners, items, points = piece
    # An answer's rows mostly stand together, so an id is looked for once a run and not once a row.
    first = np.flatnonzero(np.concatenate([[True], owners[1:] != owners[:-1]]))
    at = np.searchsorted(known, owners[first]).clip(max=len(known) - 1)
    answers = np.where(known[at] == owners[first], order[at], -1)
    rows = np.repeat(answers, np.diff(np.append(first, len(owners))))
    # Rows of other questionnaires, of other versions and of withdrawn answers are nobody's here.
    mine = (rows >= 0) & (items >= 0)
    scores[rows[mine], items[mine]] = points[mine]


def _pieces(connection: Connection, questionnaire: Questionnaire) -> Iterator[_Piece]:
    rows = tables.answer.c
    places = {item: chr(_FIRST + at) for at, item in enumerate(questionnaire.item_ids)}
    item, score = case(places, value=rows.item, else_=" "), func.coalesce(cast(rows.score, Text), "0")
    if connection.dialect.name == "sqlite":
        yield from _of_a_file(connection, item, score)
    else:
        yield from _of_a_server(connection, questionnaire, item, score)


def _of_a_file(connection: Connection, item, score) -> Iterator[_Piece]:
    """The whole table in the order in which it lies there: grouping it by answer would look up every row alone.

    The database strings a piece together as three texts; millions of rows as objects were most of what reading cost.
    """
    place = literal_column("rowid")
    last = connection.execute(select(func.max(place)).select_from(tables.answer)).scalar_one() or 0
    strung = [func.group_concat(part, "") for part in (tables.answer.c.submission, item, score)]
    for low in range(0, last, _AT_A_TIME):
        within = select(*strung).where(place > low, place <= low + _AT_A_TIME)
        owners, items, points = tuple(connection.execute(within).one())
        if owners:
            yield np.frombuffer(owners.encode(), dtype=_ID), _places(items), _points(points)


def _of_a_server(connection: Connection, questionnaire: Questionnaire, item, score) -> Iterator[_Piece]:
    """A text of items and one of points for each answer, some thousands at a time."""
    owner = tables.answer.c.submission
    query = (
        select(owner, func.string_agg(item, ""), func.string_agg(score, ""))
        .join(tables.submission)
        .where(*standing(questionnaire.id, questionnaire.version))
        .group_by(owner)
    )
    for rows in connection.execute(query, execution_options={"yield_per": 5000}).partitions():
        owners = np.array([key.encode() for key, _, _ in rows], dtype=_ID)
        lengths = [len(points) for _, _, points in rows]
        items, points = "".join(row[1] for row in rows), "".join(row[2] for row in rows)
        yield np.repeat(owners, lengths), _places(items), _points(points)


def _places(text: str) -> NDArray[np.int64]:
    """(m,) which item of the questionnaire each character stands for, -1 for none of it."""
    return np.frombuffer(text.encode("utf-32-le"), dtype="<u4").astype(np.int64) - _FIRST


def _points(text: str) -> NDArray[np.int8]:
    return np.frombuffer(text.encode("ascii"), dtype=np.int8) - np.int8(ord("0"))
