"""Our statistics beside R's psych on six data sets, in one run: differences and times.

    apt-get install r-cran-psych r-cran-gparotation r-cran-jsonlite
    survey bench --only r [-- --record] [--json FILE]

--record writes what R says to tests/survey/recorded/psych.json, which the tests read where there is no R. psych's bfi
(2436 complete answers, Revelle 2010) and R's attitude (Chatterjee and Price 1977) come with R; only their covariance
matrices are recorded, the answers stay where they are.

The five scales of bfi are measured through the command as well, on the whole file with its gaps, gender, education and
age. ω is compared with its own like: ours is the model's, (Σλs)² over (Σλs)² + Σψs² of one maximum-likelihood factor,
which R's factanal gives to 1e-6. psych's omega(nfactors = 1) has another, 1 − Σψ over the sum of all correlations: that
is made from our factor too and compared with psych's at fm = "ml". What psych prints unless told otherwise is minres,
another fit: how far it lies from ours is printed, and nothing is asked of it.
"""

from __future__ import annotations

import argparse
import contextlib
import csv
import io
import json
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from time import perf_counter

import numpy as np
from signature import signed

from survey.analysis import (
    adequacy_of,
    correlate,
    minimum_average_partial,
    omega_of,
    polychoric,
    principal_components,
    reliability_of,
)
from survey.analysis.components import eigenvalues
from survey.analysis.consistency import one_factor
from survey.cli import main as survey_command
from survey.demonstration import ITEMS, drawn_sample, sample_file
from survey.scores import read_scores

ROOT = Path(__file__).resolve().parents[2]
HERE = Path(__file__).parent
RECORDED = HERE.parent / "survey" / "recorded" / "psych.json"
# χ² relative to its size; rotations against GPArotation, which goes to the end where psych stops early.
LIMITS = dict.fromkeys(
    ("r", "probability", "kmo", "kmo_per_item", "chi2", "eigenvalues", "alpha", "map"), 1e-10
)
LIMITS |= {"varimax": 1e-6, "oblimin": 1e-6, "omega": 1e-6, "polychoric": 5e-5}
SCALE_LIMITS = dict.fromkeys(("alpha", "standardised", "if_deleted", "item_total"), 1e-10)
SCALE_LIMITS |= {"omega": 1e-6, "omega_total_ml": 1e-6}
NOT_ITEMS = ["gender", "education", "age"]
# Below, psych's ρ are not those of greatest likelihood (a test shows it), so nothing is asked of the difference.
POLYCHORIC_FROM = 100  # answers


def data_sets() -> dict[str, np.ndarray]:
    """Ours; R adds its own two."""
    return {
        "exact-20x10": read_scores(sample_file("exact-20")).scores[:, :10],
        "likert-20x12": read_scores(sample_file("likert-20")).scores,
        "likert-200x12": drawn_sample(200, seed=200),
        "likert-1000x8": drawn_sample(1000, seed=1000)[:, :8],
    }


def there() -> bool:
    """Whether R has what it needs."""
    if shutil.which("Rscript") is None:
        return False
    asked = "library(psych); library(GPArotation); library(jsonlite)"
    return subprocess.run(["Rscript", "-e", asked], capture_output=True, check=False).returncode == 0


