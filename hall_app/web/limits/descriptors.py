"""File descriptors: every connection is one, and the system allows only so many."""

from __future__ import annotations

import contextlib

__all__ = ["connections", "raise_limit", "shortage"]

_RAISED_TO = 65_536
_OF_ITS_OWN = 160  # files, viser's own server, connections that are just being accepted or ended
_BEHIND_A_VIEW = 2  # both ends of the relay's connection to viser
_OF_A_VISITOR = 8  # two sockets and a browser's six plain connections
_WAITING = 4  # in the queue, for each visitor inside
_MOST, _MOST_A_VISITOR = 4000, 20  # connections that are of use to anybody


def raise_limit() -> int:
    """Allow this process as many as the system lets it; returns how many that are."""
    try:
        import resource
    except ImportError:  # Windows counts no descriptors
        return _RAISED_TO
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    wanted = _RAISED_TO if hard == resource.RLIM_INFINITY else min(hard, _RAISED_TO)
    if soft != resource.RLIM_INFINITY and soft < wanted:
        with contextlib.suppress(ValueError, OSError):  # some systems name a hard limit that they do not keep
            resource.setrlimit(resource.RLIMIT_NOFILE, (wanted, hard))
    soft, _ = resource.getrlimit(resource.RLIMIT_NOFILE)
    return _RAISED_TO if soft == resource.RLIM_INFINITY else soft


def connections(limit: int, visitors: int) -> int:
    """How many connections from outside `limit` descriptors leave room for, and no more than are of use."""
    room = limit - _OF_ITS_OWN - _BEHIND_A_VIEW * visitors
    return max(16, min(room, max(_MOST, _MOST_A_VISITOR * visitors)))


def shortage(limit: int, visitors: int) -> str | None:
    """One line where `limit` is too little for that many visitors and their queue, None where it is enough."""
    needed = _OF_ITS_OWN + (_BEHIND_A_VIEW + _OF_A_VISITOR + _WAITING) * visitors
    if limit >= needed:
        return None
    return (
        f"Only {limit} files may be open here, {visitors} visitors and their queue take up to {needed}: "
        f"raise it with `ulimit -n {needed}`, or lower --visitors"
    )
