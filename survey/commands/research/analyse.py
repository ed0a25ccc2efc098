"""`survey analyse`: answers in; tables, JSON or a report out."""

from __future__ import annotations

import argparse
import json
import sys
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from survey.commands.options import declare, where
from survey.commands.research.progress import counted
from survey.commands.research.sources import ALL, add_sources, list_demonstrations, points_of, table_asked

if TYPE_CHECKING:
    from survey.analysis import AnalysisError
    from survey.analysis.procedure import Analysis, Settings
    from survey.report.chapters import Further
    from survey.scores import ScoreTable

__all__ = ["add"]


@dataclass(frozen=True)
class Beyond:
    """summary: keys for --json. printed: texts for the terminal. chapters: of the report."""

    summary: dict[str, Any]
    printed: tuple[str, ...]
    chapters: tuple[Further, ...]


_MORE = """\
The procedure of the paper: means, Pearson correlations with stars, pairs too close to keep both, KMO, Bartlett's
test, components with an eigenvalue above 1, Kaiser-normalised varimax, Cronbach's alpha. Beside it what the paper
lacks: parallel analysis, MAP, omega, bootstrap intervals, answers worth a second look; alpha, omega, item-total
correlations and alpha without each item for every component, module and dimension. What cannot be computed is left
out and explained; nothing is deleted.

Items are the questionnaire's, or without --questionnaire every column of numbers but those that look like age,
gender, a date or the like; these are named in a note, --keep keeps them. An empty cell or NA is a missing score; a
column `seconds` holds the time each answer took. Items that are worded the other way round (reverse = true in the
questionnaire's file, or --reverse) are turned before everything else; others that seem to be are named, never turned.

  survey analyse answers.csv --reverse A1,C4,C5 --points 6 --report out
  survey analyse --questionnaire garment --drop static --report out
  survey analyse --demo                           the synthetic samples that there are"""


def _count(text: str) -> int:
    if not text.isdecimal() or len(text) > 7:
        raise argparse.ArgumentTypeError(f"{text[:20]!r} is no number from 0 to 9999999")
    return int(text)


def _factors(text: str) -> int | str:
    if text in ("kaiser", "parallel"):
        return text
    if text.isdecimal() and len(text) < 6 and int(text) > 0:
        return int(text)
    raise argparse.ArgumentTypeError(f"{text[:20]!r} is neither a number nor kaiser nor parallel")


def add(commands) -> argparse.ArgumentParser:
    """Declare the command."""
    command = declare(commands, "analyse", _run, "analyse the answers to one questionnaire", _MORE)
    add_sources(command)
    add = command.add_argument
    add("--rotation", choices=["varimax", "oblimin", "none"], default="varimax", help="default: varimax")
    text = "how many components: N, kaiser (eigenvalue above 1) or parallel (default: kaiser)"
    add("--factors", type=_factors, default="kaiser", metavar="N", help=text)
    text = "answers with gaps: left out whole, only where both items are needed, or all taken by EM (default: listwise)"
    add("--missing", choices=["listwise", "pairwise", "fiml"], default="listwise", help=text)
    add("--correlation", choices=["pearson", "polychoric"], default="pearson", help="default: pearson")
    add(
        "--bootstrap",
        type=_count,
        default=1000,
        metavar="N",
        help="resamples for intervals, 0: none (default: 1000)",
    )
    text = "random samples of the parallel analysis, 0: none (default: 1000)"
    add("--parallel", type=_count, default=1000, metavar="N", help=text)
    add("--seed", type=_count, default=0, metavar="N", help="of everything random (default: 0)")
    text = "test stated factors as well (survey confirm): modules, explored, or a model's text (default: modules)"
    add("--confirm", nargs="?", const="modules", metavar="MODEL", help=text)
    add("--estimator", choices=["ml", "dwls"], default="ml", help="of --confirm (default: ml)")
    add("--compare", metavar="COLUMN", help="compare two groups as well: see survey compare --help")
    add("--report", type=Path, metavar="DIR", help="write report.html, tables and figures into this folder")
    add("--json", action="store_true", help="everything, machine-readable")
    return command


