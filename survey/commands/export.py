"""`survey export`: answers in a file or on standard output."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from survey.errors import SurveyError

__all__ = ["ABOUT", "add_export_arguments", "run_export"]

ABOUT = """\
csv       UTF-8 with a byte order mark: one row per answer, one column per item and per module's suggestions.
          "Not seen" is an empty cell. Text that a spreadsheet would run as a formula gets an apostrophe in front.
xlsx      the same as a workbook, with the codebook on a second sheet
sav       SPSS, with labels in both languages; "not seen" is the user-missing value 9
json      the questionnaire as it was asked, and every answer
codebook  what each column means, as a CSV table
r         a script that repeats the analysis in R from the CSV"""

FORMATS = ("csv", "xlsx", "sav", "json", "codebook", "r")


def add_export_arguments(command: argparse.ArgumentParser) -> None:
    """Everything but where the answers lie, which the commands share."""
    add = command.add_argument
    add("--questionnaire", required=True, metavar="ID", help="which one, such as garment")
    add("--version", type=_version, metavar="N", help="an earlier version (default: the file's)")
    text = f"{', '.join(FORMATS)} (default: by the ending of --out, else csv)"
    add("--format", choices=FORMATS, metavar="FORMAT", help=text)
    add("--out", type=Path, metavar="FILE", help="where to (default: standard output)")


def _version(text: str) -> int:
    if not text.isdecimal() or len(text) > 9 or int(text) < 1:
        raise argparse.ArgumentTypeError(f"{text[:20]!r} is no number from 1 on")
    return int(text)


def run_export(args: argparse.Namespace) -> int:
    """Raises SurveyError."""
    from survey.export import exported
    from survey.working import open_stored, other_versions

    ending = "" if args.out is None else args.out.suffix.lower().lstrip(".")
    kind = args.format or (ending if ending in FORMATS else "csv")
    with open_stored(args.db or args.data, args.content, args.questionnaire, args.version) as (asked, store):
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
