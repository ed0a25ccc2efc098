"""Correlations of items.

Pearson's with their probabilities (`pearson`), polychoric ones of ordered scales (`ordinal`), and those that answers
with gaps make likeliest (`missing_data`).
"""

from survey.analysis.correlation.missing_data import (
    Patterns,
    Saturated,
    correlate_likely,
    misfit_of,
    patterns_of,
    saturated,
)
from survey.analysis.correlation.ordinal import (
    INFINITY,
    LIMIT,
    Ordered,
    binormal,
    density,
    ordered,
    polychoric,
    solved_tables,
)
from survey.analysis.correlation.pearson import (
    Correlation,
    correlate,
    correlate_pairwise,
    covariance_pairwise,
    stars,
)

__all__ = [
    "INFINITY",
    "LIMIT",
    "Correlation",
    "Ordered",
    "Patterns",
    "Saturated",
    "binormal",
    "correlate",
    "correlate_likely",
    "correlate_pairwise",
    "covariance_pairwise",
    "density",
    "misfit_of",
    "ordered",
    "patterns_of",
    "polychoric",
    "saturated",
    "solved_tables",
    "stars",
]
