"""`hall bench`: walking, the page, its picture and a crowd, measured in a checkout."""

from __future__ import annotations

import argparse
import subprocess
import sys
from pathlib import Path

__all__ = ["add_parser", "run"]

PARTS = ("walking", "page", "look", "crowd")

_EPILOG = """\
walking  a million random moves among all obstacles, tested by an independent exact method; the clearance grid's
         time, bytes and error; the page's prediction against the server
page     cold load, bytes, close-up and key-to-camera time in a real Chromium (needs the extra 'test')
crowd    round trips, processor and memory of 100 visitors, wave after wave; what one attacker costs 30 others
look     CPU time a picture of the same hall: light baked as shipped, one ambient light, viser's default environment

Arguments after -- go to the part's own program, e.g.  hall bench walking -- --moves 100000"""


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Declare `hall bench`."""
    parser = subparsers.add_parser(
        "bench",
        help="measure walking, the page and a crowd",
        description="Measure time and error together; prints tables, --json FILE writes the figures.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("part", nargs="?", choices=PARTS, help="one part; all when left out")
    parser.add_argument(
        "rest", nargs=argparse.REMAINDER, metavar="-- ARGUMENTS", help="for the part's program"
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Run the programs; 2 outside a checkout."""
    folder = Path(__file__).resolve().parent.parent / "tests" / "bench"
    if not folder.is_dir():
        print("hall bench: works in a checkout of the project, not in an installed copy", file=sys.stderr)
        return 2
    rest = [word for word in arguments.rest if word != "--"]
    for part in (arguments.part,) if arguments.part else PARTS:
        if subprocess.run([sys.executable, str(folder / f"bench_{part}.py"), *rest], check=False).returncode:
            return 1
    return 0
