"""Frames after one another: a run through phases, live cloth, checkpoints and certificates."""

from sim_core.cloth.run.adaptive_run import Run
from sim_core.cloth.run.certificate import Certificate
from sim_core.cloth.run.checkpoint import RunState, load_checkpoint, save_checkpoint
from sim_core.cloth.run.drape_run import ENGINE_VERSION, Drape, drape
from sim_core.cloth.run.live import Live
from sim_core.cloth.run.smoothing import Smoother, smoothed
from sim_core.cloth.run.zones import moved_together, zones_of

__all__ = [
    "Certificate",
    "Drape",
    "ENGINE_VERSION",
    "Live",
    "Run",
    "RunState",
    "Smoother",
    "drape",
    "load_checkpoint",
    "moved_together",
    "save_checkpoint",
    "smoothed",
    "zones_of",
]
