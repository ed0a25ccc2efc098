"""`survey audit`: what was done to the store."""

from __future__ import annotations

import argparse
from contextlib import closing

from survey.commands.options import add_store, declare, existing_store

__all__ = ["add"]

_MORE = """\
freeze, purge, backup           of what, and how many answers
export, read                    which answers were handed out, with which token or on the command line; `read` is the
                                first look of a day at rows or suggestions
token made, token revoked       its number and label
withdraw                        how many answers to a questionnaire were taken back on a day: no code and no hour, for
                                whoever saw a visitor at the screen would know by them which answer was his

Times are in UTC. A purge that found nothing has an entry too: `survey purge` measures the clock by the last one."""


def add(commands) -> argparse.ArgumentParser:
    """Declare the command."""
    command = declare(commands, "audit", _run, "print what was done to the store", _MORE)
    add_store(command)
    return command


def _run(args: argparse.Namespace) -> int:
    with closing(existing_store(args)) as store:
        entries = store.audit.entries()
    for entry in entries:
        when = f"{entry.at:%Y-%m-%d}" if entry.action == "withdraw" else f"{entry.at:%Y-%m-%d %H:%M}"
        number = "" if entry.number is None else f"{entry.number} answers"
        print("\t".join((f"{when:16}", entry.action, entry.subject, number)).rstrip())
    return 0
