"""Low-discrepancy lattices, frames across normals, and places shared among threads."""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["A1", "A2", "B1", "B2", "B3", "PI", "SCALE", "SHIFT", "frame", "in_threads", "seeds_of"]

_CHUNK = 1 << 16  # rays a thread sends at a time: some megabytes
PI = np.float32(np.pi)
# Steps of the lattices in 2 and 3 dimensions as fractions of 2^64.
A1, A2 = (np.uint64(int(step * 2.0**64)) for step in (0.7548776662466927, 0.5698402909980532))
B1, B2, B3 = (
    np.uint64(int(step * 2.0**64)) for step in (0.8191725133961645, 0.6710436067037893, 0.5497004779019703)
)
SHIFT, SCALE = np.uint64(40), np.float32(2.0**-24)


@njit(cache=True, error_model="numpy", nogil=True)
def frame(n):
    """Two unit vectors across a unit vector (T. Duff et al. 2017)."""
    sign = np.float32(1.0) if n[2] >= 0 else np.float32(-1.0)
    a = np.float32(-1.0) / (sign + n[2])
    b = n[0] * n[1] * a
    return (
        np.float32(1.0) + sign * n[0] * n[0] * a, sign * b, -sign * n[0],
        b, sign + n[1] * n[1] * a, -n[1],
    )  # fmt: skip


def _threads() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def in_threads(
    count: int, rays: int, work: Callable[[int, int], object], told: Callable[[float], None] | None = None
) -> None:
    """work(start, stop) over all places of that many rays each, in threads (kernels and Embree let go of the
    interpreter); told: share done."""
    chunk = max(1, _CHUNK // max(rays, 1))
    with ThreadPoolExecutor(_threads()) as pool:
        jobs = [pool.submit(work, start, min(start + chunk, count)) for start in range(0, count, chunk)]
        try:
            for done, job in enumerate(jobs):
                job.result()
                if told is not None:
                    told((done + 1) / len(jobs))
        finally:
            for job in jobs:
                job.cancel()


def seeds_of(seed: int, step: int) -> NDArray[np.uint64]:
    return np.random.default_rng([seed, step]).integers(0, 2**63, 5).astype(np.uint64) * np.uint64(2)
