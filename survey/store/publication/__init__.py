"""What is public of the answers: the rule of `disclosure`, and the `steps` by which figures move on and are kept."""

from survey.store.publication.disclosure import (
    KNOWN,
    STEP,
    Figure,
    Reason,
    Scores,
    Shown,
    decimals_of,
    moved_on,
)
from survey.store.publication.steps import Public, Publishing, forget

__all__ = [
    "KNOWN",
    "STEP",
    "Figure",
    "Public",
    "Publishing",
    "Reason",
    "Scores",
    "Shown",
    "decimals_of",
    "forget",
    "moved_on",
]
