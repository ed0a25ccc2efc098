"""Budgets: how much of each kind one visitor, or one address, may ask for. Values and an explicit clock, no sockets.

A bucket fills evenly and holds a burst: honest play, also what a slow line delivers late at once, never empties it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

__all__ = ["RELAY", "WALK", "Allowance", "Bucket", "Rate", "Verdict"]

Verdict = Literal["serve", "drop", "leave"]


@dataclass(frozen=True, slots=True)
class Rate:
    """`burst` at once, `per_second` for ever."""

    burst: float
    per_second: float


@dataclass(frozen=True, slots=True)
class Bucket:
    """What was left at the time `at` [s]."""

    left: float
    at: float

    def filled(self, rate: Rate, now: float) -> Bucket:
        """The bucket as it stands `now`; a clock that runs backwards fills nothing."""
        return Bucket(
            min(rate.burst, self.left + max(0.0, now - self.at) * rate.per_second), max(self.at, now)
        )

    def less(self, amount: float) -> Bucket:
        return Bucket(self.left - amount, self.at)


# What a page sends at most: a batch of inputs 30 times a second, one input a displayed frame (up to 500 Hz), keys
# where the server walks; the bursts are five seconds of that, delivered at once by a line that stood still.
WALK: Mapping[str, Rate] = {
    "bytes": Rate(512 << 10, 96 << 10),
    "messages": Rate(600, 90),
    "inputs": Rate(2500, 500),
    "keys": Rate(300, 60),
    "goto": Rate(20, 4),
    "open": Rate(10, 1),
    "close": Rate(20, 2),
    "compare": Rate(10, 1),
    "client": Rate(8, 1),
    "stands": Rate(40, 4),
    "other": Rate(30, 2),
}

# viser's client tells its camera up to 50 times a second while the view moves.
RELAY: Mapping[str, Rate] = {
    "bytes": Rate(1 << 20, 128 << 10),
    "messages": Rate(1200, 200),
    "click": Rate(20, 4),
    "other": Rate(200, 20),
}

_PATIENCE = Rate(200, 5)  # dropped messages until the socket is closed


class Allowance:
    """One socket's buckets: says of each message whether it is served, dropped, or one too many."""

    def __init__(self, rates: Mapping[str, Rate], now: float) -> None:
        self._rates = rates
        self._buckets = {kind: Bucket(rate.burst, now) for kind, rate in rates.items()}
        self._left = Bucket(_PATIENCE.burst, now)

    def take(self, kind: str, now: float, amount: float = 1.0) -> Verdict:
        """Take `amount` of `kind` at the time `now` [s]."""
        bucket = self._buckets[kind].filled(self._rates[kind], now)
        if bucket.left >= amount:
            self._buckets[kind] = bucket.less(amount)
            return "serve"
        self._buckets[kind] = bucket
        self._left = self._left.filled(_PATIENCE, now).less(1.0)
        return "drop" if self._left.left >= 0 else "leave"
