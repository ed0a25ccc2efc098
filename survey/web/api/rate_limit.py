"""How many new answers one address may give in a minute; nothing of it is ever written down."""

from __future__ import annotations

import hashlib
import math
import secrets
import threading
import time
from collections.abc import Callable

__all__ = ["PER_MINUTE", "Limit"]

PER_MINUTE = 300  # several classes behind one address; replays do not count
MOST = 10_000  # addresses remembered at once


class Limit:
    """A bucket per address that fills again evenly: `per_minute` at once, and as many each minute. 0: no limit.

    An address is remembered as a hash under a key that dies with the process, and only until its bucket is full
    again. clock: seconds, monotonic.
    """

    def __init__(self, per_minute: int = PER_MINUTE, *, clock: Callable[[], float] = time.monotonic) -> None:
        self.per_minute, self._clock = per_minute, clock
        self._key = secrets.token_bytes(32)
        self._spent: dict[bytes, tuple[float, float]] = {}  # (taken from the bucket, when)
        self._changing = threading.Lock()

    def take(self, address: str) -> int:
        """Take one from the address's bucket: 0, or where it is empty the seconds to wait, at least 1."""
        if not self.per_minute:
            return 0
        name = self._name(address)
        with self._changing:
            now, rate = self._clock(), self.per_minute / 60.0
            if len(self._spent) >= MOST:
                self._forget(now, rate)
            spent, at = self._spent.get(name, (0.0, now))
            spent = max(0.0, spent - (now - at) * rate)
            if spent + 1.0 > self.per_minute + 1e-9:
                return max(1, math.ceil((spent + 1.0 - self.per_minute) / rate))
            self._spent[name] = (spent + 1.0, now)
        return 0

    def give_back(self, address: str) -> None:
        """Put one back that was taken for what turned out to be a replay."""
        name = self._name(address)
        with self._changing:
            spent, at = self._spent.get(name, (0.0, 0.0))
            if spent > 0.0:
                self._spent[name] = (max(0.0, spent - 1.0), at)

    def _name(self, address: str) -> bytes:
        return hashlib.blake2b(address.encode("utf-8", "replace"), key=self._key, digest_size=16).digest()

    def _forget(self, now: float, rate: float) -> None:
        """Drop the full buckets; where there are none, the longest untouched half."""
        standing = {key: (spent, at) for key, (spent, at) in self._spent.items() if spent > (now - at) * rate}
        if len(standing) >= MOST:
            newest = sorted(standing.items(), key=lambda entry: entry[1][1])[MOST // 2 :]
            standing = dict(newest)
        self._spent = standing
