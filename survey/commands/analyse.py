"""`survey analyse`: answers in; tables, JSON or a report out."""

from __future__ import annotations

import argparse
import json
import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from survey.commands.options import add_content, add_store, declare, positive, where

if TYPE_CHECKING:
    from survey.analysis.pipeline import Analysis, Settings
    from survey.reading import ScoreTable

__all__ = ["add"]

_MORE = """\
The procedure of the paper: means, Pearson correlations with stars, pairs too close to keep both, KMO, Bartlett's
test, components with an eigenvalue above 1, Kaiser-normalised varimax, Cronbach's alpha. Beside it what the paper
lacks: parallel analysis, MAP, omega, bootstrap intervals, answers worth a second look. What cannot be computed is
left out and explained; nothing is deleted.

Items are the questionnaire's, or without --questionnaire every column of numbers. An empty cell or NA is a missing
score; a column `seconds` holds the time each answer took."""


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
    command.add_argument(
        "file", nargs="?", type=Path, metavar="FILE.csv", help="a table; default: the stored answers"
    )
    add = command.add_argument
    add("--questionnaire", metavar="ID", help="whose items to analyse (needed without FILE.csv)")
    add("--version", type=positive, metavar="N", help="an earlier version (default: the file's)")
    add("--demo", metavar="NAME", help="a synthetic sample instead of answers: --demo list names them")
    add(
        "--drop",
        default="none",
        metavar="WHAT",
        help='items to leave out: "none", a tag ("static"), or ITEM,ITEM …',
    )
    add("--rotation", choices=["varimax", "oblimin", "none"], default="varimax", help="default: varimax")
    text = "how many components: N, kaiser (eigenvalue above 1) or parallel (default: kaiser)"
    add("--factors", type=_factors, default="kaiser", metavar="N", help=text)
    text = "answers with gaps: leave out whole, or only where both items are needed (default: listwise)"
    add("--missing", choices=["listwise", "pairwise"], default="listwise", help=text)
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
    add("--report", type=Path, metavar="DIR", help="write report.html, tables and figures into this folder")
    add("--json", action="store_true", help="everything, machine-readable")
    command.set_defaults(parser=command)
    add_content(command)
    add_store(command)
    return command


def _run(args: argparse.Namespace) -> int:
    # With --json an analysis that cannot be is told as {"error": …} as well.
    from survey.analysis.errors import AnalysisError
    from survey.analysis.printed import printed
    from survey.analysis.summary import descriptives, summary
    from survey.working import load_scores

    if args.demo == "list":
        return _list_demonstrations()
    if args.file is None and args.questionnaire is None and args.demo is None:
        args.parser.error("name a FILE.csv, or a --questionnaire of the stored answers, or a --demo")
    if args.factors == "parallel" and not args.parallel:
        args.parser.error("--factors parallel needs the samples that --parallel 0 leaves out")
    if args.demo is not None:
        table = _demonstration(args)
    else:
        table = load_scores(args.file, where(args), args.content, args.questionnaire, args.version)
    if table.beside:
        print(f"survey: {args.questionnaire}: {table.beside}", file=sys.stderr)
    try:
        analysis = _analysed(table, args)
    except AnalysisError as error:
        if args.json:
            told = {"error": {"code": error.code, "items": list(error.items), "message": str(error)}}
            print(json.dumps(told, ensure_ascii=False))
        raise
    found = summary(analysis)
    if args.report is not None:
        _write_report(args, table, analysis)
    if args.json:
        print(json.dumps(found, ensure_ascii=False, allow_nan=False, indent=1))
    else:
        print(printed(found, descriptives(analysis)))
    return 0


def _list_demonstrations() -> int:
    from survey.demonstration import SAMPLES

    for name, (_, english) in SAMPLES.items():
        print(f"{name:18}{english}")
    return 0


def _demonstration(args: argparse.Namespace) -> ScoreTable:
    from survey.demonstration import SAMPLES, sample_file
    from survey.reading import read_scores
    from survey.working import find_questionnaire_file

    if args.file is not None:
        args.parser.error("give a FILE.csv or a --demo, not both")
    if args.demo not in SAMPLES:
        args.parser.error(f"--demo: {args.demo!r} is none of {', '.join(SAMPLES)}")
    table = read_scores(sample_file(args.demo), find_questionnaire_file(args.content, "garment"))
    return replace(table, source=args.demo)


def _analysed(table: ScoreTable, args: argparse.Namespace) -> Analysis:
    from survey.analysis import analyse

    settings = _settings(args, table)
    # The synthetic samples have no scale to keep to: exact moments make broken scores.
    asked = None if table.synthetic else table.questionnaire
    points = None if asked is None else asked.points
    if settings.bootstrap * table.scores.size < 50_000_000 or not sys.stderr.isatty():
        return analyse(table.scores, table.items, settings=settings, seconds=table.seconds, points=points)
    from rich.console import Console
    from rich.progress import Progress

    with Progress(console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("bootstrap", total=settings.bootstrap)
        return analyse(
            table.scores,
            table.items,
            settings=settings,
            seconds=table.seconds,
            points=points,
            progress=lambda done: bar.advance(task, done),
        )


def _write_report(args: argparse.Namespace, table: ScoreTable, analysis: Analysis) -> None:
    from survey.report import Part, write_report
    from survey.working import other_roles

    beside = []
    if args.file is None and table.questionnaire is not None and table.questionnaire.dimensions:
        found = other_roles(where(args), args.content, table.questionnaire)
        beside = [Part(other, other.questionnaire) for other in found if other.questionnaire is not None]
    page = write_report(args.report, table, analysis, beside)
    print(f"survey: {page}", file=sys.stderr)


def _settings(args: argparse.Namespace, table: ScoreTable) -> Settings:
    from survey.analysis.pipeline import Settings
    from survey.working import dropped

    return Settings(
        drop=dropped(args.drop, table.questionnaire),
        factors=args.factors,
        rotation=args.rotation,
        missing=args.missing,
        method=args.correlation,
        bootstrap=args.bootstrap,
        draws=args.parallel,
        seed=args.seed,
    )
