"""Correlations of greatest likelihood from all scores there are (EM), for answers with gaps."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from survey.analysis.correlation.missing_data import patterns_of, saturated
from survey.analysis.correlation.pearson import Correlation, two_tailed

__all__ = ["correlate_likely"]


def correlate_likely(table: NDArray[np.float64], names: Sequence[str]) -> Correlation:
    """Of scores (n, p), NaN missing: the correlations of one normal distribution that all scores make likeliest.

    Right where gaps depend on nothing but what was answered. There is no honest single n for such a matrix; counts are
    the answers that have both items of a pair, so that tests err on the careful side.
    Raises what `patterns_of` and `saturated` raise.
    """
    seen = patterns_of(table, names)
    sigma = saturated(seen, names).covariance
    spread = np.sqrt(np.diag(sigma))
    r = np.clip(sigma / np.outer(spread, spread), -1.0, 1.0)
    np.fill_diagonal(r, 1.0)
    there = (~np.isnan(table)).astype(np.int64)
    counts = there.T @ there
    return Correlation(r, two_tailed(r, counts), counts)
