"""How often one may try. Counted in memory only: nothing of it is written down, and a new start forgives."""

from __future__ import annotations

import math
import time

from limits import RateLimitItem, parse
from limits.storage import MemoryStorage
from limits.strategies import MovingWindowRateLimiter

from hall_app.house.people import PeopleError

__all__ = ["RATES", "Pace"]

# A class behind one address signs up and in at once; one account is guessed at slowly, from wherever it is tried.
RATES: dict[str, RateLimitItem] = {
    "try from here": parse("300 per 15 minutes"),
    "account from here": parse("10 per 5 minutes"),
    "account": parse("60 per hour"),
    "sign up": parse("120 per hour"),
    "code": parse("60 per 15 minutes"),
    "copy": parse("10 per hour"),
    "book": parse("60 per 5 minutes"),
}


class Pace:
    """Tries that were made lately."""

    def __init__(self) -> None:
        self._limiter = MovingWindowRateLimiter(MemoryStorage())

    def take(self, kind: str, *names: str) -> None:
        """Count a try. Raises PeopleError, with the seconds to wait, where it is one too many."""
        rate = RATES[kind]
        key = (kind, *(name[:254] for name in names))
        if not self._limiter.hit(rate, *key):
            left = self._limiter.get_window_stats(rate, *key).reset_time - time.time()
            raise PeopleError("too-often", seconds=max(1, math.ceil(left)))
