"""Weaving: time and error together. The references are closed forms, and a dense solver for weaves without one.

    python tests/bench/bench_weave.py [--quick] [--json FILE] [--plot FILE.png] [--sheet FILE.png] [--large]
                                      [--peers [FOLDER]]

Plain weave: heights and crossing forces have closed forms (small slope). Twill and satin: the same contact problem is
solved in dense matrices by scipy's non-negative least squares, to 1e-12, interleaved with ours. Stage B, maps,
fuzz, densities and TexGen (optional: --peers makes an environment of its own) are in weave_particles.py.
"""

import argparse
import json
import statistics
import sys
from functools import partial
from pathlib import Path
from time import perf_counter

import numpy as np
import weave_particles
import weave_sheet
import weave_silk
from peers import add_peers
from scipy.optimize import nnls
from signature import signed

from sim_core.weave import Weave, Yarn, plain, relax, satin, twill
from sim_core.weave.draft import Draft
from sim_core.weave.yarns import beam_stiffness

D = 1e-4
ROUNDS = 5


def cloth(draft: Draft, ends: float = 3.0, picks: float = 5.0, ratio: float = 2.0) -> Weave:
    warp = Yarn(D, 5e-6, stiffness=1e-9 * ratio)
    return Weave(draft.name, draft, warp, Yarn(D, 5e-6, stiffness=1e-9), 1 / (ends * D), 1 / (picks * D))


def closed_form(weave: Weave) -> tuple[float, float, float]:
    """h1, h2 [m] and the crossing force [N] of a plain weave: h1 / h2 = (EI2 / EI1) (p2 / p1)^3, V = 24 EI h / p^3."""
    ratio = weave.weft.stiffness / weave.warp.stiffness * (weave.pick_spacing / weave.end_spacing) ** 3
    h1 = 2 * D * ratio / (1 + ratio)
    return h1, 2 * D - h1, 24 * weave.warp.stiffness * h1 / weave.pick_spacing**3


def dense(weave: Weave) -> np.ndarray:
    """Crossing forces by non-negative least squares on the dual problem, with dense matrices."""
    picks, ends = weave.draft.lift.shape
    sign = np.where(weave.draft.lift, 1.0, -1.0).ravel()
    warp = _flexibility(beam_stiffness(picks, weave.pick_spacing, weave.warp.stiffness, 0))
    weft = _flexibility(beam_stiffness(ends, weave.end_spacing, weave.weft.stiffness, 0))
    answer = np.kron(warp, np.eye(ends)) + np.kron(np.eye(picks), weft)
    unit = np.abs(answer).max()
    # min 1/2 f A f - D s f, f >= 0, net force of each end and pick = 0 as a heavy penalty row
    root = np.linalg.cholesky(sign[:, None] * answer / unit * sign + 1e-13 * np.eye(sign.size)).T
    goal = np.linalg.solve(root.T, np.ones(sign.size))
    balance = np.vstack([np.kron(np.ones(picks), np.eye(ends)), np.kron(np.eye(picks), np.ones(ends))]) * sign
    force, _ = nnls(
        np.vstack([root, 1e4 * balance]), np.append(goal, np.zeros(picks + ends)), maxiter=100_000
    )
    return force.reshape(picks, ends) * D / unit


def _flexibility(stiffness: np.ndarray) -> np.ndarray:
    inverse = np.where(stiffness > 0, 1 / np.where(stiffness > 0, stiffness, 1), 0)
    first = np.fft.ifft(inverse).real
    return np.array([np.roll(first, k) for k in range(first.size)])


def median_time(*runs):
    times: list[list[float]] = [[] for _ in runs]
    results: list = [None for _ in runs]
    for _ in range(ROUNDS):
        for k, run in enumerate(runs):
            begin = perf_counter()
            results[k] = run()
            times[k].append(perf_counter() - begin)
    return [statistics.median(t) for t in times], results


def closed_rows() -> list[dict]:
    rows = []
    for ends, picks, ratio in ((8, 8, 1), (4, 4, 1), (2, 2, 1), (4, 4, 4), (4, 4, 8), (6, 4, 1), (3, 4, 1)):
        weave = cloth(plain(), ends, picks, ratio)
        (seconds,), (geometry,) = median_time(partial(relax, weave))
        wanted = closed_form(weave)
        h1, h2 = geometry.crest_to_trough()
        error = max(
            abs(h1 / wanted[0] - 1), abs(h2 / wanted[1] - 1), abs(geometry.force.max() / wanted[2] - 1)
        )
        rows.append({"case": f"plain p {ends}/{picks} EI {ratio}", "seconds": seconds, "error": error})
    return rows


def dense_rows(drafts) -> list[dict]:
    rows = []
    for draft in drafts:
        weave = cloth(draft)
        (own, other), (geometry, force) = median_time(partial(relax, weave), partial(dense, weave))
        error = float(np.abs(geometry.force - force).max() / force.max())
        rows.append({"case": draft.name, "seconds": own, "dense_seconds": other, "error": error})
        rows[-1] |= {"residual": geometry.residual, "complementarity": geometry.complementarity}
    return rows


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--quick", action="store_true", help="small repeats and maps")
    parser.add_argument("--json", type=Path, help="write the figures as JSON")
    parser.add_argument("--plot", type=Path, help="draw speed against error (PNG)")
    parser.add_argument(
        "--sheet", type=Path, help="draw the contact sheet of all weaves (PNG) and nothing else"
    )
    parser.add_argument("--silk", action="store_true", help="how the shipped silks look, and nothing else")
    parser.add_argument("--large", action="store_true", help="also 400 x 400 by stage B, minutes")
    add_peers(parser, "also TexGen")
    args = parser.parse_args()
    if args.sheet:
        weave_sheet.draw(args.sheet)
        return 0
    if args.silk:
        weave_silk.show(weave_silk.measure())
        return 0
    particles = weave_particles.measure(quick=args.quick, large=args.large, peers=args.peers)
    drafts = [twill(2, 2), twill(3, 1), satin(5, 2), satin(8, 3)] + ([] if args.quick else [satin(16, 7)])
    closed, dense_results = closed_rows(), dense_rows(drafts)
    print(f"{'against closed forms':<24}{'ms':>9}{'error':>10}")
    for row in closed:
        print(f"{row['case']:<24}{row['seconds'] * 1e3:>9.2f}{row['error']:>10.1e}")
    print(
        f"\n{'against dense NNLS':<24}{'ms':>9}{'dense ms':>10}{'error':>10}{'net force':>11}{'compl.':>10}"
    )
    for row in dense_results:
        print(
            f"{row['case']:<24}{row['seconds'] * 1e3:>9.2f}{row['dense_seconds'] * 1e3:>10.2f}{row['error']:>10.1e}"
            f"{row['residual']:>11.1e}{row['complementarity']:>10.1e}"
        )
    weave_particles.show(particles)
    silk = weave_silk.measure()
    weave_silk.show(silk)
    if args.plot:
        weave_sheet.plot(particles, args.plot)
    if args.json:
        rows = signed({"closed": closed, "dense": dense_results, **particles, **silk})
        args.json.write_text(json.dumps(rows, indent=2) + "\n", "utf-8")
    sound = all(row["error"] < 1e-5 for row in closed)
    return 0 if sound else 1


if __name__ == "__main__":
    sys.exit(main())
