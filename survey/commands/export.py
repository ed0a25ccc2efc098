"""`survey export`: answers in a file or on standard output."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from survey.commands.options import add_content, add_store, declare, positive, where
from survey.errors import SurveyError

__all__ = ["add"]

_MORE = """\
csv       UTF-8 with a byte order mark: one row per answer, one column per item and per module's suggestions.
          "Not seen" is an empty cell. Text that a spreadsheet would run as a formula gets an apostrophe in front.
xlsx      the same as a workbook, with the codebook on a second sheet
sav       SPSS, with labels in both languages; "not seen" is the user-missing value 9
json      the questionnaire as it was asked, and every answer
codebook  what each column means, as a CSV table
r         a script that repeats the analysis in R from the CSV"""

FORMATS = ("csv", "xlsx", "sav", "json", "codebook", "r")


def add(commands) -> argparse.ArgumentParser:
    """Declare the command."""
    command = declare(commands, "export", _run, "export all answers to one questionnaire", _MORE)
    add = command.add_argument
    add("--questionnaire", required=True, metavar="ID", help="which one, such as garment")
    add("--version", type=positive, metavar="N", help="an earlier version (default: the file's)")
    text = f"{', '.join(FORMATS)} (default: by the ending of --out, else csv)"
    add("--format", choices=FORMATS, metavar="FORMAT", help=text)
    add("--out", type=Path, metavar="FILE", help="where to (default: standard output)")
    add_content(command)
    add_store(command)
    return command


def _run(args: argparse.Namespace) -> int:
    from survey.export import exported
    from survey.working import open_stored, other_versions

    ending = "" if args.out is None else args.out.suffix.lower().lstrip(".")
    kind = args.format or (ending if ending in FORMATS else "csv")
    with open_stored(where(args), args.content, args.questionnaire, args.version) as (asked, store):
        rows, others = store.rows(asked), other_versions(store, asked)
    made = exported(kind, asked, rows)
    if others:
        print(f"survey: {args.questionnaire}: {others}", file=sys.stderr)
    if args.out is None:
        sys.stdout.buffer.write(made)
        sys.stdout.flush()
        return 0
    try:
        args.out.write_bytes(made)
    except OSError as error:
        raise SurveyError(f"{args.out}: cannot be written ({error.strerror}) – give another --out") from None
    print(f"{args.out}: {len(rows)} answers")
    return 0
