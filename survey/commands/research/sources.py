"""Where the commands of research take their scores from, and how they tell what cannot be analysed."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from survey.commands.options import add_content, add_store, positive, where

if TYPE_CHECKING:
    from survey.analysis.screening import Note
    from survey.scores import ScoreTable

__all__ = [
    "ALL",
    "Source",
    "add_sources",
    "list_demonstrations",
    "points_of",
    "table_asked",
    "told",
    "turned_source",
]

ALL = "list"  # of the samples: --demo without a name


@dataclass(frozen=True)
class Source:
    """table: scores whose reverse-keyed items are turned. points: of the scale 1, 2, …, None where it is not known.
    notes: on what was turned, and on columns that were taken for no items."""

    table: ScoreTable
    points: int | None
    notes: tuple[Note, ...] = ()


def add_sources(command: argparse.ArgumentParser) -> None:
    """Which scores, which of their columns, and how they are meant."""
    command.add_argument(
        "file", nargs="?", type=Path, metavar="FILE.csv", help="a table; default: the stored answers"
    )
    add = command.add_argument
    add("--questionnaire", metavar="ID", help="whose items they are (needed without FILE.csv)")
    add("--version", type=positive, metavar="N", help="an earlier version (default: the file's)")
    text = "a synthetic sample instead of answers; without NAME: what there is"
    add("--demo", metavar="NAME", nargs="?", const=ALL, help=text)
    text = "of FILE.csv without --questionnaire: the columns that are the items, and no others"
    add("--items", default="", metavar="ITEM,ITEM", help=text)
    text = "of FILE.csv without --questionnaire: columns that are items although they look like none"
    add("--keep", default="", metavar="ITEM,ITEM", help=text)
    text = "of FILE.csv without --questionnaire: the scale is 1 to N (default: as far as the scores go)"
    add("--points", type=_points, metavar="N", help=text)
    text = "items worded the other way round beside those of the questionnaire's file; none: not even those"
    add("--reverse", default="", metavar="ITEM,ITEM", help=text)
    text = 'items to leave out: "none", a tag ("static"), or ITEM,ITEM …'
    add("--drop", default="none", metavar="WHAT", help=text)
    command.set_defaults(parser=command)
    add_content(command)
    add_store(command)


def _points(text: str) -> int:
    if not (text.isascii() and text.isdecimal()) or len(text) > 3 or int(text) < 2:
        raise argparse.ArgumentTypeError(f"{text[:20]!r} is no number of points from 2 to 999")
    return int(text)


def table_asked(args: argparse.Namespace, *, texts: bool = False, labels: bool = False) -> ScoreTable:
    """The scores that the arguments name, as they were given; ends the program with 2 where they name none.

    What else there is, such as other versions, is told on standard error. texts, labels: as `load_scores` has them.
    """
    from survey.scores import Choice, listed, load_scores

    if args.file is None and args.questionnaire is None and args.demo is None:
        args.parser.error("name a FILE.csv, or a --questionnaire of the stored answers, or a --demo")
    if (args.items or args.keep or args.points) and (args.file is None or args.questionnaire is not None):
        args.parser.error("--items, --keep and --points are for a FILE.csv without --questionnaire")
    if args.demo is not None:
        return _demonstration(args)
    choice = Choice(listed(args.items), listed(args.keep))
    of = (where(args), args.content, args.questionnaire, args.version)
    table = load_scores(args.file, *of, choice=choice, texts=texts, labels=labels)
    if table.beside:
        print(f"survey: {args.questionnaire}: {table.beside}", file=sys.stderr)
    return table


def list_demonstrations() -> int:
    """What --demo without a name shows."""
    from survey.demonstration import SAMPLES

    for name, (_, english) in SAMPLES.items():
        print(f"{name:18}{english}")
    return 0


def _demonstration(args: argparse.Namespace) -> ScoreTable:
    from survey.demonstration import SAMPLES
    from survey.scores import sample_scores

    if args.file is not None:
        args.parser.error("give a FILE.csv or a --demo, not both")
    if args.demo not in SAMPLES:
        args.parser.error(f"--demo: {args.demo!r} is none of {', '.join(SAMPLES)}")
    return sample_scores(args.demo, args.content)


def points_of(table: ScoreTable, args: argparse.Namespace) -> int | None:
    """How many points the scale has. The synthetic samples keep to none: exact moments make broken scores."""
    asked = None if table.synthetic else table.questionnaire
    return args.points if asked is None else asked.points


def turned_source(table: ScoreTable, args: argparse.Namespace, reverse: str | None = None) -> Source:
    """The same scores with the items turned that are worded the other way round, as `survey analyse` turns them.

    reverse: instead of what the arguments say. Raises UnknownItem.
    """
    from survey.analysis.screening import left_out, turned_table
    from survey.scores import dropped, reverse_keyed

    points = points_of(table, args)
    notes = left_out(table.aside)
    used = [item not in dropped(args.drop, table.questionnaire) for item in table.items]
    keyed = reverse_keyed(args.reverse if reverse is None else reverse, table)
    scores, _ = turned_table(table.scores, table.items, keyed, points, used, notes)
    return Source(replace(table, scores=scores), points, tuple(notes))


def told(args: argparse.Namespace, work: Callable[[], tuple[dict[str, Any], str]]) -> int:
    """Print what the work gives, as JSON or as text; an analysis that cannot be is told as {"error": …} as well."""
    from survey.analysis import AnalysisError

    try:
        found, text = work()
    except AnalysisError as error:
        if args.json:
            why = {"error": {"code": error.code, "items": list(error.items), "message": str(error)}}
            print(json.dumps(why, ensure_ascii=False))
        raise
    if args.json:
        print(json.dumps(found, ensure_ascii=False, allow_nan=False, indent=1))
    else:
        print(text)
    sys.stdout.flush()
    return 0
