"""`survey backup`: a copy of the store while it is in use."""

from __future__ import annotations

import argparse
from contextlib import closing
from pathlib import Path

from survey.commands.options import add_store, declare, existing_store

__all__ = ["add"]

_MORE = """\
One SQLite file with everything in it, also from PostgreSQL: consistent, checked and on the disk before it appears
under its name. The service may run meanwhile. To restore, stop the service, and put the file in the data folder as
survey.sqlite (removing survey.sqlite-wal and -shm), or name it with --db sqlite:///FILE."""


def add(commands) -> argparse.ArgumentParser:
    """Declare the command."""
    command = declare(commands, "backup", _run, "copy the store into one file, while it is in use", _MORE)
    command.add_argument("file", type=Path, metavar="FILE", help="the copy; must not exist yet")
    add_store(command)
    return command


def _run(args: argparse.Namespace) -> int:
    with closing(existing_store(args)) as store:
        count = store.copy_to(args.file)
    print(f"{args.file}: {count} submissions")
    return 0
