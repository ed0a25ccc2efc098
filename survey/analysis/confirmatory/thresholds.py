"""Thresholds and polychoric correlations with the covariance of their sampling errors (Muthén 1984).

Two steps: each item's thresholds from its own frequencies, then each pair's ρ. What a single answer moves in these
estimates is summed over the answers, so the errors of the first step stand in those of the second.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from survey.analysis.correlation import LIMIT, Ordered, binormal, density, ordered, solved_tables
from survey.analysis.errors import DependentItems, TooFewRows

__all__ = ["Polychorics", "polychorics"]

BLOCK = 8192  # answers whose shares in the estimates are held at a time


@dataclass(frozen=True)
class Polychorics:
    """r (p, p); thresholds (p, c + 1) between ±40, as `Ordered` has them; of n answers.

    error: (m, m) covariance of √n times the errors of the correlations, in the order of np.tril_indices(p, -1).
    threshold_error: (p, c + 1) standard errors, NaN beside the thresholds.
    """

    n: int
    r: NDArray[np.float64]
    error: NDArray[np.float64]
    thresholds: NDArray[np.float64]
    threshold_error: NDArray[np.float64]
    seen: Ordered


def polychorics(table: NDArray[np.float64], names: Sequence[str]) -> Polychorics:
    """Of complete scores (n, p) of a few categories each.

    Raises what `ordered` raises, TooFewRows when n ≤ p, DependentItems where two items' correlation reaches ±1.
    """
    n, p = table.shape
    if n <= p:
        raise TooFewRows(f"{n} complete answers for {p} items – a factor model needs more answers than items")
    seen = ordered(table, names)
    rows, cols = np.tril_indices(p, -1)
    across, down = seen.cuts[rows], seen.cuts[cols]
    rho = solved_tables(seen.counts, across, down)
    if (np.abs(rho) > LIMIT - 1e-4).any():
        at = int(np.abs(rho).argmax())
        pair = (names[int(cols[at])], names[int(rows[at])])
        raise DependentItems(f"{' and '.join(pair)}: the same but for their categories – drop one", pair)
    r = np.eye(p)
    r[rows, cols] = r[cols, rows] = rho
    first = _threshold_shares(seen, n)
    cells = _Cells(across, down, rho)
    by_rho, by_row, by_col = cells.by_rho, cells.by_threshold(0), cells.by_threshold(1)
    # A cell without answers has no share; its probability may be 0.
    held = seen.counts > 0
    by_rho, by_row, by_col = (
        np.where(held if part.ndim == 3 else held[..., None], part, 0.0) for part in (by_rho, by_row, by_col)
    )
    own = (seen.counts * by_rho**2).sum(axis=(1, 2))
    tied_rows = np.einsum("mab,mab,mabt->mt", seen.counts, by_rho, by_row)
    tied_cols = np.einsum("mab,mab,mabt->mt", seen.counts, by_rho, by_col)
    error = np.zeros((len(rho), len(rho)))
    for begin in range(0, n, BLOCK):
        codes = seen.codes[begin : begin + BLOCK]
        shares = by_rho[np.arange(len(rho)), codes[:, rows], codes[:, cols]]
        moved = first[np.arange(p), codes]  # (block, p, c − 1)
        shares = shares - np.einsum("nmt,mt->nm", moved[:, rows], tied_rows)
        shares = (shares - np.einsum("nmt,mt->nm", moved[:, cols], tied_cols)) / own
        error += shares.T @ shares
    return Polychorics(n, r, error * n, seen.cuts, _threshold_errors(seen, first, n), seen)


def _threshold_shares(seen: Ordered, n: int) -> NDArray[np.float64]:
    """(p, c, c − 1): how an answer in a category moves the item's thresholds, times 1 (their sum of squares is the
    thresholds' variance)."""
    p, wide = seen.cuts.shape
    out = np.zeros((p, wide - 1, wide - 2))
    for item, levels in enumerate(seen.levels):
        count = len(levels)
        cuts = seen.cuts[item, 1:count]
        below = np.arange(count)[:, None] <= np.arange(count - 1)  # category a lies below threshold t
        # Φ(τ) is the share below, so dτ = d(share) / φ(τ).
        out[item, :count, : count - 1] = (below - ndtr(cuts)) / (_normal(cuts) * n)
    return out


def _threshold_errors(seen: Ordered, first: NDArray[np.float64], n: int) -> NDArray[np.float64]:
    out = np.full(seen.cuts.shape, np.nan)
    for item, levels in enumerate(seen.levels):
        count = len(levels)
        often = np.bincount(seen.codes[:, item], minlength=count)
        variance = (often[:, None] * first[item, :count, : count - 1] ** 2).sum(axis=0) * n / (n - 1)
        out[item, 1:count] = np.sqrt(variance)
    return out


def _normal(x: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.exp(-0.5 * x**2) / np.sqrt(2.0 * np.pi)


class _Cells:
    """Of m pairs' tables the logarithms of the cells' probabilities: their slopes by ρ and by the thresholds."""

    def __init__(
        self, across: NDArray[np.float64], down: NDArray[np.float64], rho: NDArray[np.float64]
    ) -> None:
        h, k, at = np.broadcast_arrays(across[:, :, None], down[:, None, :], rho[:, None, None])
        self.across, self.down, self.rho = across, down, rho
        self.probable = np.maximum(_between(binormal(h, k, at)), 1e-300)
        self.by_rho = _between(density(h, k, at)) / self.probable

    def by_threshold(self, axis: int) -> NDArray[np.float64]:
        """(m, c, c, c − 1) by the thresholds of the rows' items (axis 0) or of the columns'."""
        own, other = (self.across, self.down) if axis == 0 else (self.down, self.across)
        rest = np.sqrt(1.0 - self.rho**2)[:, None, None]
        given = ndtr((other[:, None, :] - self.rho[:, None, None] * own[:, :, None]) / rest)
        strip = _normal(own)[:, :, None] * np.diff(given, axis=2)  # (m, c + 1, c): along a threshold
        count = own.shape[1] - 1
        out = np.zeros((len(own), count, count, count - 1))
        for at in range(count - 1):  # threshold at + 1 lies above category at and below the next
            out[:, at, :, at] = strip[:, at + 1]
            out[:, at + 1, :, at] = -strip[:, at + 1]
        return (out if axis == 0 else out.swapaxes(1, 2)) / self.probable[..., None]


def _between(corner: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.diff(np.diff(corner, axis=1), axis=2)
