"""Synthetic samples for the statistics, and submissions for the doors. Nothing here was answered by a person."""

from __future__ import annotations

import copy
import uuid
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq, least_squares
from sqlalchemy import create_engine, text

ASSETS = Path(__file__).parents[2] / "assets"

# Table 3 of the paper, rows and columns in its order.
TABLE_3_ITEMS = (
    "fabric_texture", "fabric_colour", "fabric_lustre", "thickness_texture", "silhouette",
    "detail_structure", "pleat", "perspective", "dynamic_drape", "dynamic_swing",
)  # fmt: skip
TABLE_3 = np.array([
    [.937, .121, .025], [.918, .229, .239], [.854, .371, -.018], [.872, .144, .304], [.197, .813, .293],
    [.274, .852, .069], [.396, .859, .177], [.243, .764, .404], [.236, .112, .891], [.059, .301, .817],
])  # fmt: skip
N, KMO, CHI2, ALPHA = 20, 0.824, 167.23, 0.911


def kmo_of(r: NDArray[np.float64]) -> float:
    """Overall KMO of a correlation matrix, written here once more so that the sample owes nothing to the product."""
    inverse = np.linalg.inv(r)
    partial = inverse / np.sqrt(np.outer(np.diag(inverse), np.diag(inverse)))
    off = ~np.eye(len(r), dtype=bool)
    return float((r[off] ** 2).sum() / ((r[off] ** 2).sum() + (partial[off] ** 2).sum()))


@lru_cache(maxsize=1)
def table_3_correlation() -> NDArray[np.float64]:
    """R (10, 10) with Table 3's loadings as its first three components' space, and the printed KMO and χ².

    R = ΛΛᵀ + Q L Lᵀ Qᵀ with Q a basis of Λ's orthogonal complement and L lower triangular (28 numbers), solved
    for a unit diagonal, KMO and determinant from a seeded start.
    """
    p = len(TABLE_3)
    basis = np.linalg.svd(TABLE_3)[0][:, 3:]
    lower = np.tril_indices(p - 3)
    log_det = -CHI2 / (N - 1 - (2 * p + 5) / 6)

    def matrix(numbers):
        root = np.zeros((p - 3, p - 3))
        root[lower] = numbers
        return TABLE_3 @ TABLE_3.T + basis @ root @ root.T @ basis.T

    def misfit(numbers):
        r = matrix(numbers)
        return [*(np.diag(r) - 1.0), kmo_of(r) - KMO, np.linalg.slogdet(r)[1] - log_det]

    start = np.random.default_rng(7).normal(scale=0.3, size=len(lower[0]))
    start[lower[0] == lower[1]] = 0.45
    found = least_squares(misfit, start, xtol=1e-15, ftol=1e-15, gtol=1e-15, max_nfev=4000)
    assert found.cost < 1e-20
    r = matrix(found.x)
    np.fill_diagonal(r, 1.0)
    return r


def exact_sample(r: NDArray[np.float64], n: int, seed: int) -> NDArray[np.float64]:
    """n rows whose mean is 0 and whose correlation matrix is r, to rounding."""
    draw = np.random.default_rng(seed).normal(size=(n, len(r)))
    draw -= draw.mean(axis=0)
    white = np.linalg.svd(draw, full_matrices=False)[0] * np.sqrt(n - 1)
    return white @ np.linalg.cholesky(r).T


def paper_sample() -> tuple[NDArray[np.float64], tuple[str, ...]]:
    """Twelve items, 20 rows: Table 3's ten with the printed KMO, χ² and α, and the two static ones at .968, .930."""
    r, p = table_3_correlation(), len(TABLE_3)
    twelve = np.eye(p + 2)
    twelve[:p, :p] = r
    for row, (twin, close) in enumerate((("silhouette", 0.968), ("dynamic_drape", 0.930)), start=p):
        twelve[row, :row] = close * twelve[TABLE_3_ITEMS.index(twin), :row]
        twelve[:row, row] = twelve[row, :row]
    z = exact_sample(twelve, N, seed=11)
    return 3.0 + z * _deviations(r), (*TABLE_3_ITEMS, "static_overall", "static_drape")


def _deviations(r: NDArray[np.float64]) -> NDArray[np.float64]:
    """Standard deviations that bring the raw α of the ten items to the printed .911."""
    p = len(r)
    tilt = np.linspace(-1.0, 1.0, p)[np.random.default_rng(3).permutation(p)]

    def raw_alpha(size):
        sd = np.exp(size * tilt)
        c = r * np.outer(sd, sd)
        return p / (p - 1) * (1 - np.trace(c) / c.sum()) - ALPHA

    sd = np.exp(brentq(raw_alpha, 0.0, 2.0) * tilt)
    return np.concatenate([sd, [1.0, 1.0]])


def likert_sample(n: int, seed: int) -> NDArray[np.float64]:
    """n rows of the ten items as integers 1–5, drawn from Table 3's population."""
    z = (
        np.random.default_rng(seed).normal(size=(n, len(TABLE_3)))
        @ np.linalg.cholesky(table_3_correlation()).T
    )
    return np.clip(np.rint(3.4 + z), 1, 5)


def submission(questionnaire, *, score: int | None = 4, **changes) -> dict:
    """A valid body for a questionnaire; `changes` replace its fields."""
    body = {
        "id": str(uuid.uuid4()),
        "version": questionnaire.version,
        "language": "zh",
        "consent": True,
        "scores": dict.fromkeys(questionnaire.item_ids, score),
        "suggestions": {},
    }
    return copy.deepcopy(body | changes)


def looked_up(where: Path | str, query: str) -> list[tuple]:
    """Rows of a store's database, read behind the product's back."""
    engine = create_engine(f"sqlite:///{where / 'survey.sqlite'}" if isinstance(where, Path) else where)
    try:
        with engine.connect() as connection:
            return [tuple(row) for row in connection.execute(text(query))]
    finally:
        engine.dispose()
