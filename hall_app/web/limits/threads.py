"""Threads beside the event loop: few, and none of them keeps Python's lock for long.

Questionnaires and the privacy page are rendered in the server's threads, forty by default; each may keep the lock for
five milliseconds, and the loop has to ask for it again after everything it waits for.
"""

from __future__ import annotations

import sys

from anyio import to_thread

__all__ = ["few_threads"]

_THREADS = 3
_KEPT = 0.0002  # [s] a thread keeps the lock while others wait for it


def few_threads() -> None:
    """For this process and its running loop, from now on."""
    sys.setswitchinterval(_KEPT)
    to_thread.current_default_thread_limiter().total_tokens = _THREADS
