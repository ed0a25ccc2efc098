"""`hall collection`: the catalogue as a table, out for a spreadsheet and in again."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from hall_app.content.lookup import content_folder
from hall_app.content.problems import ContentError

__all__ = ["add_parser", "run"]

DESCRIPTION = """\
The catalogue of the exhibits as a table (CSV, UTF-8), out and in.

A row is an exhibit, a column a key of its exhibit.toml: title.zh, record.material.en, …, licence. Change cells in any
spreadsheet program, or translate them, and import the table again: texts that differ are changed in the exhibits'
files, and nothing else; comments and order stay. Rows and columns may be left out or moved. An empty cell removes its
text, in both languages. What a spreadsheet would compute (=, +, -, @ in front) stands behind an apostrophe.
Each changed file is read back and checked, and only if all are right they are put in place; a running hall shows them
within two seconds.

The same collection as IIIF, LIDO, Dublin Core, schema.org and by OAI-PMH: addresses of hall serve, see README.md."""

_EPILOG = """\
examples:
  hall collection export catalogue.csv
  hall collection import catalogue.csv --dry-run    say what would change
  hall collection import catalogue.csv

Exit status: 0 done, 1 something is wrong and nothing was changed, 2 wrong arguments."""


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Declare `hall collection`."""
    parser = subparsers.add_parser(
        "collection",
        help="the catalogue as a table (CSV), out and in",
        description=DESCRIPTION,
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    ways = parser.add_subparsers(dest="way", metavar="WAY", required=True)
    export = ways.add_parser("export", help="write the table", description="Write the catalogue as a table.")
    export.set_defaults(run=run, act=_export)
    into = ways.add_parser(
        "import", help="read it", description="Take a table's changes into the exhibits' files."
    )
    into.add_argument("--dry-run", action="store_true", help="say what would change, and change nothing")
    into.set_defaults(run=run, act=_import)
    for way in (export, into):
        way.add_argument("file", type=Path, metavar="FILE.csv", help="the table")
        way.add_argument("--content", type=Path, metavar="FOLDER", help="content folder (default ./assets)")


def run(arguments: argparse.Namespace) -> int:
    """Export or import; 1 where something is wrong."""
    try:
        return arguments.act(arguments, content_folder(arguments.content))
    except ContentError as error:
        for problem in error.problems:
            print(f"hall collection: {problem}", file=sys.stderr)
        return 1


def _export(arguments: argparse.Namespace, folder: Path) -> int:
    from hall_app.content.loading import load
    from hall_app.web.collection.table.sheet import table

    content = load(folder)
    for problem in content.problems:
        print(f"left out: {problem}", file=sys.stderr)
    try:
        arguments.file.write_bytes(table(content.exhibits))
    except OSError as error:
        raise OSError(f"{arguments.file}: {error.strerror} – give a file that can be written") from error
    print(f"{arguments.file}: {_count(len(content.exhibits), 'exhibit')}")
    return 0


def _import(arguments: argparse.Namespace, folder: Path) -> int:
    from hall_app.web.collection.table.acceptance import accept

    try:
        data = arguments.file.read_bytes()
    except OSError as error:
        raise OSError(
            f"{arguments.file}: {error.strerror} – give a table that hall collection export wrote"
        ) from error
    done = accept(folder, data, dry_run=arguments.dry_run)
    for fault in done.faults:
        print(f"{arguments.file}: {fault}", file=sys.stderr)
    if done.faults:
        print(f"{arguments.file}: nothing was changed", file=sys.stderr)
        return 1
    for exhibit, changed in done.changes.items():
        for change in changed:
            print(f"{exhibit}: {change}")
    texts = sum(len(changed) for changed in done.changes.values())
    how = "would change in" if arguments.dry_run else "changed in"
    print(f"{_count(texts, 'text')} {how} {_count(len(done.changes), 'exhibit')}")
    return 0


def _count(number: int, name: str) -> str:
    return f"{number} {name}" + ("" if number == 1 else "s")
