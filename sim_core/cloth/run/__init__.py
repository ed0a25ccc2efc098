"""Frames after one another: a run through phases, live cloth, checkpoints and certificates."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

from sim_core.cloth.run.adaptive_run import Run, Setup
from sim_core.cloth.run.certificate import Certificate
from sim_core.cloth.run.checkpoint import Checkpoint, RunState, load_checkpoint, save_checkpoint
from sim_core.cloth.run.drape_run import ENGINE_VERSION, RESTED, Drape, drape
from sim_core.cloth.run.live import Live
from sim_core.cloth.run.smoothing import Smoother, smoothed

if TYPE_CHECKING:
    from sim_core.cloth.run.certifier import moved_together, zones_of

__all__ = [
    "Certificate",
    "Checkpoint",
    "Drape",
    "ENGINE_VERSION",
    "RESTED",
    "Live",
    "Run",
    "RunState",
    "Setup",
    "Smoother",
    "drape",
    "load_checkpoint",
    "moved_together",
    "save_checkpoint",
    "smoothed",
    "zones_of",
]

_LATE = {
    "moved_together": "certifier",
    "zones_of": "certifier",
}  # what only the certifier needs takes half a second


def __getattr__(name: str) -> object:
    if name not in _LATE:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_LATE[name]}"), name)
