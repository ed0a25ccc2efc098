"""`survey freeze`: fix the answers for evaluation."""

from __future__ import annotations

import argparse
from contextlib import closing

from survey.commands.options import add_store, declare, existing_store
from survey.errors import SurveyError

__all__ = ["add"]

_MORE = """\
Answers received until now cannot be withdrawn any more (409), so that a published figure can be computed again.
Answers that come later stay open until the next freeze. It cannot be undone."""


def add(commands) -> argparse.ArgumentParser:
    """Declare the command."""
    command = declare(commands, "freeze", _run, "fix the answers to one questionnaire for evaluation", _MORE)
    command.add_argument("questionnaire", metavar="ID", help="which one, such as garment")
    add_store(command)
    return command


def _run(args: argparse.Namespace) -> int:
    with closing(existing_store(args)) as store:
        if not store.versions(args.questionnaire):
            raise SurveyError(f"{args.questionnaire[:60]}: no answers in this store – check the id")
        count = store.freeze(args.questionnaire)
    print(f"{args.questionnaire}: {count} answers fixed for evaluation now")
    return 0
