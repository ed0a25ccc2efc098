"""Answers to visitors: work, done once for all who wait; packed, compressed once."""

from hall_app.web.answers.packed import Packed, accepted
from hall_app.web.answers.work import SLOW, Answers, Work

__all__ = ["SLOW", "Answers", "Packed", "Work", "accepted"]
