"""`hall check`: say what is wrong in a content folder, one line a problem."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

from hall_app.content.lookup import content_folder
from hall_app.content.problems import ContentError, Problem

__all__ = ["add_parser", "run"]

DESCRIPTION = """\
Look through a content folder: form of the TOML files, files named and present, both languages, descriptions
of media, media and models (readable, in metres, within budget), exhibits inside the hall and reachable on
foot, openings and signs held by walls, licences, questionnaires, outfits, weaves, patterns, bakes
and the room (files as they were baked), unused files. One line a problem: file, key, what is wrong, how to put it
right. A hint is no problem: something to do before visitors come.

With --garments instead: what every baked garment was measured to be, measured again from its files where that
is cheap; marked ! where it breaks a limit or where record and files disagree.

Exit status: 0 no problem, 1 problems or a broken limit, 2 wrong arguments."""


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Add `hall check` to the commands."""
    parser = subparsers.add_parser(
        "check",
        help="say what is wrong in a content folder",
        description=DESCRIPTION,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "folder", nargs="?", type=Path, metavar="FOLDER", help="default: ./assets, else packaged"
    )
    parser.add_argument("--content", type=Path, metavar="FOLDER", help="the same as FOLDER")
    parser.add_argument(
        "--garments",
        action="store_true",
        help="the measured figures of every baked garment, with their limits",
    )
    parser.add_argument("--json", action="store_true", help="write the problems as JSON")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Check the folder and write the result: 0 no problem, 1 problems."""
    from hall_app.check.folder import check, hints

    problems: list[Problem]
    advice: list[Problem] = []
    folder: Path | None = args.folder or args.content
    try:
        folder = content_folder(folder)
        if args.garments:
            from hall_app.check.garments.quality import garments_checked

            text, status = garments_checked(folder, as_json=args.json)
            sys.stdout.write(text)
            return status
        problems, advice = check(folder), hints(folder)
    except ContentError as error:
        problems = list(error.problems)
    if args.json:
        result = {
            "folder": str(folder or ""),
            "problems": [problem.as_json() for problem in problems],
            "hints": [hint.as_json() for hint in advice],
        }
        sys.stdout.write(json.dumps(result, ensure_ascii=False, indent=1) + "\n")
    else:
        for line in (*problems, *(f"hint: {hint}" for hint in advice)):
            sys.stdout.write(f"{line}\n")
        counts = [_counted(len(problems), "problem"), *([_counted(len(advice), "hint")] if advice else [])]
        sys.stdout.write(f"{folder or 'no content folder'}: {', '.join(counts)}\n")
    return 1 if problems else 0


def _counted(number: int, what: str) -> str:
    return f"{number} {what}" if number == 1 else f"{number} {what}s"
