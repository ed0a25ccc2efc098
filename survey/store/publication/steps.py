"""The public figures of a version: published in steps, and kept, so that nothing else ever shows anything new."""

from __future__ import annotations

import threading
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor, wait
from dataclasses import dataclass, field

from sqlalchemy import Connection, delete, func, select, update

from survey.errors import StoreError
from survey.questionnaire import Questionnaire
from survey.store.answers import standing
from survey.store.commit import insert_new
from survey.store.database import Session, tables
from survey.store.publication.disclosure import STEP, Figure, Scores, Shown, moved_on

__all__ = ["Public", "Publishing", "forget"]

MANY = 10_000  # answers over which a step takes longer than anybody should wait
PATIENCE = 0.1  # seconds that it is waited for then
AT_ONCE = 5000  # submissions of one statement
PART = (
    100  # of very many answers a step waits for a hundredth, or each ten would have all of them counted anew
)


@dataclass(frozen=True)
class Public:
    """What is public of a version since its last step; 0: there was none yet. n: answers that the step counted."""

    step: int = 0
    n: int = 0
    items: Mapping[str, Shown] = field(default_factory=dict)


@dataclass(frozen=True)
class _Draft:
    """The next step as a moment of the store has it. fresh: submissions that no step counted."""

    public: Public
    fresh: Sequence[str]


class Publishing:
    """Publishes a step when somebody asks and there is enough for one. Safe for threads and for several processes.

    snapshot: a context in which several queries see the same moment. write: one in which a change is committed.
    """

    def __init__(self, snapshot: Session, write: Session) -> None:
        self._snapshot, self._write = snapshot, write
        self._starting = threading.Lock()
        self._looking = ThreadPoolExecutor(1, "survey-publishing")
        self._looks: dict[tuple[str, int], Future[Public]] = {}
        self._kept: dict[tuple[str, int], Public] = {}

    def of(self, questionnaire: Questionnaire) -> Public:
        """What is public of the version; of very many answers what there was, while it is looked whether there is more.

        Raises StoreError.
        """
        key = (questionnaire.id, questionnaire.version)
        with self._starting:
            look = self._looks.get(key)
            if look is None or look.done():
                look = self._looks[key] = self._looking.submit(self._looked, questionnaire)
        # Whoever waited for a step of seconds would hold a thread of the service.
        kept = self._kept.get(key, Public())
        if wait([look], PATIENCE if kept.n >= MANY else None).done:
            kept = self._kept[key] = look.result()
        return kept

    def close(self) -> None:
        """Wait for the look that is under way."""
        self._looking.shutdown(cancel_futures=True)

    def _looked(self, questionnaire: Questionnaire) -> Public:
        key = (questionnaire.id, questionnaire.version)
        with self._snapshot() as connection:
            public = _public(connection, *key)
            draft = _draft(connection, questionnaire, public) if _enough(connection, *key, public) else None
        if draft is None:
            return public
        try:
            if self._published(key, draft):
                return draft.public
        except StoreError:
            return public  # a full or locked database: the figures stay as they are, to be read all the same
        # Another process was first, or one of the answers was taken back.
        with self._snapshot() as connection:
            return _public(connection, *key)

    def _published(self, key: tuple[str, int], draft: _Draft) -> bool:
        """Keep the step, unless another was kept meanwhile or an answer that it counts was taken back."""
        with self._write() as connection:
            done = _claimed(connection, *key, draft.public) and _counted(connection, draft)
            if done:
                _put(connection, *key, draft.public.items)
            else:
                connection.rollback()
        return done


def forget(connection: Connection, questionnaire: str, version: int) -> None:
    """Delete what is public of a version; the caller commits."""
    for table in (tables.figure, tables.publication):
        connection.execute(
            delete(table).where(table.c.questionnaire == questionnaire, table.c.version == version)
        )


def _public(connection: Connection, questionnaire: str, version: int) -> Public:
    head, table = tables.publication, tables.figure
    mine = (head.c.questionnaire == questionnaire, head.c.version == version)
    found = connection.execute(select(head.c.step, head.c.n).where(*mine)).first()
    if found is None:
        return Public()
    rows = connection.execute(
        select(table).where(table.c.questionnaire == questionnaire, table.c.version == version)
    )
    return Public(found.step, found.n, {row.item: _shown(row) for row in rows})


