"""The command `survey`."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from survey.commands.analyse import (
    ABOUT,
    GRIM_ABOUT,
    add_analyse_arguments,
    add_grim_arguments,
    run_analyse,
    run_grim,
)
from survey.commands.export import ABOUT as EXPORT_ABOUT
from survey.commands.export import add_export_arguments, run_export
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
  survey token --label "Dr Lin"                      access to rows and suggestions over HTTP

exit status: 0 done, 1 the work failed, 2 wrong arguments"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; returns the exit status."""
    args = _parser().parse_args(arguments)
    try:
        return args.run(args)
    except KeyboardInterrupt:
        return 130
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
    for add in (_add_serve, _add_export, _add_analyse, _add_grim, _add_token):
        command = add(commands)
        # Taken before and after the command; SUPPRESS, so that its default does not undo the one before.
        command.add_argument(
            "--debug", action="store_true", default=argparse.SUPPRESS, help=argparse.SUPPRESS
        )
    return parser


def _port(text: str) -> int:
    if not text.isdecimal() or not 0 < int(text[:6]) < 65536:
        raise argparse.ArgumentTypeError(f"{text!r} is no port – give a number from 1 to 65535")
    return int(text)


def _number(text: str) -> int:
    if not text.isdecimal() or not 0 < int(text[:10]) < 2**31 or len(text) > 10:
        raise argparse.ArgumentTypeError(f"{text[:20]!r} is no number from 1 on")
    return int(text)


def _label(text: str) -> str:
    if len(text) > 200 or not text.isprintable():
        raise argparse.ArgumentTypeError("give at most 200 printable characters")
    return text


def _command(commands, name: str, run, about: str, more: str = "") -> argparse.ArgumentParser:
    command = commands.add_parser(
        name,
        help=about,
        description=f"{about[0].upper()}{about[1:]}.\n\n{more}".strip(),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    command.set_defaults(run=run)
    return command


def _add_places(command: argparse.ArgumentParser, *, content: bool = True) -> None:
    if content:
        command.add_argument(
            "--content", type=Path, metavar="DIR", help="content folder (default: ./assets, else ours)"
        )
    command.add_argument(
        "--data",
        type=Path,
        default=Path("hall-data"),
        metavar="DIR",
        help="data folder (default: ./hall-data)",
    )
    command.add_argument(
        "--db", metavar="URL", help="database instead of the data folder: postgresql+psycopg://…"
    )


def _add_serve(commands) -> argparse.ArgumentParser:
    more = "Without the hall: forms at /questionnaires, the API at /api/v1, its description at /api/v1/openapi.json."
    command = _command(commands, "serve", _serve, "serve the questionnaires", more)
    command.add_argument("--host", default="127.0.0.1", help="address to listen on (default: 127.0.0.1)")
    command.add_argument("--port", type=_port, default=8001, help="port to listen on (default: 8001)")
    _add_places(command)
    return command


def _add_export(commands) -> argparse.ArgumentParser:
    command = _command(
        commands, "export", run_export, "export all answers to one questionnaire", EXPORT_ABOUT
    )
    add_export_arguments(command)
    _add_places(command)
    return command


def _add_analyse(commands) -> argparse.ArgumentParser:
    command = _command(commands, "analyse", run_analyse, "analyse the answers to one questionnaire", ABOUT)
    add_analyse_arguments(command)
    _add_places(command)
    return command


def _add_grim(commands) -> argparse.ArgumentParser:
    command = _command(commands, "grim", run_grim, "check whether printed means are possible", GRIM_ABOUT)
    add_grim_arguments(command)
    return command


def _add_token(commands) -> argparse.ArgumentParser:
    more = "It is shown once and stored as a hash. Send it as `Authorization: Bearer TOKEN`."
    command = _command(
        commands, "token", _token, "make a token for rows, suggestions and export over HTTP", more
    )
    command.add_argument("--label", type=_label, default="", help="whose it is, for --list")
    which = command.add_mutually_exclusive_group()
    which.add_argument("--list", action="store_true", help="list the tokens instead")
    which.add_argument(
        "--revoke", type=_number, metavar="NUMBER", help="revoke the token of this number instead"
    )
    _add_places(command, content=False)
    return command


def _where(args: argparse.Namespace) -> Path | str:
    return args.db or args.data


def _serve(args: argparse.Namespace) -> int:
    from survey.content import content_folder
    from survey.serving import serve, survey_app

    content = content_folder(args.content)
    app, mounted, problems = survey_app(content, _where(args))
    for problem in problems:
        print(f"survey: {problem}", file=sys.stderr)
    print(f"content {content}: {len(mounted.questionnaires)} questionnaires, {len(problems)} problems")
    print(f"http://{args.host}:{args.port}/questionnaires", flush=True)
    serve(app, args.host, args.port)
    return 0


def _token(args: argparse.Namespace) -> int:
    from survey.store import Store

    store = Store(_where(args))
    try:
        if args.list:
            for token in store.tokens.all():
                print(f"{token.id}\t{token.made:%Y-%m-%d %H:%M}\t{token.label}")
            return 0
        if args.revoke is not None:
            if not store.tokens.revoke(args.revoke):
                raise SurveyError(f"token {args.revoke}: there is none – see survey token --list")
            print(f"token {args.revoke} is revoked")
            return 0
        print(store.tokens.make(args.label))
        return 0
    finally:
        store.close()


if __name__ == "__main__":
    sys.exit(main())
