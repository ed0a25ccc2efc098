"""What a bench signs its figures with: the day and the machine; and what a file of figures tells of both."""

from __future__ import annotations

import datetime
import os
import platform
from collections.abc import Iterable
from pathlib import Path
from typing import Any

__all__ = ["MARKS", "days", "machine", "machines", "parts", "processor", "signed"]

MARKS = ("measured", "machine")  # the keys that hold them
# Counted before a bench holds itself to one of them.
CORES = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()


def processor() -> str:
    """The processor's name, where the system tells it."""
    cpus = Path("/proc/cpuinfo")
    lines = cpus.read_text().splitlines() if cpus.is_file() else []
    return next((t.split(":")[1].strip() for t in lines if t.startswith("model name")), platform.machine())


def machine() -> dict[str, Any]:
    """The processor and how many of its cores a bench may use."""
    return {"processor": processor(), "cores": CORES}


def signed(found: dict[str, Any], made: Iterable[str] | None = None) -> dict[str, Any]:
    """The figures with today and this machine.

    made: of a file that is filled part by part, the parts that were measured now; the others keep their own day.
    """
    now = dict(zip(MARKS, (datetime.date.today().isoformat(), machine()), strict=True))
    if made is None:
        return found | now
    names = list(made)
    return found | {mark: found.get(mark, {}) | dict.fromkeys(names, told) for mark, told in now.items()}


def parts(found: dict[str, Any]) -> dict[str, Any]:
    """The figures without what they are signed with."""
    return {name: value for name, value in found.items() if name not in MARKS}


def days(found: dict[str, Any]) -> list[str]:
    """The days on which all of a file was measured, the earliest first; none where any of it does not tell."""
    return sorted(set(_told(found, "measured")))


def machines(found: dict[str, Any]) -> list[dict[str, Any]]:
    """The machines on which all of a file was measured; none where any of it does not tell."""
    kept: list[dict[str, Any]] = []
    for one in _told(found, "machine"):
        if one not in kept:
            kept.append(one)
    return kept


def _told(found: dict[str, Any], mark: str) -> list[Any]:
    """A mark of the whole file, or of each of its parts."""
    told = found.get(mark)
    if told is None or isinstance(told, str) or "processor" in told:
        return [] if told is None else [told]
    own = found["scenes"] if isinstance(found.get("scenes"), dict) else parts(found)
    measured = [name for name, value in own.items() if isinstance(value, dict | list)]
    return [told[name] for name in measured] if set(measured) <= set(told) else []
