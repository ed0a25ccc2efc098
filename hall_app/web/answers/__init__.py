"""Answers to visitors: work, done once for all who wait; packed, compressed once; head, who wants no body."""

from hall_app.web.answers.head import HeadToo, is_head
from hall_app.web.answers.packed import Packed, accepted
from hall_app.web.answers.work import SLOW, Answers, Work

__all__ = ["SLOW", "Answers", "HeadToo", "Packed", "Work", "accepted", "is_head"]
