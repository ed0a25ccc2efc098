"""`hall`: open the hall, build its garments, check its content, measure it."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version

__all__ = ["main"]

_COMMANDS = {
    "serve": "hall_app.serve",
    "build": "hall_app.bake.command",
    "check": "hall_app.content.command",
    "bench": "hall_app.bench",
}

_EPILOG = """\
examples:
  hall serve                          open the hall at http://127.0.0.1:8000
  hall serve --content my-hall        with a content folder of your own
  hall check my-hall                  say what is wrong in it, one line a problem
  hall build                          simulate the garments whose pattern, weave or recipe changed

The content folder is --content, else ./assets, else the copy that came with the program.
Exit status: 0 done, 1 the work failed or content is invalid, 2 wrong arguments."""


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
    for command in subparsers.choices.values():
        # Behind the command as well; without it, what stands before the command holds.
        command.add_argument(
            "--debug", action="store_true", default=argparse.SUPPRESS, help="show the traceback of an error"
        )
    return parser


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command; returns the exit status. Errors are one line on standard error."""
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
