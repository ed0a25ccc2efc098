"""What a file is made of: columns in their order, and a list of cells for every answer, made as they are asked for."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from survey.questionnaire import META_COLUMNS, NOT_ASKED, Questionnaire, suggestion_column
from survey.store import Stored

if TYPE_CHECKING:
    from sqlalchemy import Connection

    from survey.export.anonymity import Anonymity, Hidden
    from survey.store.answers import Columns, Heads

__all__ = ["Record", "Sheet", "anonymous", "columns", "of_columns", "of_rows", "pseudonym", "stored_sheet"]

Record = list[str | int | None]
_SCORES = 1000  # answers whose scores become Python's numbers at a time


@dataclass(frozen=True)
class Sheet:
    """Answers to one version on their way into a file.

    questionnaire: its items are the columns of scores. meta: the columns before them, modules: whose suggestions stand
    behind them. records: a list per answer in the order of `columns`; None: not seen or left out, NOT_ASKED: not
    asked; texts as written, times in UTC. anonymity: what was made coarse, None: nothing.
    """

    questionnaire: Questionnaire
    records: Iterable[Record]
    meta: tuple[str, ...] = META_COLUMNS
    modules: tuple[str, ...] = ()
    anonymity: Anonymity | None = None

    @property
    def columns(self) -> list[str]:
        """Columns in their order: what is known of the submission, the items, the suggestions."""
        return [*self.meta, *self.questionnaire.item_ids, *map(suggestion_column, self.modules)]


def pseudonym(submission: str) -> str:
    """What stands for an answer outside the store: the same in every file, and no withdrawal code.

    One-way: the code has 122 random bits, so it cannot be found by trying, with or without a key. Who is shown a code,
    because a visitor wants to see his answer or have it erased from a file that was handed out, finds its row.
    """
    return "a" + hashlib.sha256(f"survey answer {submission}".encode()).hexdigest()[:31]


def columns(questionnaire: Questionnaire) -> list[str]:
    """The columns of an export that leaves nothing out."""
    return Sheet(questionnaire, (), modules=_open(questionnaire)).columns


def of_rows(questionnaire: Questionnaire, rows: Iterable[Stored]) -> Sheet:
    """A sheet of answers that are there as values."""
    return Sheet(questionnaire, _of_rows(questionnaire, rows), modules=_open(questionnaire))


def _of_rows(questionnaire: Questionnaire, rows: Iterable[Stored]) -> Iterator[Record]:
    for row in rows:
        answer, texts, scores = row.answer, dict(row.answer.suggestions), dict(row.answer.scores)
        yield [
            pseudonym(answer.id),
            answer.version,
            answer.language,
            answer.exhibit or "",
            row.received.strftime("%Y-%m-%dT%H:%M:%SZ"),
            *(scores.get(item, NOT_ASKED) for item in questionnaire.item_ids),
            *(texts.get(module, "") for module in _open(questionnaire)),
        ]


def of_columns(found: Columns, heads: Heads, texts: Iterator[tuple[bytes, str, str]]) -> Sheet:
    """A sheet of answers as the store reads them in bulk; texts: (id, module, text) in the order of the answers."""
    asked = found.questionnaire
    return Sheet(asked, _of_columns(found, heads, texts), modules=_open(asked))


def _of_columns(found: Columns, heads: Heads, texts: Iterator[tuple[bytes, str, str]]) -> Iterator[Record]:
    version, modules = found.questionnaire.version, _open(found.questionnaire)
    times = (f"{time}Z" for time in heads.received.astype(str).tolist())
    known = zip(found.ids.tolist(), heads.language.tolist(), heads.exhibit.tolist(), times, strict=True)
    following = next(texts, None)
    for (key, language, exhibit, time), scores in zip(
        known, _cells(found, range(len(found.ids))), strict=True
    ):
        written: dict[str, str] = {}
        while following is not None and following[0] == key:
            written[following[1]] = following[2]
            following = next(texts, None)
        told: Record = [pseudonym(key.decode()), version, language, exhibit, time]
        yield [*told, *scores, *(written.get(module, "") for module in modules)]


def anonymous(found: Columns, heads: Heads, hidden: Hidden) -> Sheet:
    """A sheet that keeps no more of anybody than k share; without pseudonyms and suggestions, in a random order."""
    from survey.export.anonymity import LEFT_OUT
    from survey.store.answers import ABSENT

    levels, asked = hidden.anonymity.levels, found.questionnaire
    if levels["asked"] == LEFT_OUT:
        everywhere = (found.scores[hidden.rows] != ABSENT).all(axis=0)
        asked = asked.asked({item for item, all_ in zip(asked.item_ids, everywhere, strict=True) if all_})
    meta = ("version", *(name for name in ("language", "exhibit", "received") if levels[name] != LEFT_OUT))
    known = {
        "version": [asked.version] * len(hidden.rows),
        "language": heads.language[hidden.rows].tolist(),
        "exhibit": heads.exhibit[hidden.rows].tolist(),
        "received": hidden.time.tolist(),
    }
    told = zip(*(known[name] for name in meta), strict=True)
    cells = _cells(found.of(asked), hidden.rows.tolist())
    records = ([*head, *line] for head, line in zip(told, cells, strict=True))
    return Sheet(asked, records, meta, anonymity=hidden.anonymity)


def stored_sheet(connection: Connection, questionnaire: Questionnaire, k: int | None, kind: str) -> Sheet:
    """All standing answers to a version, read while the sheet is written. connection: of a snapshot.

    k: so many answers share all that is told of a visitor beside the scores, None: everything is told. kind: of what
    the sheet becomes; a script ("r") is for the items that somebody was asked, and a "codebook" tells of no answer
    unless k made them coarse. Raises TooFew where there are fewer than k answers.
    """
    import numpy as np

    from survey.export.anonymity import hide
    from survey.store.answers import read_columns, read_heads, read_texts

    if kind == "codebook" and k is None:
        return of_rows(questionnaire, ())
    columns = read_columns(connection, questionnaire)
    heads = read_heads(connection, questionnaire)
    if kind == "r" and columns.asked.any():
        there = {item for item, n in zip(questionnaire.item_ids, columns.asked, strict=True) if n}
        columns = columns.of(questionnaire.asked(there))
    if k is None:
        return of_columns(columns, heads, read_texts(connection, questionnaire))
    # Drawn from the system's own source of chance: nobody can put the rows back into the order of their arrival.
    return anonymous(columns, heads, hide(columns, heads, k, np.random.default_rng()))


def _cells(found: Columns, rows: Sequence[int]) -> Iterator[Record]:
    """The scores of those answers as cells."""
    from survey.store.answers import ABSENT, UNSCORED

    names: dict[int, str | int | None] = {UNSCORED: None, ABSENT: NOT_ASKED}
    for low in range(0, len(rows), _SCORES):
        for line in found.scores[list(rows[low : low + _SCORES])].tolist():
            yield [point if point > UNSCORED else names[point] for point in line]


def _open(questionnaire: Questionnaire) -> tuple[str, ...]:
    return tuple(module.id for module in questionnaire.modules if module.suggestion)
