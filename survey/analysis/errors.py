"""What an analysis cannot do, each its own type with the items that are to blame."""

from __future__ import annotations

from collections.abc import Sequence

from survey.errors import SurveyError

__all__ = [
    "AllEqual",
    "AnalysisError",
    "ConstantItem",
    "DependentItems",
    "NotConverged",
    "NotFinite",
    "NotPositiveDefinite",
    "TooFewRows",
]


class AnalysisError(SurveyError):
    """Base of them all. `items`: names of the items concerned, may be empty."""

    code = "analysis"

    def __init__(self, message: str, items: Sequence[str] = ()) -> None:
        self.items = tuple(items)
        super().__init__(message)


class TooFewRows(AnalysisError):
    """Fewer answers than the computation needs."""

    code = "too_few_rows"


class NotFinite(AnalysisError):
    """A missing or infinite score where a number is needed."""

    code = "not_finite"


class ConstantItem(AnalysisError):
    """An item with the same score everywhere has no correlation."""

    code = "constant_item"


class AllEqual(AnalysisError):
    """Every item is constant: there is nothing to correlate."""

    code = "all_equal"


class DependentItems(AnalysisError):
    """Items of which one follows exactly from the others: the correlation matrix has no inverse."""

    code = "dependent_items"


class NotPositiveDefinite(AnalysisError):
    """A matrix put together from different answers (pairwise, polychoric) that no single sample could have."""

    code = "not_positive_definite"


class NotConverged(AnalysisError):
    """An iteration that did not come to rest."""

    code = "not_converged"
