"""`survey purge`: erase what has been kept long enough."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from contextlib import closing
from datetime import UTC, datetime, timedelta
from typing import TYPE_CHECKING

from survey.commands.options import add_store, declare, existing_store
from survey.errors import SurveyError

if TYPE_CHECKING:
    from survey.store import Overdue, Store

__all__ = ["add"]

_MORE = """\
Erases scores and suggestions of every version whose retain_until (in the questionnaire's file, frozen with the
version) has passed, frozen for evaluation or not; tombstones without answers stay. It shows what that is and asks;
without a terminal, such as in a daily job, it needs --yes.

A clock that is wrong would erase what is still to be kept: one that stands before the last purge (where nothing was
purged yet: before the last answer) or more than 60 days after it needs --yes --clock-is-right.

The database's files are cleared of it too: an SQLite file is rewritten, PostgreSQL runs VACUUM (FULL), which locks the
tables meanwhile. Backups are yours to erase, and so are PostgreSQL's archived WAL and replicas."""

FARTHEST = timedelta(days=60)
SLACK = timedelta(hours=1)  # two machines' clocks, or one that was just set
SETTLING = 60.0  # seconds that are waited for whoever reads


def add(commands) -> argparse.ArgumentParser:
    """Declare the command."""
    command = declare(commands, "purge", _run, "erase answers whose retention date has passed", _MORE)
    command.add_argument("--yes", action="store_true", help="erase without asking")
    text = "with --yes: also where the clock may have jumped since the last purge or answer"
    command.add_argument("--clock-is-right", action="store_true", help=text)
    add_store(command)
    command.set_defaults(parser=command)
    return command


def _run(args: argparse.Namespace) -> int:
    if args.clock_is_right and not args.yes:
        args.parser.error("--clock-is-right goes with --yes")
    with closing(existing_store(args)) as store:
        now = datetime.now(UTC)
        if not args.clock_is_right:
            _see_that_the_clock_is_right(store, now)
        due = store.overdue(now.date())
        if due:
            _show(due)
            if not args.yes and not _agreed(due):
                print("nothing was erased")
                return 1
        return _purged(store, due)


def _see_that_the_clock_is_right(store: Store, now: datetime) -> None:
    remedy = "set the clock, or if it is right: survey purge --yes --clock-is-right"
    what, at, beside = "the last purge", store.audit.last("purge"), ""
    if at is None:
        # The last answer is all that tells the time then, also to a service that nobody has answered for months.
        what, at, beside = "the last answer", store.newest(), ", and nothing was purged yet"
    if at is None:
        return
    if now < at - SLACK:
        raise SurveyError(f"the clock says {now:%Y-%m-%d}, before {what} on {at:%Y-%m-%d}{beside} – {remedy}")
    if now > at + FARTHEST:
        when = f"{(now - at).days} days after {what} on {at:%Y-%m-%d}{beside}"
        raise SurveyError(f"the clock says {now:%Y-%m-%d}, {when} – {remedy}")


def _show(due: Sequence[Overdue]) -> None:
    for one in due:
        received = f"received {one.oldest} to {one.newest}"
        kept = f"kept until {one.kept_until}"
        print(f"{one.questionnaire} version {one.version}: {one.answers} answers, {received}, {kept}")


def _agreed(due: Sequence[Overdue]) -> bool:
    number = sum(one.answers for one in due)
    if not sys.stdin.isatty():
        raise SurveyError(f"{number} answers are to be erased and nobody can be asked – add --yes")
    try:
        return input(f"erase these {number} answers for ever? [y/N] ").strip().lower() in ("y", "yes")
    except EOFError:
        return False


def _purged(store: Store, due: Sequence[Overdue]) -> int:
    for one in due:
        count = store.purge(one.questionnaire, one.version)
        print(f"{one.questionnaire} version {one.version}: {count} answers erased")
    if not due:
        store.audit.note("purge", "nothing to erase", 0)
        print("nothing to erase: no retention date has passed")
    if not store.erasure_owed():
        return 0
    if not store.settle(SETTLING):
        raise SurveyError(
            "what was erased can still be read in the file, somebody holds it – purge again later"
        )
    print("nothing of it is left in the database's files")
    if store.file is None:
        print("backups, replicas and archived WAL have it still: survey/README.md, Erased is erased")
    return 0
