"""Two groups, item by item: `differences` with their tests and effect sizes, told as JSON or text by `summary`."""

from survey.analysis.comparison.differences import Comparison, Difference, Effect, compare, holm
from survey.analysis.comparison.summary import comparison_printed, comparison_summary

__all__ = [
    "Comparison",
    "Difference",
    "Effect",
    "compare",
    "comparison_printed",
    "comparison_summary",
    "holm",
]
