"""`hall backup` and `hall restore`: a whole house in one checked file."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from hall_app.house.people.command import add_accounts, add_data

if TYPE_CHECKING:
    from hall_app.house.safekeeping import Holdings, Manifest

__all__ = ["add_parser", "run"]

_BACKUP = """\
Write the content folder, the accounts (people, roles, activities, reservations, journal) and the answers into one file,
while the hall is open or not. From PostgreSQL, too: the databases are in it as SQLite files, which any program reads.
The file is a ZIP that holds the digest of each of its parts; it is read back before it appears under its name, and is
its owner's alone. It holds addresses and hashes of passwords: keep it as you keep the data folder.
The office's drafts and its history are in it, so that in a restored house one goes on drafting and undoing. Left out is
what is made anew: caches, bakes of the data folder."""

_RESTORE = """\
Make a house of a file that `hall backup` wrote: content folder, accounts, answers, the office's drafts and history.
Nothing is overwritten: the content folder is new or empty, both databases are empty, nobody drafts in --data. The whole
file is checked before anything is put anywhere.
Nobody is signed in afterwards; one-time codes and tokens of programs are good no more: make new ones. What people
deleted or withdrew after the backup was made is there again: delete it once more."""

_EPILOG = """\
examples:
  hall backup 2026-11-28.zip
  hall restore 2026-11-28.zip --content my-hall --data my-data        then: hall serve with the same two
  hall restore 2026-11-28.zip --accounts postgresql+psycopg://… --db postgresql+psycopg://…     files into PostgreSQL
  hall restore 2026-11-28.zip --check                                 only look whether the file is whole

Exit status: 0 done, 1 it failed (the message says why), 2 wrong arguments."""


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Declare `hall backup` and `hall restore`."""
    for name, told, long in (
        ("backup", "content, accounts and answers in one file", _BACKUP),
        ("restore", "make a house of such a file", _RESTORE),
    ):
        parser = subparsers.add_parser(
            name,
            help=told,
            description=long,
            epilog=_EPILOG,
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        parser.add_argument("file", type=Path, metavar="FILE", help="the backup")
        parser.add_argument(
            "--content", type=Path, metavar="FOLDER", help="content folder (default ./assets)"
        )
        add_data(parser)
        parser.add_argument(
            "--db", metavar="URL", help="database of answers (default: survey.sqlite in --data)"
        )
        add_accounts(parser)
        if name == "restore":
            parser.add_argument("--check", action="store_true", help="check the file and change nothing")
        parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Do it; what fails is one line on standard error."""
    from hall_app.content.lookup import content_folder
    from hall_app.house.safekeeping import back_up, check_archive, restore

    if arguments.command == "backup":
        house = _holdings(arguments, content_folder(arguments.content))
        print(_told(arguments.file, back_up(arguments.file, house)))
    elif arguments.check:
        print(f"{_told(arguments.file, check_archive(arguments.file))}; whole")
    else:
        house: Holdings = _holdings(arguments, arguments.content or Path("assets"))
        print(f"{_told(arguments.file, restore(arguments.file, house))}; restored to {house.content}")
    return 0


def _holdings(arguments: argparse.Namespace, content: Path) -> Holdings:
    from hall_app.house.safekeeping import Holdings

    return Holdings(
        content, arguments.data, arguments.accounts or arguments.data, arguments.db or arguments.data
    )


def _told(file: Path, manifest: Manifest) -> str:
    size = sum(member.size for member in manifest.files.values())
    facts = (
        _count(len(manifest.files), "file"),
        f"{size / 1e6:.1f} MB",
        _count(manifest.people, "account"),
        _count(manifest.answers, "answer"),
    )
    return f"{file}: {', '.join(facts)}, made {manifest.made[:19].replace('T', ' ')} UTC"


def _count(number: int, of: str) -> str:
    return f"{number} {of}{'' if number == 1 else 's'}"
