"""Options that several subcommands share."""

from __future__ import annotations

import argparse
from pathlib import Path

__all__ = ["add_store", "declare", "existing_store"]


def declare(commands, name: str, run, about: str, more: str = "") -> argparse.ArgumentParser:
    """A subcommand with its page of help."""
    command = commands.add_parser(
        name,
        help=about,
        description=f"{about[0].upper()}{about[1:]}.\n\n{more}".strip(),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    command.set_defaults(run=run)
    return command


def add_store(command: argparse.ArgumentParser) -> None:
    """--data and --db."""
    command.add_argument(
        "--data",
        type=Path,
        default=Path("hall-data"),
        metavar="DIR",
        help="data folder (default: ./hall-data)",
    )
    command.add_argument(
        "--db", metavar="URL", help="database instead of the data folder: postgresql+psycopg://…"
    )


def existing_store(args: argparse.Namespace):
    """The store that the arguments name. Raises SurveyError where none was made yet: no command makes an empty one."""
    from survey.errors import SurveyError
    from survey.store import Store, tables

    where = args.db or args.data
    file = tables.sqlite_file(where)
    if file is not None and not file.is_file():
        raise SurveyError(f"{file}: no such store – give --data (or --db) the one that was served")
    return Store(where)
