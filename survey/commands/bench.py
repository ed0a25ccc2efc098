"""`survey bench`: the service and the statistics, measured in a checkout."""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
from pathlib import Path

from survey.commands.options import declare

__all__ = ["add"]

PARTS = {
    "service": "bench_survey.py",
    "analysis": "bench_survey_analysis.py",
    "r": "bench_survey_r.py",
    "lavaan": "bench_survey_lavaan.py",
}

_MORE = """\
service   submissions a second over HTTP at 16 clients with every answer on the disk before it is acknowledged, a bare
          write-and-sync loop beside it, the order of sync and acknowledgement as strace sees it, 50 kills in
          mid-write, a full disk, what visitors wait while 100,000 answers are exported and how long their analysis
          takes, and schemathesis on the API's description
analysis  time and error of the statistics beside factor_analyzer
r         every figure beside R's psych on six data sets, the scales of its bfi through `survey analyse` too; left out,
          saying so, where there is no Rscript with psych
lavaan    every figure of the confirmatory factor analysis beside R's lavaan; left out in the same way

Each writes its figures into docs/figures and ends with status 1 where one misses what is asked for. Needs the extra
'test'; works in a checkout."""


def add(commands) -> argparse.ArgumentParser:
    """Declare the command."""
    command = declare(commands, "bench", _run, "measure the service and the statistics", _MORE)
    text = f"one of them instead of all: {', '.join(PARTS)}"
    command.add_argument("--only", choices=PARTS, metavar="PART", help=text)
    command.add_argument(
        "rest",
        nargs="*",
        metavar="-- ARGUMENTS",
        help="for that program; see survey bench --only PART -- --help",
    )
    command.set_defaults(parser=command)
    return command


def _run(args: argparse.Namespace) -> int:
    root = Path(__file__).resolve().parents[2]
    folder = root / "tests" / "bench"
    if not folder.is_dir():
        print("survey bench: works in a checkout of the project, not in an installed copy", file=sys.stderr)
        return 2
    if args.rest and args.only is None:
        args.parser.error("name the program that the arguments are for with --only")
    status, environment = 0, os.environ | {"PYTHONPATH": str(root)}
    for part in [args.only] if args.only else PARTS:
        print(f"== {part}", flush=True)
        program = [sys.executable, str(folder / PARTS[part]), *args.rest]
        done = subprocess.run(program, check=False, env=environment)
        status = max(status, 1 if done.returncode else 0)
    return status