def ask_r() -> tuple[dict, dict, float]:
    """What R says, what our command says of the whole bfi, and how long R took."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for key, table in data_sets().items():
            with (folder / f"{key}.csv").open("w", newline="") as file:
                writer = csv.writer(file)
                writer.writerow(ITEMS[: table.shape[1]])
                writer.writerows([[f"{value:.17g}" for value in row] for row in table.tolist()])
        start = perf_counter()
        subprocess.run(
            ["Rscript", str(HERE / "survey_psych.R"), name, f"{name}/out.json"],
            check=True,
            stderr=subprocess.DEVNULL,
        )
        seconds = perf_counter() - start
        made = json.loads((folder / "out.json").read_text("utf-8"))
        reverse = [item for told in made["bfi_scales"].values() for item in told["reversed"]]
        return made, analysed(folder / "bfi-whole.csv", ",".join(reverse)), seconds


def analysed(path: Path, reverse: str) -> dict:
    """`survey analyse` of bfi as it comes: five components, the reverse-keyed items turned."""
    out = io.StringIO()
    arguments = ["--factors", "5", "--reverse", reverse, "--points", "6", "--bootstrap", "0", "--json"]
    with contextlib.redirect_stdout(out):
        if survey_command(["analyse", str(path), *arguments]) != 0:
            raise RuntimeError("survey analyse failed on psych's bfi – see the line above")
    return json.loads(out.getvalue())


def scale_differences(made: dict, whole: dict) -> dict[str, dict[str, float]]:
    """Scale → largest absolute difference of each figure between psych and our command on the real bfi."""
    mine = {frozenset(scale["items"]): scale for scale in whole["scales"]}
    covariance, names = np.array(made["data_sets"]["psych-bfi"]["covariance"]), whole["items"]
    rows = {}
    for name, told in made["bfi_scales"].items():
        scale = mine[frozenset(told["items"])]
        items, at = told["items"], [names.index(item) for item in told["items"]]
        sign = np.where(np.isin(items, told["reversed"]), -1.0, 1.0)
        part = covariance[np.ix_(at, at)] * np.outer(sign, sign)
        r = part / np.sqrt(np.outer(np.diag(part), np.diag(part)))
        total = 1.0 - one_factor(r)[1].sum() / r.sum()
        rows[name] = {
            "alpha": abs(scale["alpha"] - told["alpha"]),
            "standardised": abs(scale["alpha_standardised"] - told["standardised"]),
            "if_deleted": largest(scale["alpha_if_deleted"], items, told["if_deleted"]),
            "item_total": largest(scale["item_total"], items, told["item_total"]),
            "omega": abs(scale["omega"] - told["omega"]),
            "omega_total_ml": abs(total - told["omega_total_ml"]),
            "omega_minres": abs(scale["omega"] - told["omega_total_minres"]),
        }  # fmt: skip
    return rows


def ours(told: dict, table: np.ndarray | None) -> dict[str, np.ndarray]:
    """The same figures from the scores where we have them, else from R's covariances."""
    covariance = np.array(told["covariance"])
    spread = np.sqrt(np.diag(covariance))
    n, names = told["n"], told["names"]
    found = {}
    if table is not None:
        pearson = correlate(table)
        r, covariance = pearson.r, np.cov(table, rowvar=False)
        found |= {"r": r, "probability": pearson.p}
    else:
        r = covariance / np.outer(spread, spread)
        np.fill_diagonal(r, 1.0)
    fit, reliable = adequacy_of(r, n, names), reliability_of(covariance, names)
    keep = len(told["unrotated"][0])
    average = minimum_average_partial(r).squared
    found |= {
        "kmo": fit.kmo, "kmo_per_item": fit.kmo_per_item, "chi2": fit.bartlett.chi2, "eigenvalues": eigenvalues(r),
        "alpha": reliable.alpha, "alpha_standardised": reliable.standardised, "alpha_if_deleted": reliable.if_deleted,
        "map": np.array(average[1 : len(told["map"]) + 1]), "omega": omega_of(r, spread, n, names).omega,
        "varimax": principal_components(r, keep=keep).loadings,
        "oblimin": principal_components(r, keep=keep, rotation="oblimin").loadings,
    }  # fmt: skip
    if table is not None and told["polychoric"]:
        found["polychoric"] = polychoric(table).r
    return found


def differences(told: dict, found: dict[str, np.ndarray]) -> dict[str, float]:
    """Largest absolute difference of each figure; χ² relative to its size."""
    apart = {}
    for key, value in found.items():
        theirs = told[key]["loadings"] if key == "oblimin" else told[key]
        mine, other = np.asarray(value, dtype=float), np.asarray(theirs, dtype=float)
        if key in ("varimax", "oblimin"):
            other = matched(other, mine)
        if key == "map":
            other = other[: len(mine)]
        scale = abs(told["chi2"]) if key == "chi2" else 1.0
        apart[key] = float(np.abs(mine - other).max() / scale)
    apart["varimax_of_psych"] = float(
        np.abs(matched(np.array(told["varimax_psych"]), found["varimax"]) - found["varimax"]).max()
    )
    return apart


