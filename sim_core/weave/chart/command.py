"""The arguments of `simcore weave` that draw a draft: what they are, when they say nothing, and the drawing itself."""

from __future__ import annotations

import argparse
import re
from pathlib import Path

from sim_core.errors import WrongArgument
from sim_core.validation.arguments import ending, whole
from sim_core.weave.chart.cards import write_cards, write_pegs
from sim_core.weave.chart.paper import PAPERS
from sim_core.weave.chart.repeats import repeated
from sim_core.weave.chart.sheets import write_draft
from sim_core.weave.chart.values import View, Window
from sim_core.weave.files.sources import Source

__all__ = ["add_drawing", "check_drawing", "draw"]


def add_drawing(parser: argparse.ArgumentParser) -> None:
    """Describe the arguments to argparse."""
    parser.add_argument("--draft", type=ending(".svg", ".png"), metavar="FILE", help="picture of the draft")
    parser.add_argument("--cards", type=ending(".png"), metavar="FILE", help="the lift, a pixel a crossing")
    parser.add_argument("--pegs", type=ending(".png"), metavar="FILE", help="the lift plan, a pixel a peg")
    parser.add_argument(
        "--blocks", metavar="STRUCTURE",
        help="SOURCE is a profile draft: block it out by summer-winter, bronson, double, twill:3/1, satin:5/2 ...",
    )  # fmt: skip
    _add_view(parser.add_argument_group("how the draft is drawn, with --draft"))


def _add_view(group: argparse._ArgumentGroup) -> None:
    group.add_argument(
        "--view", choices=("structure", "colour"), default="structure",
        help="the drawdown filled where the warp is on top (default), or in the colours of its yarns",
    )  # fmt: skip
    group.add_argument(
        "--floats", type=whole(1, 9999), default=0, metavar="N",
        help="mark floats over more than N crossings: red on the face, blue and dashed on the back",
    )  # fmt: skip
    group.add_argument("--plan", action="store_true", help="draw a lift plan, not tie-up and treadling")
    group.add_argument(
        "--first", choices=("right", "left"), default="right",
        help="end 1 on the right, pick 1 on top (default), or on the left and at the bottom",
    )  # fmt: skip
    group.add_argument(
        "--paper", choices=PAPERS, metavar="NAME",
        help=f"{', '.join(PAPERS)}: on this paper, on several pages if need be (default: one sheet that fits)",
    )  # fmt: skip
    group.add_argument(
        "--times", type=_times, metavar="E,P", help="draw it E times side by side and P times along the warp"
    )
    group.add_argument(
        "--part", type=_part, metavar="E-E,P-P",
        help="ends and picks to draw, such as 1-120,1-80 (of what --times makes)",
    )  # fmt: skip


def _part(text: str) -> tuple[tuple[int, int], tuple[int, int]]:
    """Ends and picks of a part, from 0 and the last excluded."""
    found = re.fullmatch(r"(\d{1,6})-(\d{1,6}),(\d{1,6})-(\d{1,6})", text, re.ASCII)
    numbers = [int(n) for n in found.groups()] if found else []
    if not numbers or not (1 <= numbers[0] <= numbers[1] and 1 <= numbers[2] <= numbers[3]):
        raise argparse.ArgumentTypeError(f"{text[:40]!r} – give ends and picks, such as 1-120,1-80")
    return (numbers[0] - 1, numbers[1]), (numbers[2] - 1, numbers[3])


def _times(text: str) -> tuple[int, int]:
    """How often a draft is drawn across and along."""
    found = re.fullmatch(r"([1-9]\d{0,3}),([1-9]\d{0,3})", text, re.ASCII)
    if not found:
        raise argparse.ArgumentTypeError(f"{text[:40]!r} – give repeats across and along, such as 4,3")
    return int(found[1]), int(found[2])


def check_drawing(args: argparse.Namespace) -> None:
    """Raises WrongArgument where an argument says how a draft is drawn and none is."""
    drawn = {"view": args.view != "structure", "floats": args.floats, "plan": args.plan,
             "first": args.first != "right", "part": args.part, "paper": args.paper, "times": args.times}  # fmt: skip
    idle = [name for name, given in drawn.items() if given]
    if idle and not args.draft:
        raise WrongArgument(f"--{idle[0]}: says how a draft is drawn – add --draft FILE")


def draw(args: argparse.Namespace, source: Source) -> list[Path]:
    """The pictures of the draft that were asked for. Returns what was written."""
    written: list[Path] = []
    if not (args.draft or args.cards or args.pegs):
        return written
    if args.draft:
        view = View(args.view == "colour", args.floats, args.plan, args.first)
        drawn = repeated(source, *args.times) if args.times else source
        part = Window(*args.part) if args.part else None
        written += write_draft(drawn, args.draft, view, part, args.paper or "")
    if args.cards:
        written += write_cards(source, args.cards)
    if args.pegs:
        written += write_pegs(source, args.pegs)
    return written
