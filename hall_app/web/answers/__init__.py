"""Answers to visitors: work, done once for all who wait; packed, compressed once."""

from hall_app.web.answers.packed import FOR_GOOD, PRIVATE, REVALIDATED, Packed, accepted
from hall_app.web.answers.work import SLOW, Answers, Work

__all__ = [
    "FOR_GOOD",
    "PRIVATE",
    "REVALIDATED",
    "SLOW",
    "Answers",
    "Packed",
    "Work",
    "accepted",
]