def matched(other: np.ndarray, mine: np.ndarray) -> np.ndarray:
    """The other's columns in our order and with our signs."""
    across = mine.T @ other
    column = np.abs(across).argmax(axis=1)
    return other[:, column] * np.sign(across[np.arange(len(column)), column])


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--record", action="store_true")
    parser.add_argument("--json", type=Path, default=ROOT / "docs" / "figures" / "survey_r.json")
    args = parser.parse_args()
    if not there():
        print(
            "left out: no Rscript with psych – apt-get install r-cran-psych r-cran-gparotation r-cran-jsonlite"
        )
        return 0
    made, whole, seconds = ask_r()
    tables = data_sets()
    rows = {}
    start = perf_counter()
    for name, told in made["data_sets"].items():
        rows[name] = {"n": told["n"], "p": told["p"]} | differences(told, ours(told, tables.get(name)))
    mine = perf_counter() - start
    keys = [
        "r",
        "kmo",
        "chi2",
        "eigenvalues",
        "alpha",
        "map",
        "omega",
        "varimax",
        "varimax_of_psych",
        "oblimin",
        "polychoric",
    ]
    print(f"{'largest difference':20}" + "".join(f"{key[:11]:>12}" for key in keys))
    for name, row in rows.items():
        print(f"{name:20}" + "".join(f"{row[key]:12.1e}" if key in row else f"{'–':>12}" for key in keys))
    scales = scale_differences(made, whole)
    print_scales(made, whole, scales)
    print(f"{made['R']}, psych {made['psych']}: {seconds:.1f} s; ours {mine:.2f} s")
    if args.record:
        RECORDED.parent.mkdir(parents=True, exist_ok=True)
        RECORDED.write_text(json.dumps(made, indent=None), "utf-8")
    told = {key: made[key] for key in ("R", "psych", "GPArotation")}
    told |= {"r_seconds": seconds, "our_seconds": mine, "differences": rows, "scales": scales}
    args.json.parent.mkdir(parents=True, exist_ok=True)
    args.json.write_text(json.dumps(signed(told), indent=1) + "\n", "utf-8")
    bad = [*failed(rows), *failed_scales(whole, scales)]
    for problem in bad:
        print(f"survey bench: {problem}", file=sys.stderr)
    return 1 if bad else 0


def largest(mine: dict[str, float], items: list[str], theirs: list[float]) -> float:
    """Largest difference of a figure that each item has."""
    return max(abs(mine[item] - value) for item, value in zip(items, theirs, strict=True))


def print_scales(made: dict, whole: dict, scales: dict[str, dict[str, float]]) -> None:
    """psych's figures and how far ours are, scale by scale."""
    print(
        f"{'bfi, survey analyse':20}{'n':>6}{'α':>7}{'ω':>7}"
        + "".join(f"{key[-14:]:>15}" for key in scales["A"])
    )
    mine = {frozenset(scale["items"]): scale for scale in whole["scales"]}
    for name, told in made["bfi_scales"].items():
        scale = mine[frozenset(told["items"])]
        apart = "".join(f"{value:15.1e}" for value in scales[name].values())
        print(f"{name:20}{scale['n']:6}{scale['alpha']:7.3f}{scale['omega']:7.3f}{apart}")


def failed_scales(whole: dict, scales: dict[str, dict[str, float]]) -> list[str]:
    """Scales that are farther apart than asked for, and columns taken for items that are none."""
    bad = [
        f"bfi {name}: {key} {row[key]:.1e} apart"
        for name, row in scales.items()
        for key, most in SCALE_LIMITS.items()
        if row[key] > most
    ]
    left = [item for note in whole["warnings"] if note["code"] == "no_item" for item in note["items"]]
    return bad if left == NOT_ITEMS else [*bad, f"bfi: left out as no items: {left}, not {NOT_ITEMS}"]


def failed(rows: dict[str, dict[str, float]]) -> list[str]:
    """What is farther apart than asked for."""
    return [
        f"{name}: {key} {row[key]:.1e} apart"
        for name, row in rows.items()
        for key, most in LIMITS.items()
        if row.get(key, 0.0) > most and not (key == "polychoric" and row["n"] < POLYCHORIC_FROM)
    ]


if __name__ == "__main__":
    sys.exit(main())
