"""The command `survey`."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence

from survey.commands import bench, privacy, serve
from survey.commands.research import analyse, compare, confirm, grim, plan
from survey.commands.storage import audit, backup, export, freeze, purge, token
from survey.errors import SurveyError

__all__ = ["main"]

_ABOUT = """\
Questionnaires of the hall: serve them, export the answers, analyse them.

Answers are kept in the data folder (./hall-data/survey.sqlite) or in a database given by its URL.
Questionnaires are the TOML files in the content folder's questionnaires/: --content, else ./assets,
else the copy that ships with the hall."""

_EXAMPLES = """\
examples:
  survey serve                                       questionnaires at http://127.0.0.1:8001
  survey export --questionnaire garment --out a.csv  all answers, opens in Excel
  survey analyse a.csv                               every numeric column is an item
  survey analyse --questionnaire garment --json      straight from the data folder
  survey analyse --demo likert-20 --drop static --report out   a report of a synthetic sample
  survey confirm --questionnaire garment --drop static         do the answers agree with the modules?
  survey compare --questionnaire garment --by language         two groups, item by item
  survey plan difference --effect 0.5                          how many answers a study needs
  survey token --label "Dr Lin"                      access to rows, suggestions and analysis over HTTP
  survey purge                                       erases what has been kept long enough, after asking
  survey audit                                       what was handed out, withdrawn and erased
  survey freeze garment                              from now on these answers cannot be withdrawn
  survey privacy --language en --out privacy.html    the record of processing
  survey backup 2026-05-01.sqlite                    a copy while the service runs

exit status: 0 done, 1 the work failed, 2 wrong arguments"""

_COMMANDS = (
    serve, export, analyse, confirm, compare, plan, grim, token, freeze, purge, audit, privacy, backup, bench,
)  # fmt: skip


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; returns the exit status."""
    args = _parser().parse_args(arguments)
    try:
        status = args.run(args)
        sys.stdout.flush()
        return status
    except KeyboardInterrupt:
        return 130
    except BrokenPipeError:
        # Whoever reads, such as head, has enough; Python would complain once more while it ends.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except Exception as error:
        if args.debug:
            raise
        known = str(error) if isinstance(error, SurveyError) else f"{type(error).__name__}: {error}"
        print(f"survey: {' '.join(known.split())}", file=sys.stderr)
        return 1


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="survey",
        description=_ABOUT,
        epilog=_EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--debug", action="store_true", help="show the traceback of an error")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    for module in _COMMANDS:
        command = module.add(commands)
        # Taken before and after the command; SUPPRESS, so that its default does not undo the one before.
        command.add_argument(
            "--debug", action="store_true", default=argparse.SUPPRESS, help=argparse.SUPPRESS
        )
    return parser


if __name__ == "__main__":
    sys.exit(main())
