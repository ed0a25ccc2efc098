"""What is so of this survey now, read from its files, its store and how it was started; nothing is promised here."""

from __future__ import annotations

import stat
from dataclasses import dataclass
from datetime import date, datetime
from pathlib import Path

from sqlalchemy import func, select

from survey.questionnaire import Questionnaire
from survey.store import Store
from survey.store.answers import Archive
from survey.store.database import tables
from survey.web.privacy.controller import Statement, read_controller

__all__ = ["Record", "Running", "record_of"]


@dataclass(frozen=True)
class Running:
    """How the service was started. per_minute: new answers an address may give, 0: any number; proxies: whose word on
    addresses is believed. None: not known to whoever asks."""

    per_minute: int | None = None
    proxies: tuple[str, ...] | None = None


@dataclass(frozen=True)
class Record:
    """statement: of who answers for it. asked: every version that is asked or has been answered. tokens: with which
    researchers read answers. database: sqlite or postgresql; others_read: whether other accounts of the machine may
    read its file, None: not a file. purged: when something was last erased by the retention date. frozen:
    questionnaires whose answers were ever fixed for evaluation."""

    statement: Statement
    asked: tuple[Questionnaire, ...]
    running: Running
    tokens: int
    database: str
    others_read: bool | None
    purged: datetime | None
    frozen: frozenset[str]
    today: date

    def overdue(self, asked: Questionnaire) -> bool:
        """Whether answers to it should have been erased by now."""
        return asked.retain_until is not None and asked.retain_until < self.today


def record_of(
    content: Path, store: Store, asked: tuple[Questionnaire, ...], running: Running, today: date
) -> Record:
    """The record as of now. asked: the questionnaires as they are offered. Raises StoreError."""
    statement = read_controller(content)
    table, head = tables.audit.c, tables.submission.c
    file = tables.sqlite_file(store.where)
    with Archive(store.where).snapshot() as connection:
        erased = (
            table.action == "purge",
            func.coalesce(table.number, 1) > 0,
        )  # earlier releases wrote no number
        purged = connection.execute(select(func.max(table.at)).where(*erased)).scalar()
        fixed = select(head.questionnaire).where(head.frozen.is_not(None)).distinct()
        frozen = frozenset(connection.execute(fixed).scalars())
        database = "sqlite" if file is not None else connection.dialect.name
    versions = {(one.id, one.version): one for one in (*store.all_frozen(), *asked)}
    return Record(
        statement=statement,
        asked=tuple(versions[key] for key in sorted(versions)),
        running=running,
        tokens=sum(not token.expired(today) for token in store.tokens.all()),
        database=database,
        others_read=None if file is None else bool(file.stat().st_mode & (stat.S_IRGRP | stat.S_IROTH)),
        purged=purged,
        frozen=frozen,
        today=today,
    )
