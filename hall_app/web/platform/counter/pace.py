"""How often one may try. Counted in memory only: nothing of it is written down, and a new start forgives."""

from __future__ import annotations

import math
import threading
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager

from limits import RateLimitItem, parse
from limits.storage import MemoryStorage
from limits.strategies import MovingWindowRateLimiter

from hall_app.house.people import PeopleError

__all__ = ["RATES", "Pace"]

# A class behind one address signs up and in at once; one account is guessed at slowly, from wherever it is tried. Tries
# that fail are all that count against an account, and one address has a share of them: it cannot use up everybody's.
RATES: dict[str, RateLimitItem] = {
    "try from here": parse("300 per 15 minutes"),
    "account from here": parse("10 per 5 minutes"),
    "account share": parse("15 per hour"),
    "account": parse("60 per hour"),
    "sign up": parse("120 per hour"),
    "code": parse("60 per 15 minutes"),
    "copy": parse("10 per hour"),
    "book": parse("60 per 5 minutes"),
}
# Refusals that a guess meets.
_WRONG = frozenset({"sign-in", "no-office", "password-wrong", "authenticator", "present-factor"})


class Pace:
    """Tries that were made lately."""

    def __init__(self) -> None:
        self._limiter = MovingWindowRateLimiter(MemoryStorage())
        self._under_way: Counter[tuple[str, ...]] = Counter()
        self._counting = threading.Lock()

    def take(self, kind: str, *names: str) -> None:
        """Count a try. Raises PeopleError, with the seconds to wait, where it is one too many."""
        rate, key = RATES[kind], _key(kind, *names)
        if not self._limiter.hit(rate, *key):
            raise self._too_often(key)

    @contextmanager
    def failures(self, *tries: tuple[str, ...]) -> Iterator[None]:
        """Count what is tried in the block where a guess fails in it. tries: kind and names of each count.

        While it lasts it counts as one that failed: many at once find no way round. Raises PeopleError as `take` does,
        before anything is tried.
        """
        keys = [_key(*one) for one in tries]
        with self._counting:
            for key in keys:
                if self._limiter.get_window_stats(RATES[key[0]], *key).remaining <= self._under_way[key]:
                    raise self._too_often(key)
            self._under_way.update(keys)
        failed = False
        try:
            yield
        except PeopleError as error:
            failed = error.key in _WRONG
            raise
        finally:
            with self._counting:
                self._under_way -= Counter(keys)  # which forgets those that are down to none
                for key in keys if failed else ():
                    self._limiter.hit(RATES[key[0]], *key)

    def _too_often(self, key: tuple[str, ...]) -> PeopleError:
        stats = self._limiter.get_window_stats(RATES[key[0]], *key)
        left = 1 if stats.remaining else stats.reset_time - time.time()
        return PeopleError("too-often", seconds=max(1, math.ceil(left)))


def _key(kind: str, *names: str) -> tuple[str, ...]:
    return (kind, *(name[:254] for name in names))
