"""Counts and sums of the answers to a version, made by the database, and kept until an answer comes or goes."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager
from dataclasses import dataclass, field

from sqlalchemy import ColumnElement, Connection, case, func, select

from survey.questionnaire import Questionnaire
from survey.store import tables

__all__ = ["Count", "Tallies", "Tally"]


@dataclass(frozen=True)
class Count:
    """Of an item or a module: in how many answers it was scored, with how many scores, and their sum."""

    answers: int = 0
    scores: int = 0
    total: int = 0


@dataclass(frozen=True)
class Tally:
    """n: answers that stand. What nobody scored may be missing from items and modules."""

    n: int
    items: Mapping[str, Count] = field(default_factory=dict)
    modules: Mapping[str, Count] = field(default_factory=dict)


@dataclass(frozen=True)
class _Kept:
    """A tally, of which state of the store it is, and as which look at the store it was found or confirmed."""

    look: int
    mark: tuple
    tally: Tally


class Tallies:
    """The last tally of each version. Safe for threads.

    snapshot: a context in which several queries see the same moment.
    """

    def __init__(self, snapshot: Callable[[], AbstractContextManager[Connection]]) -> None:
        self._snapshot = snapshot
        self._looking = threading.Lock()
        self._looks = 0
        self._kept: dict[tuple[str, int], _Kept] = {}

    def of(self, questionnaire: Questionnaire) -> Tally:
        """The tally of a moment after the call."""
        key = (questionnaire.id, questionnaire.version)
        asked = self._looks
        with self._looking:
            kept = self._kept.get(key)
            # Of many who ask at once one counts, however fast answers come in: to whoever waited, a look that began
            # after the question is as good as a look of his own.
            if kept is not None and kept.look > asked and kept.mark[0] == questionnaire.digest:
                return kept.tally
            self._looks += 1
            with self._snapshot() as connection:
                standing, *rest = _mark(connection, *key)
                mark = (questionnaire.digest, standing, *rest)
                if kept is not None and kept.mark == mark:
                    tally = kept.tally
                else:
                    tally = _counted(connection, questionnaire, standing)
            self._kept[key] = _Kept(self._looks, mark, tally)
        return tally


def _mark(connection: Connection, questionnaire: str, version: int) -> tuple:
    """What differs after every change: answers are only added, never edited, and withdrawn once and for all."""
    table = tables.submission
    standing = func.count().filter(table.c.withdrawn.is_(None))
    query = select(standing, func.count(), func.max(table.c.received), func.max(table.c.withdrawn))
    mine = (table.c.questionnaire == questionnaire, table.c.version == version)
    return tuple(connection.execute(query.where(*mine)).one())


def _counted(connection: Connection, questionnaire: Questionnaire, n: int) -> Tally:
    home = {item.id: module.id for module in questionnaire.modules for item in questionnaire.items_of(module)}
    item, once = tables.answer.c.item, func.count()  # an answer scores an item once, a module several times
    items = _grouped(connection, questionnaire, item, once)
    distinct = func.count(tables.answer.c.submission.distinct())
    return Tally(n, items, _grouped(connection, questionnaire, case(home, value=item), distinct))


def _grouped(
    connection: Connection,
    questionnaire: Questionnaire,
    group: ColumnElement[str],
    answers: ColumnElement[int],
) -> dict[str, Count]:
    answer, table = tables.answer, tables.submission
    query = (
        select(group.label("tallied"), answers, func.count(), func.sum(answer.c.score))
        .join(table, table.c.id == answer.c.submission)
        .where(
            table.c.questionnaire == questionnaire.id,
            table.c.version == questionnaire.version,
            table.c.withdrawn.is_(None),
            answer.c.score.is_not(None),
        )
        .group_by("tallied")
    )
    found = connection.execute(query)
    return {key: Count(given, scores, int(total)) for key, given, scores, total in found}
