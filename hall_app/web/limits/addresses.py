"""What one address may ask for before anybody has said who he is. Kept in memory only, and only while it matters.

A class behind one address comes in at once; whoever was thrown out and comes back at full speed finds the door shut.
"""

from __future__ import annotations

import ipaddress
import re
from collections.abc import Callable
from time import monotonic

from hall_app.web.limits.budgets import Bucket, Rate
from hall_app.web.limits.shares import Shares

__all__ = ["Addresses", "Silent", "name_of"]

# A hundred pages at once: about thirty files each on six connections, two sockets, and all of that twice again.
RATES = {
    "line": Rate(2400, 120),  # TCP connections
    "request": Rate(10_000, 100),  # plain requests
    "attempt": Rate(900, 150),  # sockets asked for; a page that waits asks for viser's once a second
    "socket": Rate(400, 10),  # sockets opened
}
THROWN_OUT = 40  # sockets that one misused socket counts as
MOST_SILENT = 160  # sockets of one address that have not said hello
MOST_SILENT_IN_ALL = 800
_REMEMBERED = 4096  # addresses


class Addresses:
    """A bucket of each kind per address; IPv6 by its /64, which is one customer's. clock: seconds, monotonic.

    shares: in what order the work that they ask for is done.
    """

    def __init__(self, clock: Callable[[], float] = monotonic) -> None:
        self._clock = clock
        self.shares = Shares()
        self._buckets: dict[tuple[str, str], Bucket] = {}
        self._silent: dict[str, dict[Silent, None]] = {}  # in the order of coming

    def take(self, kind: str, address: str) -> bool:
        """Take one; False where nothing is left."""
        key, rate, now = (kind, name_of(address)), RATES[kind], self._clock()
        bucket = self._buckets.get(key)
        bucket = Bucket(rate.burst, now) if bucket is None else bucket.filled(rate, now)
        served = bucket.left >= 1
        self._keep(key, bucket.less(1) if served else bucket)
        return served

    def throw_out(self, address: str) -> None:
        """A socket from there was misused: the address has that much less to come back with."""
        key, rate, now = ("socket", name_of(address)), RATES["socket"], self._clock()
        bucket = self._buckets.get(key, Bucket(rate.burst, now)).filled(rate, now)
        self._keep(key, Bucket(max(-rate.burst, bucket.left - THROWN_OUT), bucket.at))

    def silent(self, address: str) -> Silent | None:
        """A socket that has not said hello yet; None where its address has too many of those open.

        Where all have too many, the oldest of whoever has most is thrown out.
        """
        name = name_of(address)
        if len(self._silent.get(name, ())) >= MOST_SILENT:
            return None
        if sum(map(len, self._silent.values())) >= MOST_SILENT_IN_ALL:
            oldest = next(iter(max(self._silent.values(), key=len)))
            oldest.end()
            oldest.throw_out()
        return Silent(self._silent, name)

    def _keep(self, key: tuple[str, str], bucket: Bucket) -> None:
        if key not in self._buckets and len(self._buckets) >= _REMEMBERED:
            self._forget_half()
        self._buckets[key] = bucket

    def _forget_half(self) -> None:
        """Those with most left go first; a penalty is kept until it is served."""
        now = self._clock()
        left = {
            key: b.filled(RATES[key[0]], now).left / RATES[key[0]].burst for key, b in self._buckets.items()
        }
        fullest = sorted((key for key in left if left[key] >= 0), key=lambda key: -left[key])
        for gone in fullest[: _REMEMBERED // 2]:
            del self._buckets[gone]


class Silent:
    """One place among the silent sockets, given back once. `throw_out` is called when another needs it."""

    def __init__(self, open_now: dict[str, dict[Silent, None]], name: str) -> None:
        self._open, self._name = open_now, name
        self.throw_out: Callable[[], object] = lambda: None
        open_now.setdefault(name, {})[self] = None

    def end(self) -> None:
        """It has said hello, or it has gone."""
        own = self._open.get(self._name, {})
        if self in own:
            del own[self]
            if not own:
                del self._open[self._name]


def name_of(address: str) -> str:
    """Under which name an address is counted: IPv4 by itself, however it is written, IPv6 by its /64.

    A port, which some proxies add to whom they forward, is left out.
    """
    bare = re.fullmatch(r"\[(.*)\](?::\d+)?|([^:]*):\d+", address)
    host = (bare[1] or bare[2] or "") if bare else address
    try:
        found = ipaddress.ip_address(host.partition("%")[0])
    except ValueError:
        return host
    if isinstance(found, ipaddress.IPv6Address):
        if found.ipv4_mapped is None:
            return str(ipaddress.ip_network((found, 64), strict=False))
        found = found.ipv4_mapped
    return str(found)
