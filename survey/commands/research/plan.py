"""`survey plan`: how many answers a study needs."""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable
from typing import Any

from survey.commands.options import declare, positive
from survey.commands.research.progress import counted

__all__ = ["add"]

_MORE = """\
How many answers, before any is asked for. Each goal prints a figure, what it rests on and what it would be if that
were otherwise; --json gives the same to a machine. Without a goal: all but factors, with the usual figures.

  survey plan mean --margin 0.2          a mean of a five-point item, to ± 0.2
  survey plan difference --effect 0.5    two groups that differ by half a standard deviation
  survey plan correlation --r 0.3        a correlation of two items
  survey plan reliability --alpha 0.85   Cronbach's alpha, shown to exceed .7
  survey plan fit --df 24                a confirmatory model, told from one that fits badly
  survey plan factors --n 50,100,200     how often an exploratory analysis finds its three factors (drawn)

These are lower bounds for answers that can be used: add what will have gaps."""

Told = tuple[dict[str, Any], list[str]]


def _share(text: str) -> float:
    return _figure(text, 1.0, "between 0 and 1")


def _above(text: str) -> float:
    return _figure(text, 1e6, "above 0")


def _figure(text: str, below: float, wanted: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = -1.0
    if not 0.0 < value < below:
        raise argparse.ArgumentTypeError(f"{text[:20]!r} is no figure {wanted}")
    return value


def _sizes(text: str) -> tuple[int, ...]:
    return tuple(positive(part.strip()) for part in text.split(","))


def add(commands) -> argparse.ArgumentParser:
    """Declare the command and its goals."""
    command = declare(commands, "plan", _run, "plan how many answers a study needs", _MORE)
    command.add_argument("--json", action="store_true", help="machine-readable")
    command.set_defaults(parser=command, goal=None)
    goals = command.add_subparsers(metavar="GOAL")
    mean = _goal(goals, "mean", "a mean and its 95 % interval", _mean)
    mean.add_argument(
        "--margin", type=_above, default=0.2, help="half of the interval [points] (default: 0.2)"
    )
    mean.add_argument("--sd", type=_above, default=1.0, help="of the scores [points] (default: 1.0)")
    mean.add_argument("--points", type=positive, default=5, help="of the scale (default: 5)")
    away = _goal(goals, "difference", "the difference of two groups", _difference)
    away.add_argument("--effect", type=_above, default=0.5, help="Hedges' g to be found (default: 0.5)")
    away.add_argument("--ratio", type=_above, default=1.0, help="second group over first (default: 1)")
    away.add_argument("--items", type=positive, default=1, help="items that are tested (default: 1)")
    _power(away)
    tied = _goal(goals, "correlation", "a correlation", _correlation)
    tied.add_argument("--r", type=_share, default=0.3, help="to be found (default: 0.3)")
    tied.add_argument("--margin", type=_share, default=0.1, help="half of its interval (default: 0.1)")
    _power(tied)
    sure = _goal(goals, "reliability", "Cronbach's alpha", _reliability)
    sure.add_argument("--alpha", type=_share, default=0.85, help="expected (default: 0.85)")
    sure.add_argument("--least", type=_share, default=0.7, help="to be exceeded (default: 0.7)")
    sure.add_argument("--items", type=positive, default=10, help="in the sum (default: 10)")
    sure.add_argument("--width", type=_share, default=0.1, help="of alpha's interval (default: 0.1)")
    _power(sure)
    _add_models(goals)
    return command


def _add_models(goals) -> None:
    fits = _goal(goals, "fit", "the fit of a confirmatory model", _fit)
    fits.add_argument(
        "--df", type=positive, help="its degrees of freedom (default: 24, of nine items and three factors)"
    )
    fits.add_argument(
        "--model", metavar="MODEL", help="instead of --df: the model, as survey confirm takes it"
    )
    fits.add_argument("--null", type=_share, default=0.05, help="RMSEA called close (default: 0.05)")
    fits.add_argument("--actual", type=_share, default=0.08, help="RMSEA to be told from it (default: 0.08)")
    _power(fits)
    made = _goal(goals, "factors", "what an exploratory analysis finds, by drawing samples", _factors)
    made.add_argument("--n", type=_sizes, default=(15, 20, 50, 100, 200), help="default: 15,20,50,100,200")
    made.add_argument("--draws", type=positive, default=400, help="samples of each size (default: 400)")
    made.add_argument("--seed", type=int, default=0, help="of the samples (default: 0)")


def _goal(
    goals, name: str, about: str, goal: Callable[[argparse.Namespace], Told]
) -> argparse.ArgumentParser:
    parser = goals.add_parser(name, help=about, description=f"Answers for {about}.")
    parser.add_argument("--json", action="store_true", default=argparse.SUPPRESS, help="machine-readable")
    parser.set_defaults(goal=goal)
    return parser


def _power(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--power", type=_share, default=0.8, help="chance to find it (default: 0.8)")


def _run(args: argparse.Namespace) -> int:
    if args.goal is not None:
        found, lines = args.goal(args)
    else:
        found, lines = _all(args.parser)
    print(json.dumps(found, indent=1) if args.json else "\n".join(lines))
    return 0


def _all(parser: argparse.ArgumentParser) -> Told:
    """Every goal that a formula answers, with its defaults."""
    found, lines = {}, []
    for name in ("mean", "difference", "correlation", "reliability", "fit"):
        chosen = parser.parse_args([name])
        found[name], more = chosen.goal(chosen)
        lines += [*more, ""]
    return found, [*lines, "survey plan factors draws samples for an exploratory analysis (some seconds)"]


def _mean(args: argparse.Namespace) -> Told:
    from survey.analysis.planning import mean_answers, mean_margin

    widest = (args.points - 1) / 2
    n, most = mean_answers(args.margin, args.sd), mean_answers(args.margin, max(widest, 1e-9))
    found = {"n": n, "margin": args.margin, "sd": args.sd, "n_at_widest": most, "widest_sd": widest}
    return found, [
        f"mean: {n} answers for ± {args.margin:g} points (95 %, Student's t) at a standard deviation of {args.sd:g}",
        f"  were opinions split between 1 and {args.points} (deviation {widest:g}): {most}",
        "  " + ", ".join(f"n = {k}: ± {mean_margin(args.sd, k):.2f}" for k in (10, 20, 50, 100, 200)),
        "  the margin falls with √n: half of it takes four times the answers",
    ]


def _difference(args: argparse.Namespace) -> Told:
    from survey.analysis.planning import difference_answers, difference_power

    alpha = 0.05 / args.items
    first, second = difference_answers(args.effect, args.power, alpha, args.ratio)
    found = {
        "n": [first, second],
        "effect": args.effect,
        "power": args.power,
        "alpha": alpha,
        "power_at_20": difference_power(args.effect, 20, 20, alpha),
    }
    lines = [
        f"difference: {first} and {second} answers find g = {args.effect:g} with power {args.power:g}"
        f" (two-sided t test, α = {alpha:.3g})"
    ]
    if args.items > 1:
        lines.append(
            f"  α is .05 over {args.items} items: the strictest step of Holm's, so power is this at least"
        )
    sizes = (20, 50, 100, 200)
    told = (f"{k} each: {difference_power(args.effect, k, k, alpha):.2f}" for k in sizes)
    return found, [
        *lines,
        "  power with " + ", ".join(told),
        "  .2 is called small, .5 middling, .8 large (Cohen)",
    ]


def _correlation(args: argparse.Namespace) -> Told:
    from survey.analysis.planning import correlation_answers, correlation_margin_answers

    n = correlation_answers(args.r, args.power)
    narrow = correlation_margin_answers(args.r, args.margin)
    found = {"n": n, "r": args.r, "power": args.power, "n_for_margin": narrow, "margin": args.margin}
    return found, [
        f"correlation: {n} answers find r = {args.r:g} with power {args.power:g} (two-sided, α = .05, Fisher's z)",
        f"  to know it to ± {args.margin:g} (95 %): {narrow}",
        "  at r = .1, .3, .5: " + ", ".join(str(correlation_answers(r, args.power)) for r in (0.1, 0.3, 0.5)),
    ]


def _reliability(args: argparse.Namespace) -> Told:
    from survey.analysis.planning import reliability_answers, reliability_width_answers

    n = reliability_answers(args.alpha, args.least, args.items, args.power)
    narrow = reliability_width_answers(args.alpha, args.width, args.items)
    found = {
        "n": n, "alpha": args.alpha, "least": args.least, "items": args.items, "power": args.power,
        "n_for_width": narrow, "width": args.width,
    }  # fmt: skip
    return found, [
        f"reliability: {n} answers show α = {args.alpha:g} of {args.items} items to exceed {args.least:g} with power"
        f" {args.power:g} (Bonett 2002)",
        f"  for a 95 % interval {args.width:g} wide: {narrow}",
    ]


def _fit(args: argparse.Namespace) -> Told:
    from survey.analysis.confirmatory import parsed
    from survey.analysis.planning import fit_answers, fit_power

    if args.model is not None and args.df is not None:
        args.parser.error("give --df or --model, not both")
    df = parsed(args.model).freedom() if args.model is not None else args.df or 24
    n = fit_answers(df, args.power, args.null, args.actual)
    found = {"n": n, "df": df, "null": args.null, "actual": args.actual, "power": args.power}
    told = (f"n = {k}: {fit_power(k, df, args.null, args.actual):.2f}" for k in (100, 200, 300, 500))
    return found, [
        f"fit: {n} answers tell RMSEA {args.actual:g} from {args.null:g} with power {args.power:g} at df = {df}"
        " (MacCallum, Browne and Sugawara 1996)",
        "  power with " + ", ".join(told),
        "  the more degrees of freedom, the fewer answers; ordered categories (dwls) want 200 at least",
    ]


def _factors(args: argparse.Namespace) -> Told:
    import numpy as np

    from survey.analysis.planning import factor_recovery
    from survey.demonstration import TABLE_3, correlation_of_ten

    root = np.linalg.cholesky(correlation_of_ten()).T

    def draw(n: int, rng: np.random.Generator):
        return np.clip(np.rint(3.4 + rng.normal(size=(n, len(root))) @ root), 1, 5)

    found = []
    with counted("samples", args.draws * len(args.n)) as step:
        for n in args.n:
            found.append(factor_recovery(TABLE_3, draw, n, draws=args.draws, seed=args.seed, progress=step))
    rows = [
        {
            "n": one.n, "used": one.used, "finds_three": one.found, "kmo": list(one.kmo),
            "loading_error": {"median": one.error[0], "upper": one.error[1]},
        }
        for one in found
    ]  # fmt: skip
    lines = [
        f"factors: {args.draws} samples of each size from the ten indicators' population (Table 3, five points)",
        f"{'n':>6}{'Kaiser finds 3':>16}{'KMO 5/50/95 %':>18}{'loadings off by (median, 95 %)':>34}",
    ]
    lines += [
        f"{one.n:6d}{one.found:16.2f}{'/'.join(f'{value:.2f}' for value in one.kmo):>18}"
        f"{f'{one.error[0]:.2f}, {one.error[1]:.2f}':>34}"
        for one in found
    ]
    lines.append("  off by: root mean square, after the sample's components are turned to the population's")
    lines.append("  weaker factors than these (loadings near .8) want more answers")
    return {"draws": args.draws, "seed": args.seed, "sizes": rows}, lines
