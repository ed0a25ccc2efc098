"""How the samples in samples/ were made, from seeds: python -m survey.demonstration.recipe FOLDER makes them anew.

The files are the samples; the recipe tells where they come from. Made anew on any machine the drawn ones are the files,
`exact-20` is its file to 1e-12, and `likert-20` is as good a table but need not be the same one: each of annealing's
300 000 decisions looks at the last bits. The population is data as well, for Table 3 leaves it open
(`solved_population`).
"""

from __future__ import annotations

import csv
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from survey.demonstration.indicators import primary, sample_name
from survey.demonstration.opinions import primary_sample
from survey.demonstration.table3 import (
    CHI2,
    CLOSE,
    KMO,
    LOG_DET,
    TABLE_3,
    TABLE_3_ITEMS,
    N,
    correlation_of_twelve,
    deviations,
    kmo_of,
)

__all__ = [
    "ITEMS",
    "annealed_sample",
    "drawn_sample",
    "exact_sample",
    "gappy",
    "solved_population",
    "write_samples",
]

ITEMS = (*TABLE_3_ITEMS, *(item for item, _, _ in CLOSE))
SEED = 2
STEPS = 300_000
HOT, COLD = 3e-3, 1e-7


def solved_population(seed: int = 7) -> NDArray[np.float64]:
    """A correlation matrix (10, 10) with Table 3's space and the printed KMO and χ²: how population.csv was found.

    R = ΛΛᵀ + Q L Lᵀ Qᵀ with Q a basis of Λ's orthogonal complement and L lower triangular (28 numbers), solved
    for a unit diagonal, KMO and determinant from a seeded start. Which of the family it ends at is up to the seed and
    the machine; that it is one of them is not. Raises ArithmeticError where it is none.
    """
    p = len(TABLE_3)
    basis = np.linalg.svd(TABLE_3)[0][:, 3:]
    lower = np.tril_indices(p - 3)

    def matrix(numbers: NDArray[np.float64]) -> NDArray[np.float64]:
        root = np.zeros((p - 3, p - 3))
        root[lower] = numbers
        return TABLE_3 @ TABLE_3.T + basis @ root @ root.T @ basis.T

    def misfit(numbers: NDArray[np.float64]) -> list[float]:
        r = matrix(numbers)
        return [*(np.diag(r) - 1.0), kmo_of(r) - KMO, np.linalg.slogdet(r)[1] - LOG_DET]

    start = np.random.default_rng(seed).normal(scale=0.3, size=len(lower[0]))
    start[lower[0] == lower[1]] = 0.45
    found = least_squares(misfit, start, xtol=1e-15, ftol=1e-15, gtol=1e-15, max_nfev=4000)
    if found.cost > 1e-20:
        raise ArithmeticError(f"no such correlation matrix: residual {found.cost:.3g}")
    r = matrix(found.x)
    np.fill_diagonal(r, 1.0)
    return r


def exact_sample() -> NDArray[np.float64]:
    """(20, 12) with mean 3, the correlations of twelve and the printed α; its scores are no whole numbers."""
    r = correlation_of_twelve()
    return 3.0 + with_moments(r, N, seed=11) * deviations()


def with_moments(r: NDArray[np.float64], n: int, seed: int) -> NDArray[np.float64]:
    """n rows whose mean is 0 and whose correlation matrix is r, to rounding."""
    draw = np.random.default_rng(seed).normal(size=(n, len(r)))
    draw -= draw.mean(axis=0)
    white = np.linalg.svd(draw, full_matrices=False)[0] * np.sqrt(n - 1)
    return white @ np.linalg.cholesky(r).T


def drawn_sample(n: int, seed: int) -> NDArray[np.float64]:
    """(n, 12) whole scores 1–5 of people drawn from the population of the twelve."""
    return np.clip(np.rint(drawn_opinions(n, seed)), 1, 5)


