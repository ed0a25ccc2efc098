"""The analysis: time and error together, beside factor_analyzer in one interleaved run.

    survey bench --only analysis [-- --json FILE]

Error: KMO and χ² against each other, principal loadings against numpy's eigenvalues, varimax against the best of a
hundred starts.
Times are medians; `command` is a fresh process with everything that it imports.
"""

from __future__ import annotations

import argparse
import json
import statistics
import subprocess
import sys
import tempfile
import warnings
from collections.abc import Callable
from functools import partial
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
from signature import signed
from survey_exports import KEY, content, fill

from survey import read_questionnaire
from survey.analysis import Settings, adequacy, analyse, correlate, principal_components, varimax
from survey.analysis.components import adequacy_by_factor_analyzer, row_lengths, varimax_criterion
from survey.demonstration import ITEMS, drawn_sample, sample_file
from survey.scores import read_scores

ROOT = Path(__file__).resolve().parents[2]
STATIC = ("static_overall", "static_drape")
ROUNDS = 7
MANY = 100_000
ASKED = {
    "in_process_20x12_s": 2.0,
    "command_20x12_s": 6.0,
    "in_process_100000x25_s": 3.0,
    "command_100000x12_s": 5.0,
    "command_100000x25_s": 5.0,
}
ERRORS = {"kmo_apart": 1e-10, "chi2_apart": 1e-10, "principal_error_ours": 1e-10, "varimax_error_ours": 1e-6}


def interleaved(engines: dict[str, Callable[[], object]]) -> dict[str, float]:
    """Median seconds of each engine, rounds alternating between them."""
    times: dict[str, list[float]] = {name: [] for name in engines}
    for _ in range(ROUNDS):
        for name, run in engines.items():
            start = perf_counter()
            run()
            times[name].append(perf_counter() - start)
    return {name: statistics.median(found) for name, found in times.items()}


def quietly(run: Callable[[], Any]) -> Any:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # scikit-learn's notices of what factor_analyzer passes
        return run()


def theirs(table: np.ndarray, keep: int) -> dict[str, Any]:
    """The same steps by factor_analyzer."""
    from factor_analyzer import FactorAnalyzer, Rotator

    unturned: dict[str, Any] = {"rotation": None}  # its annotations know no None, which it takes

    def work() -> dict[str, Any]:
        fit: Any = FactorAnalyzer(n_factors=keep, method="principal", **unturned)
        fit.fit(table)
        turned = Rotator(method="varimax").fit_transform(fit.loadings_)
        found = adequacy_by_factor_analyzer(table)
        return {
            "eigenvalues": fit.get_eigenvalues()[0],
            "unrotated": fit.loadings_,
            "loadings": turned,
            "fit": found,
        }

    return quietly(work)


def ours(table: np.ndarray, keep: int) -> dict[str, Any]:
    from survey.analysis.components import adequacy_of

    r = correlate(table).r
    found = principal_components(r, keep=keep)
    return {
        "eigenvalues": found.eigenvalues, "unrotated": found.unrotated, "loadings": found.loadings,
        "fit": adequacy_of(r, len(table), [str(at) for at in range(len(r))]),
    }  # fmt: skip


def short_of_the_best(loadings: np.ndarray, unrotated: np.ndarray) -> float:
    """How far a solution's loadings are from those of a hundred starts; both with their columns in our order."""
    length = row_lengths(unrotated)
    best = varimax(unrotated, attempts=100)
    across = best.T @ loadings
    column = np.abs(across).argmax(axis=1)
    same = loadings[:, column] * np.sign(across[np.arange(len(column)), column])
    assert varimax_criterion(best / length) >= varimax_criterion(loadings / length) - 1e-12
    return float(np.abs(same - best).max())


def peer_rows() -> list[dict]:
    rows = []
    for n, p, keep in ((20, 10, 3), (200, 12, 3), (2000, 25, 5)):
        if p <= 12:
            table = drawn_sample(n, seed=n)[:, :p]
        else:
            rng = np.random.default_rng(n)
            common = rng.normal(size=(n, keep)) @ rng.normal(size=(keep, p))
            table = np.clip(np.rint(3 + 0.6 * common + rng.normal(size=(n, p))), 1, 5)
        mine, other = ours(table, keep), theirs(table, keep)
        times = interleaved(
            {"ours": lambda t=table, k=keep: ours(t, k), "peer": lambda t=table, k=keep: theirs(t, k)}
        )
        start = mine["unrotated"]
        exact = np.linalg.eigvalsh(np.corrcoef(table, rowvar=False))[::-1]
        rows.append({
            "n": n, "p": p, "keep": keep,
            "ours_ms": 1e3 * times["ours"], "factor_analyzer_ms": 1e3 * times["peer"],
            "kmo_apart": abs(mine["fit"].kmo - other["fit"].kmo),
            "chi2_apart": abs(mine["fit"].bartlett.chi2 / other["fit"].bartlett.chi2 - 1),
            "principal_error_ours": float(np.abs((start**2).sum(axis=0) - exact[:keep]).max()),
            "principal_error_factor_analyzer": float(
                np.abs((other["unrotated"] ** 2).sum(axis=0) - exact[:keep]).max()
            ),
            "varimax_error_ours": short_of_the_best(mine["loadings"], start),
            "varimax_error_factor_analyzer": short_of_the_best(other["loadings"], start),
        })  # fmt: skip
    return rows


