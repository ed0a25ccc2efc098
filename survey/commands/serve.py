"""`survey serve`: the questionnaires without the hall."""

from __future__ import annotations

import argparse
import sys

from survey.commands.options import add_content, add_proxy, add_store, declare, where
from survey.questionnaire import NEEDS

__all__ = ["add"]

_MORE = (
    "Without the hall: forms at /questionnaires, the API at /api/v1, its description at /api/v1/openapi.json, "
    "the record of processing at /privacy."
)


def add(commands) -> argparse.ArgumentParser:
    """Declare the command."""
    command = declare(commands, "serve", _run, "serve the questionnaires", _MORE)
    command.add_argument("--host", default="127.0.0.1", help="address to listen on (default: 127.0.0.1)")
    command.add_argument("--port", type=_port, default=8001, help="port to listen on (default: 8001)")
    text = "new answers a minute from one address; 0: any number (default: 300)"
    command.add_argument("--rate", type=_rate, metavar="N", help=text)
    text = (
        "what the place has, of "
        + ", ".join(NEEDS)
        + ", separated by commas, or none: what needs another is not asked (default: ask everything)"
    )
    command.add_argument("--offers", type=_offers, metavar="PARTS", help=text)
    add_proxy(command, "a proxy in front")
    add_content(command)
    add_store(command)
    return command


def _port(text: str) -> int:
    if not text.isdecimal() or not 0 < int(text[:6]) < 65536:
        raise argparse.ArgumentTypeError(f"{text!r} is no port – give a number from 1 to 65535")
    return int(text)


def _rate(text: str) -> int:
    if not text.isdecimal() or len(text) > 6:
        raise argparse.ArgumentTypeError(
            f"{text[:20]!r} is no number of answers a minute – 0 lifts the limit"
        )
    return int(text)


def _offers(text: str) -> frozenset[str]:
    parts = frozenset() if text == "none" else frozenset(part.strip() for part in text.split(","))
    for part in sorted(parts - set(NEEDS)):
        raise argparse.ArgumentTypeError(f"{part[:20]!r} is none of {', '.join(NEEDS)} – or write none")
    return parts


def _run(args: argparse.Namespace) -> int:
    from survey.questionnaire import content_folder
    from survey.web import Running, serve, survey_app

    content = content_folder(args.content)
    app, mounted, problems = survey_app(
        content, where(args), Running(args.rate, tuple(args.proxy)), args.offers
    )
    for problem in (*problems, *mounted.hints):
        print(f"survey: {problem}", file=sys.stderr)
    print(f"content {content}: {len(mounted.questionnaires)} questionnaires, {len(problems)} problems")
    print(f"http://{args.host}:{args.port}/questionnaires", flush=True)
    serve(app, args.host, args.port, args.proxy)
    return 0
