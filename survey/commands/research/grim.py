"""`survey grim`: whether printed means are possible."""

from __future__ import annotations

import argparse
import json
from typing import Any

from survey.commands.options import declare, positive

__all__ = ["add"]

_MORE = """\
A mean of n whole numbers is a whole number over n. Whether a printed mean can be one is all that GRIM asks (Brown
and Heathers 2017); write the means with the decimals they are printed with."""


def add(commands) -> argparse.ArgumentParser:
    """Declare the command."""
    command = declare(commands, "grim", _run, "check whether printed means are possible", _MORE)
    command.add_argument("means", nargs="+", metavar="MEAN", help="as printed, such as 4.46")
    command.add_argument("--n", type=positive, required=True, metavar="N", help="how many people answered")
    command.add_argument(
        "--items", type=positive, default=1, metavar="K", help="items averaged in each mean (default: 1)"
    )
    command.add_argument("--json", action="store_true", help="machine-readable")
    return command


def _run(args: argparse.Namespace) -> int:
    # Exit status 0 also where a mean is impossible: the question was answered.
    from survey.analysis import grim, least_n

    possible = {mean: grim(mean, args.n, items=args.items) for mean in args.means}
    least = least_n(args.means, items=args.items)
    if args.json:
        told: dict[str, Any] = {"n": args.n, "items": args.items, "possible": possible, "least_n": least}
        print(json.dumps(told))
        return 0
    for mean, fine in possible.items():
        print(f"{mean}  {'possible' if fine else 'IMPOSSIBLE'} with n = {args.n}")
    print(f"smallest n that makes all possible: {least}" if least else "no n up to 10000 makes all possible")
    return 0
