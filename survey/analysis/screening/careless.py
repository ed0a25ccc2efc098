"""Answers that deserve a second look. They are named, never deleted: a person decides."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["LEAST_ITEMS", "SECONDS", "duplicates", "hasty", "straight_liners"]

LEAST_ITEMS = 8  # on fewer items the same score throughout, or the same answer twice, is no wonder
SECONDS = 2.0  # per item, below which nobody has read the question


def straight_liners(table: NDArray[np.float64]) -> NDArray[np.int64]:
    """Rows (0-based) of scores (n, p) with the same score on every answered item, at least eight of them."""
    there = ~np.isnan(table)
    low = np.where(there, table, np.inf).min(axis=1, initial=np.inf)
    high = np.where(there, table, -np.inf).max(axis=1, initial=-np.inf)
    return np.flatnonzero((there.sum(axis=1) >= LEAST_ITEMS) & (low == high))


def duplicates(table: NDArray[np.float64]) -> list[NDArray[np.int64]]:
    """Groups of rows (0-based) with the very same scores, gaps included, on eight items or more.

    Straight-liners are left to their own flag.
    """
    if table.shape[1] < LEAST_ITEMS or not len(table):
        return []
    wanted = np.setdiff1d(
        np.flatnonzero((~np.isnan(table)).sum(axis=1) >= LEAST_ITEMS), straight_liners(table)
    )
    # Sorting rows as bytes is far faster than column by column; + 0.0 makes −0 and 0 the same bytes.
    rows = np.ascontiguousarray(table[wanted]) + 0.0
    packed = rows.view(np.dtype((np.void, rows.dtype.itemsize * rows.shape[1]))).ravel()
    _, group, counts = np.unique(packed, return_inverse=True, return_counts=True)
    twice = np.flatnonzero(counts[group] > 1)
    found: dict[int, list[int]] = {}
    for at in twice:
        found.setdefault(int(group[at]), []).append(int(wanted[at]))
    return sorted((np.array(same) for same in found.values()), key=lambda same: int(same[0]))


def hasty(table: NDArray[np.float64], seconds: ArrayLike) -> NDArray[np.int64]:
    """Rows (0-based) filled in faster than two seconds per answered item; an unknown time (NaN) is none."""
    spent = np.asarray(seconds, dtype=np.float64)
    wanted = SECONDS * (~np.isnan(table)).sum(axis=1)
    return np.flatnonzero(np.where(np.isnan(spent), np.inf, spent) < wanted)
