"""`survey token`: who may read rows over HTTP."""

from __future__ import annotations

import argparse
from contextlib import closing

from survey.commands.options import add_store, declare, existing_store, positive, where
from survey.errors import SurveyError

__all__ = ["add"]

_MORE = "It is shown once and stored as a hash. Send it as `Authorization: Bearer TOKEN`."


def add(commands) -> argparse.ArgumentParser:
    """Declare the command."""
    about = "make a token for rows, suggestions, export and analysis over HTTP"
    command = declare(commands, "token", _run, about, _MORE)
    command.add_argument("--label", type=_label, default="", help="whose it is, for --list")
    which = command.add_mutually_exclusive_group()
    which.add_argument("--list", action="store_true", help="list the tokens instead")
    which.add_argument(
        "--revoke", type=positive, metavar="NUMBER", help="revoke the token of this number instead"
    )
    add_store(command)
    return command


def _label(text: str) -> str:
    if len(text) > 200 or not text.isprintable():
        raise argparse.ArgumentTypeError("give at most 200 printable characters")
    return text


def _run(args: argparse.Namespace) -> int:
    from survey.store import Store

    # A token may come before the first answer; a list of them, or an end to one, may not.
    new = not args.list and args.revoke is None
    with closing(Store(where(args)) if new else existing_store(args)) as store:
        if args.list:
            for token in store.tokens.all():
                print(f"{token.id}\t{token.made:%Y-%m-%d %H:%M}\t{token.label}")
        elif args.revoke is None:
            print(store.tokens.make(args.label))
        elif store.tokens.revoke(args.revoke):
            print(f"token {args.revoke} is revoked")
        else:
            raise SurveyError(f"token {args.revoke}: there is none – see survey token --list")
    return 0
