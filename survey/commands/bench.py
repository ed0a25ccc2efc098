"""`survey bench`: the service, measured in a checkout."""

from __future__ import annotations

import argparse
import subprocess
import sys
from pathlib import Path

from survey.commands.options import declare

__all__ = ["add"]

_MORE = """\
Submissions a second over HTTP at 16 clients with every answer on the disk before it is acknowledged, a bare
write-and-sync loop beside it, the order of sync and acknowledgement as strace sees it, 50 kills in mid-write, a full
disk, and schemathesis on the API's description. Needs the extra 'test'; works in a checkout."""


def add(commands) -> argparse.ArgumentParser:
    """Declare the command."""
    command = declare(commands, "bench", _run, "measure the service: speed, durability, conformity", _MORE)
    command.add_argument("rest", nargs=argparse.REMAINDER, metavar="-- ARGUMENTS", help="for the program")
    return command


def _run(args: argparse.Namespace) -> int:
    program = Path(__file__).resolve().parents[2] / "tests" / "bench" / "bench_survey.py"
    if not program.is_file():
        print("survey bench: works in a checkout of the project, not in an installed copy", file=sys.stderr)
        return 2
    rest = [word for word in args.rest if word != "--"]
    return 1 if subprocess.run([sys.executable, str(program), *rest], check=False).returncode else 0
