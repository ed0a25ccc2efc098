"""What the certifier tells of a run."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Certificate:
    """What the certifier saw: frames that it certified, that were done again, and that it could not certify.

    zones: how often vertices had to be moved together; intersections: (edge, face) pairs of the cloth, and of cloth
    and solid, that pass through each other at the end; seconds: what looking cost in this process.
    """

    frames: int
    redone: int
    uncertified: int
    zones: int
    intersections: int
    seconds: float


@dataclass
class Tally:
    """What the certifier did so far: frames done again, zones made, frames it could not certify."""

    redone: int = 0
    zones: int = 0
    uncertified: int = 0
