"""`survey purge`: erase what has been kept long enough."""

from __future__ import annotations

import argparse
from contextlib import closing
from datetime import UTC, datetime

from survey.commands.options import add_store, declare, existing_store

__all__ = ["add"]

_MORE = """\
Erases scores and suggestions of every version whose retain_until (in the questionnaire's file, frozen with the
version) has passed, frozen for evaluation or not; tombstones without answers stay. Run it daily. Backups are yours to
erase."""


def add(commands) -> argparse.ArgumentParser:
    """Declare the command."""
    command = declare(commands, "purge", _run, "erase answers whose retention date has passed", _MORE)
    add_store(command)
    return command


def _run(args: argparse.Namespace) -> int:
    today, found = datetime.now(UTC).date(), False
    with closing(existing_store(args)) as store:
        for asked in store.all_frozen():
            if asked.retain_until is not None and asked.retain_until < today:
                count, found = store.purge(asked.id, asked.version), True
                print(
                    f"{asked.id} version {asked.version}: kept until {asked.retain_until}, {count} answers erased"
                )
    if not found:
        print("nothing to erase: no retention date has passed")
    return 0
