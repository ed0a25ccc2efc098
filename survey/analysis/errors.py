"""What an analysis cannot do, each its own type with the items that are to blame."""

from __future__ import annotations

from collections.abc import Sequence

from survey.errors import SurveyError

__all__ = [
    "AllEqual",
    "AnalysisError",
    "BadModel",
    "ConstantItem",
    "CrossCheckFailed",
    "DependentItems",
    "GapsLeft",
    "GroupTooSmall",
    "LoneItem",
    "NoComponents",
    "NotAMean",
    "NotConverged",
    "NotFinite",
    "NotIdentified",
    "NotPositiveDefinite",
    "OutOfReach",
    "TooFewItems",
    "TooFewRows",
    "TooManyScores",
    "UnknownGroup",
    "UnknownItem",
    "WrongShape",
]


class AnalysisError(SurveyError):
    """Base of them all, never raised itself: every kind has a `code` of its own.

    `items`: names of the items concerned, may be empty.
    """

    code: str

    def __init__(self, message: str, items: Sequence[str] = ()) -> None:
        self.items = tuple(items)
        super().__init__(message)


class UnknownItem(AnalysisError):
    """An item that the table does not have."""

    code = "unknown_item"


class WrongShape(AnalysisError):
    """An array that is not the table or matrix which the function takes."""

    code = "wrong_shape"


class TooFewItems(AnalysisError):
    """Fewer items than the computation needs."""

    code = "too_few_items"


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


class LoneItem(AnalysisError):
    """An item that is correlated with no other: its KMO is 0 / 0."""

    code = "lone_item"


class DependentItems(AnalysisError):
    """Items of which one follows exactly from the others: the correlation matrix has no inverse."""

    code = "dependent_items"


class NotPositiveDefinite(AnalysisError):
    """A matrix put together from different answers (pairwise, polychoric) that no single sample could have."""

    code = "not_positive_definite"


class NotConverged(AnalysisError):
    """An iteration that did not come to rest."""

    code = "not_converged"


class CrossCheckFailed(AnalysisError):
    """Our figure and a second library's differ by more than rounding."""

    code = "cross_check_failed"


class NoComponents(AnalysisError):
    """No component is kept, or more are asked for than there are items."""

    code = "no_components"


class GapsLeft(AnalysisError):
    """A computation that needs whole answers met gaps."""

    code = "gaps_left"


class TooManyScores(AnalysisError):
    """An item with more different scores than a scale of answers has."""

    code = "too_many_scores"


class NotAMean(AnalysisError):
    """A text that is no printed mean, or counts that no mean is made of."""

    code = "not_a_mean"


class BadModel(AnalysisError):
    """A text that is no measurement model."""

    code = "bad_model"


class NotIdentified(AnalysisError):
    """A model whose parameters no data could tell apart."""

    code = "not_identified"


class GroupTooSmall(AnalysisError):
    """A group of too few answers: its figures would tell of persons, and nothing of a difference."""

    code = "group_too_small"


class UnknownGroup(AnalysisError):
    """A grouping that does not come to two groups, or names one that there is not."""

    code = "unknown_group"


class OutOfReach(AnalysisError):
    """A plan that no number of answers fulfils, or figures that it cannot be made of."""

    code = "out_of_reach"
