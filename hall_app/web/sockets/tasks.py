"""What one connection does beside each other: until the first of it ends, and a fault leaves a trace."""

from __future__ import annotations

import asyncio
import logging
import traceback
from collections.abc import Coroutine
from typing import Any

from starlette.websockets import WebSocketDisconnect

__all__ = ["until_first"]

_SOCKETS = frozenset({"starlette", "uvicorn", "websockets"})  # what they raise is a line that has ended
_told: set[tuple[type[Exception], str, int | None]] = set()
_log = logging.getLogger(__name__)


async def until_first(*acts: Coroutine[Any, Any, Any]) -> None:
    """Run them until one has ended, then end the others. A fault of ours or viser's is logged, each place once."""
    tasks = [asyncio.create_task(act) for act in acts]
    try:
        await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
    finally:
        for task in tasks:
            task.cancel()
        for outcome in await asyncio.gather(*tasks, return_exceptions=True):
            if isinstance(outcome, Exception) and not isinstance(outcome, WebSocketDisconnect):
                _tell(outcome)


def _tell(fault: Exception) -> None:
    frames = [frame for frame, _ in traceback.walk_tb(fault.__traceback__)]
    if frames and frames[-1].f_globals.get("__name__", "").partition(".")[0] in _SOCKETS:
        return
    last = traceback.extract_tb(fault.__traceback__)[-1:]
    place = (type(fault), last[0].filename if last else "", last[0].lineno if last else 0)
    if place not in _told:
        _told.add(place)
        _log.error("a visitor's line ended by a fault", exc_info=fault)
