"""`survey compare`: two groups of answers, item by item."""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from survey.commands.options import declare, where
from survey.commands.research.sources import (
    ALL,
    add_sources,
    list_demonstrations,
    table_asked,
    told,
    turned_source,
)

if TYPE_CHECKING:
    from survey.analysis.comparison import Comparison
    from survey.analysis.screening import Note
    from survey.questionnaire import Text
    from survey.scores import ScoreTable

__all__ = ["Compared", "add", "compared"]

STORED = ("language", "exhibit", "role")


@dataclass(frozen=True)
class Compared:
    """notes: what is to be told of the table itself. names: of groups, where they have better ones than their keys."""

    found: Comparison
    notes: tuple[Note, ...]
    names: Mapping[str, Text] = field(default_factory=dict)


_MORE = """\
Each item in both groups: means with their intervals; Welch's t test with the difference's interval and Hedges' g
(the difference in standard deviations); Mann-Whitney's test, which asks for no distances between the points, with
Cliff's delta (how much oftener a score of the first group exceeds one of the second than falls below it). All
probabilities are Holm's over the items, so that among many items none is called different by mere number.

--by names what the groups differ in. Of stored answers: language (in which was it answered), exhibit (what was
looked at), or role, which sets the answers to a platform questionnaire beside those of the other role, dimension by
dimension. Of a table: any column of it, exported by us or not. A group of fewer than ten answers is refused: its
means would tell of persons.

examples:
  survey compare --questionnaire garment --by exhibit --groups scarf,robe
  survey compare --questionnaire platform-user --by role
  survey compare answers.csv --by gender --json"""


def add(commands) -> argparse.ArgumentParser:
    """Declare the command."""
    command = declare(commands, "compare", _run, "compare two groups of answers", _MORE)
    add_sources(command)
    text = "what the groups differ in: language, exhibit or role; of a table: a column"
    command.add_argument("--by", required=True, metavar="COLUMN", help=text)
    text = "which two groups (needed where there are more), first less second"
    command.add_argument("--groups", type=_pair, metavar="A,B", help=text)
    command.add_argument("--json", action="store_true", help="everything, machine-readable")
    return command


def _pair(text: str) -> tuple[str, str]:
    parts = [part.strip() for part in text.split(",")]
    if len(parts) != 2 or not all(parts):
        raise argparse.ArgumentTypeError(f"{text[:40]!r} is no pair of groups – write A,B")
    return parts[0], parts[1]


def _run(args: argparse.Namespace) -> int:
    from survey.analysis.comparison import comparison_printed, comparison_summary

    if args.demo == ALL:
        return list_demonstrations()
    if args.demo is None and args.file is None and args.questionnaire is None:
        args.parser.error("name a FILE.csv, or a --questionnaire of the stored answers")
    _require_labels(args, args.by)

    def work():
        made = compared(table_asked(args, labels=True), args, args.by, args.groups)
        found = replace(made.found, notes=(*made.notes, *made.found.notes))
        return comparison_summary(found), comparison_printed(found)

    return told(args, work)


def _require_labels(args: argparse.Namespace, by: str) -> None:
    """Ends the program with 2 where the answers cannot be told apart by that."""
    if args.demo is not None:
        args.parser.error("the synthetic samples have no groups – give a FILE.csv or a --questionnaire")
    if args.file is None and by not in STORED:
        args.parser.error(
            f"{by[:40]!r}: of stored answers one of {', '.join(STORED)}; of a FILE.csv any column"
        )


def compared(
    table: ScoreTable, args: argparse.Namespace, by: str, groups: tuple[str, str] | None = None
) -> Compared:
    """The comparison of a table with its labels.

    by: "language", "exhibit", "role" or a column of args.file.
    """
    from survey.analysis.comparison import compare
    from survey.scores import dropped

    _require_labels(args, by)
    if args.file is None and by == "role":
        return _roles_compared(table, args, groups)
    labels = _labels(table, args, by)
    source = turned_source(_without(table, by), args)
    scores, items = source.table.scores, source.table.items
    left_out = dropped(args.drop, table.questionnaire)
    kept = [at for at, item in enumerate(items) if item not in left_out]
    found = compare(scores[:, kept], [items[at] for at in kept], labels, by=by, groups=groups)
    return Compared(found, source.notes)


def _labels(table: ScoreTable, args: argparse.Namespace, by: str) -> Sequence[str]:
    from survey.scores import read_column

    return table.labels[by] if args.file is None else read_column(args.file, by)


def _without(table: ScoreTable, column: str) -> ScoreTable:
    """The table without the column that tells the groups apart: it is no item, and nothing was left out with it."""
    kept = [at for at, item in enumerate(table.items) if item != column]
    aside = {name: why for name, why in table.aside.items() if name != column}
    items = tuple(table.items[at] for at in kept)
    return replace(table, scores=table.scores[:, kept], items=items, aside=aside)


def _roles_compared(own: ScoreTable, args: argparse.Namespace, groups: tuple[str, str] | None) -> Compared:
    """Answers to a questionnaire with dimensions and to the other one: each answer's mean of every dimension."""
    from survey.analysis.comparison import compare
    from survey.errors import SurveyError
    from survey.scores import dropped, other_roles

    asked = own.questionnaire
    if asked is None or not asked.dimensions:
        raise SurveyError(
            f"{args.questionnaire}: has no dimensions, so nothing that another role was asked as well – compare by"
            " language or exhibit"
        )
    others = other_roles(where(args), args.content, asked)
    # --reverse names items of the first; of the other questionnaires those turn that their own files say.
    reverse = args.reverse if args.reverse == "none" else ""
    sources = [turned_source(own, args), *(turned_source(other, args, reverse) for other in others)]
    sides = [side.id for side in asked.dimensions]
    left_out = dropped(args.drop, None)
    kept = [at for at, side in enumerate(sides) if side not in left_out]
    parts, labels, names = [], [], {}
    for source in sources:
        of = source.table.questionnaire
        assert of is not None
        parts.append(_by_dimension(source.table.scores, len(sides))[:, kept])
        labels += [of.id] * len(source.table.scores)
        names[of.id] = of.title
    notes = tuple(note for source in sources for note in source.notes)
    found = compare(np.concatenate(parts), [sides[at] for at in kept], labels, by="role", groups=groups)
    return Compared(found, notes, names)


def _by_dimension(scores: np.ndarray, sides: int) -> np.ndarray:
    """(n, sides): the mean of what was scored, NaN where nothing was."""
    cube = scores.reshape(len(scores), -1, sides)
    there = ~np.isnan(cube)
    counts = there.sum(axis=1)
    sums = np.where(there, cube, 0.0).sum(axis=1)
    return np.where(counts > 0, sums / np.maximum(counts, 1), np.nan)