def _shown(row) -> Shown:
    figure = Figure(row.n, row.units, row.decimals) if row.n else None
    return Shown(figure, row.step, row.judged, row.withheld)


def _uncounted(questionnaire: str, version: int):
    return (*standing(questionnaire, version), tables.submission.c.counted.is_(None))


def _enough(connection: Connection, questionnaire: str, version: int, public: Public) -> bool:
    wanted = max(STEP, public.n // PART)
    found = select(tables.submission.c.id).where(*_uncounted(questionnaire, version)).limit(wanted)
    return len(connection.execute(found).all()) == wanted


def _draft(connection: Connection, questionnaire: Questionnaire, public: Public) -> _Draft:
    key, step = (questionnaire.id, questionnaire.version), public.step + 1
    fresh = connection.execute(select(tables.submission.c.id).where(*_uncounted(*key))).scalars().all()
    n = connection.execute(
        select(func.count()).select_from(tables.submission).where(*standing(*key))
    ).scalar_one()
    scores = _scores(connection, questionnaire, public)
    items = {
        item: moved_on(public.items.get(item, Shown()), step, scores[item]) for item in questionnaire.item_ids
    }
    return _Draft(Public(step, n, items), fresh)


def _scores(connection: Connection, questionnaire: Questionnaire, public: Public) -> dict[str, Scores]:
    answer, head = tables.answer, tables.submission
    query = (
        select(answer.c.item, head.c.counted, answer.c.score, func.count())
        .join(head, head.c.id == answer.c.submission)
        .where(*standing(questionnaire.id, questionnaire.version), answer.c.score.is_not(None))
        .group_by(answer.c.item, head.c.counted, answer.c.score)
    )
    found = {item: [[0] * questionnaire.points for _ in range(3)] for item in questionnaire.item_ids}
    for item, counted, score, times in connection.execute(query):
        if item not in found:
            continue  # of an earlier reading of the version
        last = public.items.get(item, Shown())
        part = 2 if counted is None or counted > last.judged else 1 if counted > last.step else 0
        found[item][part][score - 1] += times
    return {item: Scores(*parts) for item, parts in found.items()}


def _claimed(connection: Connection, questionnaire: str, version: int, public: Public) -> bool:
    """Make the step the version's last one. False when it is not the next any more."""
    table = tables.publication
    if public.step == 1:
        row = {"questionnaire": questionnaire, "version": version, "step": 1, "n": public.n}
        # Not by the number of rows: psycopg has none of an insertion that may do nothing.
        added = insert_new(connection, table).values(**row).returning(table.c.step)
        return connection.execute(added).scalar() is not None
    mine = (table.c.questionnaire == questionnaire, table.c.version == version)
    before = table.c.step == public.step - 1
    change = update(table).where(*mine, before).values(step=public.step, n=public.n)
    return connection.execute(change).rowcount == 1


def _counted(connection: Connection, draft: _Draft) -> bool:
    """Mark the submissions as counted by the step. False when one was taken back since they were read."""
    table, done = tables.submission, 0
    for ids in _parts(draft.fresh):
        open_ones = (table.c.id.in_(ids), table.c.withdrawn.is_(None))
        done += connection.execute(update(table).where(*open_ones).values(counted=draft.public.step)).rowcount
    return done == len(draft.fresh)


def _parts(ids: Sequence[str]) -> Iterator[Sequence[str]]:
    return (ids[start : start + AT_ONCE] for start in range(0, len(ids), AT_ONCE))


def _put(connection: Connection, questionnaire: str, version: int, items: Mapping[str, Shown]) -> None:
    table = tables.figure
    connection.execute(
        delete(table).where(table.c.questionnaire == questionnaire, table.c.version == version)
    )
    rows = [
        {
            "questionnaire": questionnaire,
            "version": version,
            "item": item,
            "step": shown.step,
            "judged": shown.judged,
            "n": shown.figure.n if shown.figure else 0,
            "units": shown.figure.units if shown.figure else 0,
            "decimals": shown.figure.decimals if shown.figure else 0,
            "withheld": shown.withheld,
        }
        for item, shown in items.items()
    ]
    connection.execute(table.insert(), rows)