def _run(args: argparse.Namespace) -> int:
    # With --json an analysis that cannot be is told as {"error": …} as well.
    from survey.analysis import AnalysisError, TooFewRows
    from survey.analysis.procedure import descriptives, printed, summary

    if args.demo == ALL:
        return list_demonstrations()
    if args.factors == "parallel" and not args.parallel:
        args.parser.error("--factors parallel needs the samples that --parallel 0 leaves out")
    try:
        # What visitors wrote stands in the report only.
        table = table_asked(args, texts=args.report is not None, labels=args.compare is not None)
        analysis = _analysed(table, args)
        beyond = _beyond(args, table)
    except AnalysisError as error:
        if args.json:
            told = {"error": {"code": error.code, "items": list(error.items), "message": str(error)}}
            print(json.dumps(told, ensure_ascii=False))
        elif isinstance(error, TooFewRows) and _shows_the_way(args):
            return _report_of_the_sample(args, error)
        raise
    found = summary(analysis)
    if args.report is not None:
        _write_report(args, table, analysis, beyond)
    if args.json:
        found |= beyond.summary
        print(json.dumps(found, ensure_ascii=False, allow_nan=False, indent=1))
    else:
        print("\n\n".join([printed(found, descriptives(analysis)), *beyond.printed]))
    return 0


def _shows_the_way(args: argparse.Namespace) -> bool:
    """Whether a report is asked for of the stored answers to the questionnaire that the synthetic sample is of, and
    nothing in it that a sample has not."""
    from survey.demonstration import questionnaire_id

    stored = args.file is None and args.questionnaire == questionnaire_id()
    return stored and args.report is not None and args.compare is None


def _report_of_the_sample(args: argparse.Namespace, error: AnalysisError) -> int:
    """Too few have answered: the report shows the way of the indicators all the same, and whose scores these are."""
    from survey.demonstration import sample_name
    from survey.scores import sample_scores

    problem = str(error).partition(" – ")[0]
    print(f"survey: {args.questionnaire}: {problem}; the report is of the synthetic sample {sample_name()}",
          file=sys.stderr)  # fmt: skip
    table = sample_scores(sample_name(), args.content)
    _write_report(args, table, _analysed(table, args), _beyond(args, table))
    return 0


def _analysed(table: ScoreTable, args: argparse.Namespace) -> Analysis:
    from survey.analysis import analyse
    from survey.scores import context_of

    settings = _settings(args, table)
    run = partial(
        analyse,
        table.scores,
        table.items,
        settings=settings,
        context=context_of(table, points_of(table, args)),
    )
    if settings.bootstrap * table.scores.size < 50_000_000:
        return run()
    with counted("bootstrap", settings.bootstrap) as progress:
        return run(progress=progress)


def _write_report(args: argparse.Namespace, table: ScoreTable, analysis: Analysis, beyond: Beyond) -> None:
    from survey.report import Part, write_report
    from survey.scores import other_roles

    beside = []
    if args.file is None and table.questionnaire is not None and table.questionnaire.dimensions:
        found = other_roles(where(args), args.content, table.questionnaire)
        beside = [Part(other, other.questionnaire) for other in found if other.questionnaire is not None]
    page = write_report(args.report, table, analysis, beside, beyond.chapters)
    print(f"survey: {page}", file=sys.stderr)


def _settings(args: argparse.Namespace, table: ScoreTable) -> Settings:
    from survey.analysis.procedure import Settings
    from survey.scores import dropped, reverse_keyed

    return Settings(
        drop=dropped(args.drop, table.questionnaire),
        factors=args.factors,
        rotation=args.rotation,
        missing=args.missing,
        method=args.correlation,
        bootstrap=args.bootstrap,
        draws=args.parallel,
        seed=args.seed,
        reverse=reverse_keyed(args.reverse, table),
    )


def _beyond(args: argparse.Namespace, table: ScoreTable) -> Beyond:
    """--confirm and --compare, where they are asked for. Raises what `confirm` and `compare` raise."""
    from survey.analysis.comparison import comparison_printed, comparison_summary
    from survey.analysis.confirmatory import confirmation_printed, confirmation_summary
    from survey.commands.research.compare import compared
    from survey.commands.research.confirm import confirmed
    from survey.commands.research.sources import turned_source
    from survey.report.chapters import comparison_chapter, confirmation_chapter

    summary: dict[str, Any] = {}
    printed, chapters = [], []
    if args.confirm is not None:
        found = confirmed(turned_source(table, args), args, args.confirm)
        summary["confirmation"] = confirmation_summary(found)
        printed.append(confirmation_printed(found))
        chapters.append(partial(confirmation_chapter, found))
    if args.compare is not None:
        made = compared(table, args, args.compare)
        both = made.found  # the analysis tells of the table itself
        summary["comparison"] = comparison_summary(both)
        printed.append(comparison_printed(both))
        chapters.append(partial(comparison_chapter, both, made.names))
    return Beyond(summary, tuple(printed), tuple(chapters))
