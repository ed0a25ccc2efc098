"""`survey token`: who may read rows over HTTP, of what and how long."""

from __future__ import annotations

import argparse
from contextlib import closing
from datetime import UTC, date, datetime

from survey.commands.options import add_content, add_store, declare, existing_store, positive, where
from survey.errors import SurveyError

__all__ = ["add"]

_MORE = """\
It is shown once and stored as a hash. Send it as `Authorization: Bearer TOKEN`. It is good for 90 days and for every
questionnaire unless told otherwise. --list tells what each opens, until when, and on which day it was used last; an
expired one stays in the list until it is revoked. Making and revoking are in `survey audit`."""

MOST_DAYS = 3650


def add(commands) -> argparse.ArgumentParser:
    """Declare the command."""
    about = "make a token for rows, suggestions, export and analysis over HTTP"
    command = declare(commands, "token", _run, about, _MORE)
    command.add_argument("--label", type=_label, default="", help="whose it is, for --list")
    command.add_argument("--questionnaire", metavar="ID", help="the only one that it opens (default: all)")
    ends = command.add_mutually_exclusive_group()
    ends.add_argument("--days", type=_days, metavar="N", help="how long it is good (default: 90)")
    ends.add_argument("--never", action="store_true", help="it never expires")
    which = command.add_mutually_exclusive_group()
    which.add_argument("--list", action="store_true", help="list the tokens instead")
    which.add_argument(
        "--revoke", type=positive, metavar="NUMBER", help="revoke the token of this number instead"
    )
    add_content(command)
    add_store(command)
    command.set_defaults(parser=command)
    return command


def _label(text: str) -> str:
    if len(text) > 180 or not text.isprintable():
        raise argparse.ArgumentTypeError("give at most 180 printable characters")
    return text


def _days(text: str) -> int:
    days = positive(text)
    if days > MOST_DAYS:
        raise argparse.ArgumentTypeError(f"{days} days are over {MOST_DAYS} – give fewer, or --never")
    return days


def _run(args: argparse.Namespace) -> int:
    from survey.store import TOKEN_DAYS, Store

    # A token may come before the first answer; a list of them, or an end to one, may not.
    new = not args.list and args.revoke is None
    if not new and (args.questionnaire or args.days or args.never):
        args.parser.error("--questionnaire, --days and --never are for a new token")
    if args.questionnaire is not None:
        _see_that_there_is(args)
    with closing(Store(where(args)) if new else existing_store(args)) as store:
        if args.list:
            today = datetime.now(UTC).date()
            for token in store.tokens.all():
                print("\t".join(_told(token, today)))
        elif args.revoke is None:
            days = None if args.never else args.days or TOKEN_DAYS
            print(store.tokens.make(args.label, questionnaire=args.questionnaire, days=days))
        elif store.tokens.revoke(args.revoke):
            print(f"token {args.revoke} is revoked")
        else:
            raise SurveyError(f"token {args.revoke}: there is none – see survey token --list")
    return 0


def _see_that_there_is(args: argparse.Namespace) -> None:
    """A misspelt one would be noticed by the researcher only. It may have left the content and still have answers."""
    from survey.questionnaire import find_questionnaire_file
    from survey.store import Store
    from survey.store.database import tables

    file = tables.sqlite_file(where(args))
    if file is None or file.is_file():
        with closing(Store(where(args))) as store:
            if store.versions(args.questionnaire):
                return
    find_questionnaire_file(args.content, args.questionnaire)


def _told(token, today: date) -> tuple[str, ...]:
    if token.expires is None:
        end = "never expires"
    elif token.expired(today):
        end = f"expired on {token.expires}"
    else:
        end = f"good until {token.expires}"
    return (
        str(token.id),
        f"made {token.made:%Y-%m-%d}",
        end,
        "all questionnaires" if token.questionnaire is None else f"{token.questionnaire} only",
        "never used" if token.used is None else f"last used {token.used}",
        token.label,
    )
