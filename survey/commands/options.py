"""Arguments that several subcommands share."""

from __future__ import annotations

import argparse
import ipaddress
from pathlib import Path

__all__ = ["add_content", "add_proxy", "add_store", "declare", "existing_store", "positive", "where"]


def declare(commands, name: str, run, about: str, more: str = "") -> argparse.ArgumentParser:
    """A subcommand with its page of help."""
    command = commands.add_parser(
        name,
        help=about,
        description=f"{about[0].upper()}{about[1:]}.\n\n{more}".strip(),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    command.set_defaults(run=run)
    return command


def add_content(command: argparse.ArgumentParser) -> None:
    """--content."""
    command.add_argument(
        "--content", type=Path, metavar="DIR", help="content folder (default: ./assets, else ours)"
    )


def add_proxy(command: argparse.ArgumentParser, what: str) -> None:
    """--proxy: `what` is whose word is believed on where visitors come from."""
    text = f"{what}, whose X-Forwarded-For is believed; may be given several times"
    command.add_argument("--proxy", action="append", type=_address, default=[], metavar="ADDRESS", help=text)


def _address(text: str) -> str:
    try:
        return str(ipaddress.ip_address(text))
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text[:50]!r} is no address – give one such as 10.0.0.2") from None


def add_store(command: argparse.ArgumentParser) -> None:
    """--data and --db."""
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


def where(args: argparse.Namespace) -> Path | str:
    """The database's URL or the data folder."""
    return args.db or args.data


def positive(text: str) -> int:
    """Type of an argument: a whole number from 1 on, as a database can hold it."""
    if not (text.isascii() and text.isdecimal()) or len(text) > 10 or not 0 < int(text) < 2**31:
        raise argparse.ArgumentTypeError(f"{text[:20]!r} is no number from 1 on")
    return int(text)


def existing_store(args: argparse.Namespace):
    """The store that the arguments name. Raises SurveyError where none was made yet."""
    from survey.store import existing_store

    return existing_store(where(args))
