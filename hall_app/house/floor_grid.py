"""The clearance grid of the hall's floor, with what visitors share: at once, or in a process beside the server."""

from __future__ import annotations

import asyncio
import contextlib
import multiprocessing
import signal
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

from hall_app.walk import Floor, Grid, Pose, UnreachableError, cached_grid

__all__ = ["grid_beside", "ready_grid"]


def ready_grid(
    floor: Floor, folder: Path, start: Pose, *, progress: Callable[[float, str], None] | None = None
) -> Grid:
    """The floor's grid, of `folder` or baked into it, with what can be reached from the start computed already."""
    grid = cached_grid(floor, folder, progress=progress)
    with contextlib.suppress(UnreachableError):
        grid.reach((start.x, start.z))
    return grid


async def grid_beside(floor: Floor, folder: Path, start: Pose) -> Grid:
    """ready_grid, seconds of work, in a process of its own that ends with the await."""
    # Ctrl-C is ours to answer; the worker would print its own account of it.
    ignore = {"initializer": signal.signal, "initargs": (signal.SIGINT, signal.SIG_IGN)}
    pool = ProcessPoolExecutor(1, mp_context=get_context("spawn"), **ignore)
    try:
        return await asyncio.get_running_loop().run_in_executor(pool, ready_grid, floor, folder, start)
    except asyncio.CancelledError:
        for worker in multiprocessing.active_children():
            worker.terminate()
        raise
    finally:
        pool.shutdown(wait=False, cancel_futures=True)
