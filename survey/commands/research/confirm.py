"""`survey confirm`: confirmatory factor analysis of the answers."""

from __future__ import annotations

import argparse
from dataclasses import replace
from typing import TYPE_CHECKING

from survey.commands.options import declare
from survey.commands.research.progress import described
from survey.commands.research.sources import (
    ALL,
    Source,
    add_sources,
    list_demonstrations,
    table_asked,
    told,
    turned_source,
)

if TYPE_CHECKING:
    from survey.analysis.confirmatory import Confirmation, Gaps, Measurement
    from survey.analysis.screening import Note
    from survey.scores import ScoreTable

__all__ = ["add", "confirmed"]

_MORE = """\
Asks whether the answers agree with factors that were stated beforehand. Without --model these are the
questionnaire's modules, each measured by its items; --model explored takes the factors that an exploratory analysis
of the same answers finds, which shows how they fit and confirms nothing. A model is written as in R's lavaan:

  F1 =~ a + b + c     a factor and its items; the first one's loading is 1; an item may stand in two factors
  a ~~ b              two items that have something in common beside their factors
  F1 ~~ 0*F2          two factors that are not correlated (others are)

parts between semicolons or on lines of their own. A factor needs three items, two if it is correlated with another.

--estimator ml takes the scores as amounts: χ² by maximum likelihood. Answers with gaps count with what they have
(--missing fiml), which is right where gaps depend on nothing but what was answered; listwise leaves them out.
--estimator dwls takes the scores as ordered categories, right for five points or fewer: polychoric correlations
weighted by their precision, and beside the plain χ² the robust one (scaled and shifted: "WLSMV"), which is the one to
report. It needs whole answers, better 200 of them.

Told are χ² with p, CFI, TLI, RMSEA with its 90 % interval, SRMR, every estimate with its standard error and its
standardised self, correlations of the factors, the largest residual correlations, and what would mend the fit.
`survey analyse --confirm --report DIR` puts it into the report.

examples:
  survey confirm --questionnaire garment --drop static
  survey confirm answers.csv --model "looks =~ a + b + c; feel =~ d + e + f" --estimator dwls --json"""


def add(commands) -> argparse.ArgumentParser:
    """Declare the command."""
    command = declare(commands, "confirm", _run, "test stated factors (confirmatory factor analysis)", _MORE)
    add_sources(command)
    text = "modules, explored, or the model's text (default: modules)"
    command.add_argument("--model", default="modules", metavar="MODEL", help=text)
    command.add_argument("--estimator", choices=["ml", "dwls"], default="ml", help="default: ml")
    text = "answers with gaps (default: fiml with ml, listwise with dwls)"
    command.add_argument("--missing", choices=["fiml", "listwise"], help=text)
    command.add_argument("--json", action="store_true", help="everything, machine-readable")
    return command


def _run(args: argparse.Namespace) -> int:
    from survey.analysis.confirmatory import confirmation_printed, confirmation_summary

    if args.demo == ALL:
        return list_demonstrations()
    if args.estimator == "dwls" and args.missing == "fiml":
        args.parser.error("--missing fiml is a likelihood of amounts: it goes with --estimator ml")

    def work():
        source = turned_source(table_asked(args), args)
        found = confirmed(source, args, args.model, missing=args.missing)
        found = replace(found, notes=(*source.notes, *found.notes))
        return confirmation_summary(found), confirmation_printed(found)

    return told(args, work)


def confirmed(
    source: Source, args: argparse.Namespace, model: str, *, missing: Gaps | None = None
) -> Confirmation:
    """A confirmatory analysis as the arguments ask for it. model: "modules", "explored", or a text."""
    from survey.analysis.confirmatory import confirm
    from survey.scores import dropped

    table = source.table
    measured = _model_asked(table, model, dropped(args.drop, table.questionnaire))
    with described() as progress:
        found = confirm(
            table.scores,
            table.items,
            measured,
            estimator=args.estimator,
            missing=missing,
            points=source.points,
            progress=progress,
        )
    return replace(found, notes=(*found.notes, *_same_answers(model)))


def _model_asked(table: ScoreTable, model: str, drop: tuple[str, ...]) -> Measurement:
    """The measurement model: the questionnaire's modules, what an exploratory analysis finds, or a text."""
    from survey.analysis import BadModel, NoComponents, Settings, analyse
    from survey.analysis.confirmatory import Measurement, explored, parsed

    if model == "explored":
        found = analyse(table.scores, table.items, settings=Settings(drop=drop, draws=0))
        if found.components is None:
            raise NoComponents("the exploratory analysis keeps no component – state the model: --model")
        return explored(found.components, found.factored)
    if model != "modules":
        return parsed(model).without(drop)
    asked = table.questionnaire
    if asked is None:
        raise BadModel(
            "the table belongs to no questionnaire, so there are no modules – name one (--questionnaire), or state"
            ' the model (--model "F1 =~ a + b + c") or --model explored'
        )
    of_modules = tuple(
        (module.id, tuple(item.id for item in asked.items_of(module) if item.id in table.items))
        for module in asked.modules
    )
    return Measurement(tuple((name, items) for name, items in of_modules if items)).without(drop)


def _same_answers(model: str) -> tuple[Note, ...]:
    from survey.analysis.screening import Note

    if model != "explored":
        return ()
    text = "the factors were found in these very answers: nothing is confirmed until new ones agree"
    return (Note("same_answers", (), text, {}),)