def targets() -> dict[str, float]:
    """The figures that are asked for: seconds."""
    small = read_scores(sample_file("likert-20"))
    full = Settings(drop=STATIC, bootstrap=1000, draws=1000)
    analyse(small.scores, small.items, settings=full)  # imports
    rng = np.random.default_rng(0)
    large = np.clip(np.rint(3 + rng.normal(size=(MANY, 25)) + rng.normal(size=(MANY, 1))), 1, 5)
    command = [
        sys.executable, "-m", "survey.cli",
        "analyse", str(sample_file("likert-20")), "--drop", ",".join(STATIC), "--json",
    ]  # fmt: skip
    found = interleaved({
        "in_process_20x12_s": lambda: analyse(small.scores, small.items, settings=full),
        "command_20x12_s": lambda: subprocess.run(command, check=True, capture_output=True, cwd=ROOT),
        "in_process_100000x25_s": lambda: analyse(large, settings=Settings(draws=0)),
    })  # fmt: skip
    return found | stored_targets()


def stored_targets() -> dict[str, float]:
    """Seconds of the whole command with its defaults, resamples too, from stores of a hundred thousand answers."""
    with tempfile.TemporaryDirectory() as work:
        folder = content(Path(work))
        wanted = {f"command_{MANY}x12_s": "garment", f"command_{MANY}x25_s": KEY}
        runs: dict[str, Callable[[], object]] = {}
        for name, key in wanted.items():
            data = Path(work) / key
            fill(data, read_questionnaire(folder / "questionnaires" / f"{key}.toml"), MANY)
            command = [
                sys.executable, "-m", "survey.cli", "analyse", "--questionnaire", key, "--json",
                "--content", str(folder), "--data", str(data),
            ]  # fmt: skip
            runs[name] = partial(subprocess.run, command, check=True, capture_output=True, cwd=ROOT)
        return interleaved(runs)


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--json", type=Path, default=ROOT / "docs" / "figures" / "survey_analysis.json")
    args = parser.parse_args()
    adequacy(drawn_sample(50, 1)[:, :5], ITEMS[:5])  # imports factor_analyzer once
    found, rows = targets(), peer_rows()
    for name, seconds in found.items():
        print(f"{name:28}{seconds:8.3f} s")
    print(f"{'':14}{'ours':>10}{'f_analyzer':>12}{'KMO apart':>11}{'principal':>22}{'varimax':>22}")
    for row in rows:
        print(
            f"{row['n']:6d} × {row['p']:<5d}{row['ours_ms']:8.1f} ms{row['factor_analyzer_ms']:9.1f} ms"
            f"{row['kmo_apart']:11.1e}"
            f"{row['principal_error_ours']:11.1e}{row['principal_error_factor_analyzer']:11.1e}"
            f"{row['varimax_error_ours']:11.1e}{row['varimax_error_factor_analyzer']:11.1e}"
        )
    told = {"targets": found, "beside_factor_analyzer": rows}
    args.json.parent.mkdir(parents=True, exist_ok=True)
    args.json.write_text(json.dumps(signed(told), indent=1) + "\n", "utf-8")
    bad = failed(found, rows)
    for problem in bad:
        print(f"survey bench: {problem}", file=sys.stderr)
    return 1 if bad else 0


def failed(found: dict[str, float], rows: list[dict]) -> list[str]:
    """What misses the figures asked for."""
    bad = [f"{name}: {found[name]:.2f} s, not {most}" for name, most in ASKED.items() if found[name] > most]
    for row in rows:
        for key, most in ERRORS.items():
            if row[key] > most:
                bad.append(f"{row['n']} × {row['p']}: {key} {row[key]:.1e}, not {most}")
    return bad


if __name__ == "__main__":
    sys.exit(main())
