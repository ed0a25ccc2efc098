"""`hall`: open the hall, build its garments, check its content, hand on its catalogue, its people, measure it."""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
from collections.abc import Sequence
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

__all__ = ["main"]

_COMMANDS = {
    "serve": "hall_app.web.command",
    "build": "hall_app.build.command",
    "check": "hall_app.check.command",
    "collection": "hall_app.web.collection.table.command",
    "admin": "hall_app.house.people.command",
    "backup": "hall_app.house.safekeeping.command",  # and restore
}
_BENCHES = ("walking", "page", "look", "crowd")

_EPILOG = """\
examples:
  hall serve                          open the hall at http://127.0.0.1:8000
  hall serve --content my-hall        with a content folder of your own
  hall check my-hall                  say what is wrong in it, one line a problem
  hall collection export all.csv      the catalogue as a table; import takes its changes back
  hall build                          dress the outfits that changed, or what they name
  hall admin create anna@example.org  make the first administrator of the house, who signs in at /office
  hall backup today.zip               content, accounts and answers in one file; hall restore makes a house of it

The content folder is --content, else ./assets, else the copy that came with the program.
Exit status: 0 done, 1 the work failed or content is invalid, 2 wrong arguments."""

_BENCH_EPILOG = """\
walking  a million random moves among all obstacles, tested by an independent exact method; the clearance grid's
         time, bytes and error; the page's prediction against the server
page     cold load, bytes, close-up and key-to-camera time in a real Chromium (needs the extra 'test')
crowd    round trips, processor and memory of 100 visitors, wave after wave; what one attacker costs 30 others
look     CPU time a picture of the same hall: light baked as shipped, one ambient light, viser's default environment

Arguments after -- go to the part's own program, e.g.  hall bench walking -- --moves 100000"""


def _version() -> str:
    try:
        return version("handress-hall")
    except PackageNotFoundError:
        return "not installed"


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="hall",
        description="A virtual exhibition hall of traditional Han dress, in the browser.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action="version", version=_version())
    parser.add_argument("--debug", action="store_true", help="show the traceback of an error")
    subparsers = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)
    for module in _COMMANDS.values():
        import_module(module).add_parser(subparsers)
    _add_bench(subparsers)
    for command in subparsers.choices.values():
        # Behind the command as well; without it, what stands before the command holds.
        command.add_argument(
            "--debug", action="store_true", default=argparse.SUPPRESS, help="show the traceback of an error"
        )
    return parser


def _add_bench(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Declare `hall bench`."""
    parser = subparsers.add_parser(
        "bench",
        help="measure walking, the page and a crowd",
        description="Measure time and error together; prints tables, --json FILE writes the figures.",
        epilog=_BENCH_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("part", nargs="?", choices=_BENCHES, help="one part; all when left out")
    parser.add_argument(
        "rest", nargs=argparse.REMAINDER, metavar="-- ARGUMENTS", help="for the part's program"
    )
    parser.set_defaults(run=_bench)


def _bench(arguments: argparse.Namespace) -> int:
    """Run the programs; 2 outside a checkout."""
    folder = Path(__file__).resolve().parent.parent / "tests" / "bench"
    if not folder.is_dir():
        print("hall bench: works in a checkout of the project, not in an installed copy", file=sys.stderr)
        return 2
    rest = [word for word in arguments.rest if word != "--"]
    for part in (arguments.part,) if arguments.part else _BENCHES:
        if subprocess.run([sys.executable, str(folder / f"bench_{part}.py"), *rest], check=False).returncode:
            return 1
    return 0


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command; returns the exit status. Errors are one line on standard error."""
    # Before numpy is imported: matrices here are small, and threads that wait for each other take the second core from
    # who draws beside who simulates.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    try:
        arguments = _parser().parse_args(argv)
        try:
            return arguments.run(arguments)
        except Exception as error:
            if arguments.debug:
                raise
            print(f"hall {arguments.command}: {_one_line(error)}", file=sys.stderr)
            return 1
    except KeyboardInterrupt:
        return 130


def _one_line(error: Exception) -> str:
    text = " ".join(str(error).split())
    return text or type(error).__name__


if __name__ == "__main__":
    sys.exit(main())