def drawn_opinions(n: int, seed: int) -> NDArray[np.float64]:
    """(n, 12) what they think, before it is made a whole score."""
    draw = np.random.default_rng(seed).normal(size=(n, len(ITEMS)))
    return 3.4 + draw @ np.linalg.cholesky(correlation_of_twelve()).T


def gappy(table: NDArray[np.float64], share: float, seed: int) -> NDArray[np.float64]:
    """The table with a share of its scores missing (NaN) at random."""
    return np.where(np.random.default_rng(seed).random(table.shape) < share, np.nan, table)


def annealed_sample() -> NDArray[np.float64]:
    """(20, 12) whole scores 1–5 whose correlations are as near to the twelve's as annealing gets them.

    One score changes by one at a time; a worse table is kept with the probability of Metropolis, less and less.
    """
    rng = np.random.default_rng(SEED)
    target = correlation_of_twelve()
    # The spread is as wide as five points allow, so that there are many tables to choose from.
    table = np.clip(np.rint(3.0 + 1.25 * with_moments(target, N, SEED)), 1, 5)
    unit = np.array([_unit(column) for column in table.T])
    misfit = _misfit(unit, target)
    best, least = table.copy(), misfit
    for number in range(STEPS):
        heat = HOT * (COLD / HOT) ** (number / STEPS)
        row, item = rng.integers(N), rng.integers(len(ITEMS))
        score = table[row, item] + rng.choice((-1.0, 1.0))
        if not 1 <= score <= 5:
            continue
        column, kept = table[:, item].copy(), unit[item].copy()
        column[row] = score
        unit[item] = _unit(column)
        after = _misfit(unit, target)
        if after < misfit or rng.random() < np.exp((misfit - after) / heat):
            table[row, item], misfit = score, after
            if misfit < least:
                best, least = table.copy(), misfit
        else:
            unit[item] = kept
    return best


def _unit(column: NDArray[np.float64]) -> NDArray[np.float64]:
    centred = column - column.mean()
    return centred / max(float(np.sqrt(centred @ centred)), 1e-9)


def _misfit(unit: NDArray[np.float64], target: NDArray[np.float64]) -> float:
    """Mean squared difference of the correlations, and what KMO, χ² and the two close pairs lack."""
    r = unit @ unit.T
    p = len(TABLE_3_ITEMS)
    sign, log_det = np.linalg.slogdet(r[:p, :p])
    if sign <= 0 or log_det < -30:
        return 10.0
    chi2 = -(N - 1 - (2 * p + 5) / 6) * float(log_det)
    short = sum(
        max(0.0, 0.9305 - float(r[p + at, TABLE_3_ITEMS.index(twin)]))
        for at, (_, twin, _) in enumerate(CLOSE)
    )
    apart = 3.0 * ((r - target) ** 2).mean() + 0.5 * (chi2 / CHI2 - 1.0) ** 2 + (kmo_of(r[:p, :p]) - KMO) ** 2
    return float(apart) + short


def write_samples(folder: Path) -> list[Path]:
    """Write every sample as CSV; returns the files."""
    drawn = drawn_sample(200, seed=200)
    tables = {
        "exact-20": exact_sample(),
        "likert-20": annealed_sample(),
        "likert-200": drawn,
        "likert-200-gaps": gappy(drawn, 0.05, seed=5),
    }
    written = [_write(folder / f"{name}.csv", table, ITEMS) for name, table in tables.items()]
    names = [one.id for one in primary()]
    return [*written, _write(folder / f"{sample_name()}.csv", primary_sample(), names)]


def _write(path: Path, table: NDArray[np.float64], names: Sequence[str]) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", encoding="utf-8-sig", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["submission", *names])
        for number, row in enumerate(table, 1):
            cells = ["" if np.isnan(score) else f"{float(score):.17g}" for score in row]
            writer.writerow([f"synthetic-{number}", *cells])
    return path


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("python -m survey.demonstration.recipe FOLDER: name the folder for the samples made anew")
    write_samples(Path(sys.argv[1]))
