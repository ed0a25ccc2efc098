"""What R's lavaan says, recorded by tests/bench/bench_survey_lavaan.py, and how ours is set beside it."""

from __future__ import annotations

import csv
import json
import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np

__all__ = ["LIMIT", "RECORDED", "apart", "recorded", "rows_with", "same_sums", "write_rows"]

RECORDED = Path(__file__).parent / "recorded" / "lavaan.json"
LIMIT = 1e-4
FIT = {
    "chisq": "chi2", "df": "df", "pvalue": "p", "cfi": "cfi", "tli": "tli", "srmr": "srmr", "rmsea": "estimate",
    "rmsea.ci.lower": "low", "rmsea.ci.upper": "high", "rmsea.pvalue": "p_close",
}  # fmt: skip


def apart(told: dict, ours: dict) -> dict[str, float]:
    """Largest difference of each kind of figure between lavaan's record of a fit and `survey confirm --json`."""
    found = {"fit": _fit(told["fit"], ours["fit"], ""), **_estimates(told["estimates"], ours["parameters"])}
    found |= _standardised(told["standardised"], ours["parameters"])
    if "robust" in told:
        found["robust"] = _fit(told["robust"], ours["robust"], ".scaled")
        found["scaling"] = abs(told["robust"]["chisq.scaling.factor"] - ours["robust"]["scaling_factor"])
        found["shift"] = abs(told["shift"] - ours["robust"]["shift"])
    if "hints" in told and ours["estimator"] == "ml":
        found["hints"] = _hints(told["hints"], ours["hints"])
    return found


def _fit(theirs: dict, ours: dict, suffix: str) -> float:
    flat = {**ours, **ours["rmsea"]}
    most = max(
        abs(theirs[key + suffix] - flat[mine])
        for key, mine in FIT.items()
        if theirs.get(key + suffix) is not None
    )
    base = theirs.get(f"baseline.chisq{suffix}")
    return most if base is None else max(most, abs(base - ours["baseline"]["chi2"]))


def _key(one: dict, sides: tuple[str, str]) -> tuple:
    left, right = one[sides[0]], one[sides[1]]
    return (one["op"], *sorted((left, right))) if one["op"] == "~~" else (one["op"], left, right)


def _estimates(theirs: Sequence[dict], ours: Sequence[dict]) -> dict[str, float]:
    mine = {_key(one, ("left", "right")): one for one in ours}
    estimates, errors, met = [0.0], [0.0], 0
    for one in theirs:
        if one["op"] == "~*~" or (one["op"] == "~1" and not one.get("se")):
            continue  # scales and the factors' means, which are fixed
        own = mine[_key(one, ("lhs", "rhs"))]
        met += 1
        estimates.append(abs(one["est"] - own["estimate"]))
        if one.get("se"):
            errors.append(abs(one["se"] - own["se"]))
        else:
            assert own["se"] is None
    assert met == len(mine)
    return {"estimates": max(estimates), "errors": max(errors)}


def _standardised(theirs: Sequence[dict], ours: Sequence[dict]) -> dict[str, float]:
    mine = {_key(one, ("left", "right")): one["standardised"] for one in ours if one["standardised"]}
    theirs = [one for one in theirs if _key(one, ("lhs", "rhs")) in mine]
    assert len(theirs) == len(mine)
    values, errors = [0.0], [0.0]
    for one in theirs:
        own = mine[_key(one, ("lhs", "rhs"))]
        values.append(abs(one["est.std"] - own["estimate"]))
        if one.get("se") and own["se"] is not None:
            errors.append(abs(one["se"] - own["se"]))
    return {"standardised": max(values), "standardised_errors": max(errors)}


def _hints(theirs: Sequence[dict], ours: Sequence[dict]) -> float:
    mine = {_key(one, ("left", "right")): one for one in ours}
    return max(
        max(abs(one["mi"] - own["chi2_less"]), abs(one["epc"] - own["would_be"]))
        for one in theirs
        for own in [mine[_key(one, ("lhs", "rhs"))]]
    )


def rows_with(mean: np.ndarray, covariance: np.ndarray, n: int, seed: int) -> np.ndarray:
    """n rows that nobody gave, with this mean and covariance (divisor n) to rounding."""
    draw = np.random.default_rng(seed).normal(size=(n, len(mean)))
    draw -= draw.mean(axis=0)
    white = np.linalg.svd(draw, full_matrices=False)[0] * math.sqrt(n)
    return mean + white @ np.linalg.cholesky(covariance).T


def same_sums(parts: Sequence[dict], items: Sequence[str]) -> np.ndarray:
    """A table with the counts, means and covariances of each pattern of gaps, and so with the same likelihood."""
    blocks = []
    for seed, part in enumerate(parts):
        block = np.full((part["n"], len(items)), np.nan)
        at = [list(items).index(item) for item in part["items"]]
        block[:, at] = rows_with(np.array(part["mean"]), np.array(part["covariance"]), part["n"], seed)
        blocks.append(block)
    return np.concatenate(blocks)


def write_rows(path: Path, items: Sequence[str], table: np.ndarray) -> Path:
    """As a CSV file with every digit."""
    with path.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(items)
        writer.writerows(["" if math.isnan(x) else f"{x:.17g}" for x in row] for row in table.tolist())
    return path


def recorded() -> dict:
    return json.loads(RECORDED.read_text("utf-8"))
