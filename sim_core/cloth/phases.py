"""What a run goes through: phases of gravity, damping, friction, sewing and a moving body, frame by frame."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from numbers import Real

import numpy as np

from sim_core.cloth.given import FURTHEST, finite, vertex_numbers, whole
from sim_core.errors import SimCoreError

__all__ = [
    "FRAME",
    "Contact",
    "Moment",
    "Phase",
    "check_contact",
    "check_gravity",
    "check_phases",
    "schedule",
]

FRAME = 1 / 25  # [s]


@dataclass(frozen=True)
class Phase:
    """A stretch of a run: seconds, gravity [m/s2] from..to, mass damping [1/s], friction (None: the material's)."""

    seconds: float
    gravity: tuple[float, float] = (9.81, 9.81)
    damping: float | None = None
    friction: float | None = None
    label: str = "draping"
    speed_limit: float | None = None  # [m/s] of this phase (None: the contact's); tames a strained start
    rest: float | None = None  # [m] leave the phase early once the p99 displacement per frame is below
    pins: tuple[int, ...] = ()  # vertices held still in this phase, beside those of the run
    sewing: tuple[float, float] = (
        0.0,
        0.0,
    )  # share of their first distance that sewing pairs may have, from..to
    body: tuple[float, float] | None = None  # keys of a moving body, from..to (None: where it is)


@dataclass(frozen=True)
class Contact:
    """How the cloth touches: clearance [m] of vertices and of midpoints and centroids, self-contact shell.

    thickness [m] is the distance two layers of cloth keep (0: no self-contact). untangle: in how many steps of a tenth
    of it, after each frame, the cloth is taken out of itself where it passed through (0: it is left so); partly: also
    where some of it stays, for a start that is tangled. separation: share of the speed at which near layers part that
    they lose; with little of it squeezed folds bounce in their shell for ever.
    """

    clearance: float = 0.003
    sample_clearance: float = 0.001
    thickness: float = 0.0
    skin: float = 0.008
    spring: float = 0.03
    separation: float = 0.05
    self_friction: float = 0.2
    every: int = 1
    cap: float = 0.0005
    speed_limit: float = 1e3
    untangle: int = 0
    partly: bool = False


@dataclass(frozen=True)
class Moment:
    """What holds during one frame: its phase, gravity [m/s2], sewing share and body key at its begin and end."""

    phase: Phase
    gravity: float
    sewing: tuple[float, float]
    body: tuple[float, float]


def schedule(phases: Sequence[Phase]) -> list[Moment]:
    """What each frame is under; gravity is constant within a frame, so that energies compare."""
    frames: list[Moment] = []
    place = 0.0
    for phase in phases:
        count = max(1, round(phase.seconds / FRAME))
        low, high = phase.gravity
        path = phase.body or (place, place)
        place = path[1]
        for k in range(count):
            ends = [(a + (b - a) * k / count, a + (b - a) * (k + 1) / count) for a, b in (phase.sewing, path)]
            frames.append(Moment(phase, low + (high - low) * (k + 1) / count, ends[0], ends[1]))
    return frames


def check_phases(phases: Sequence[Phase]) -> None:
    """Raises SimCoreError, naming the phase and the value, for what cannot be run."""
    if not phases:
        raise SimCoreError("phases: there is none – a run needs one")
    for number, phase in enumerate(phases):
        if not isinstance(phase, Phase):
            raise SimCoreError(f"phases: {number} is a {type(phase).__name__} – a Phase is meant")
        if not (isinstance(phase.seconds, Real) and np.isfinite(phase.seconds) and phase.seconds > 0):
            raise SimCoreError(f"phases: {number} lasts {phase.seconds} s – a finite duration above 0")
        if not (np.isfinite(phase.gravity) & (np.abs(phase.gravity) <= FURTHEST)).all():
            raise SimCoreError(f"phases: {number} has gravity {phase.gravity} – two finite numbers [m/s2]")
        for name in ("damping", "friction", "speed_limit", "rest"):
            if getattr(phase, name) is not None:
                finite(f"phases: {number}: {name}", getattr(phase, name), least=0)
        for name in ("sewing", "body"):
            for value in getattr(phase, name) or ():
                finite(f"phases: {number}: {name}", value, least=0)
        vertex_numbers(f"phases: {number}: pins", phase.pins)


def check_contact(contact: Contact) -> None:
    """Raises SimCoreError, naming the value, for a contact that has no meaning."""
    if not isinstance(contact, Contact):
        raise SimCoreError(f"contact: a {type(contact).__name__} – a Contact is meant")
    for name in ("clearance", "sample_clearance", "thickness", "skin", "spring", "self_friction", "cap"):
        finite(f"contact.{name}", getattr(contact, name), least=0)
    finite("contact.speed_limit", contact.speed_limit, least=0)
    finite("contact.separation", contact.separation, least=0)
    whole("contact.every", contact.every, 1, "substeps between two looks, 1 or more")
    whole("contact.untangle", contact.untangle, 0, "steps after each frame, 0 or more")
    if contact.thickness > 0 and contact.skin <= 0:
        raise SimCoreError("contact.skin: 0 – self-contact has to look further than its thickness")


def check_gravity(gravity: np.ndarray) -> None:
    """Raises SimCoreError where gravity, or the way down, is not three finite numbers."""
    if gravity.shape != (3,) or not (np.isfinite(gravity) & (np.abs(gravity) <= FURTHEST)).all():
        raise SimCoreError(f"gravity: {gravity.tolist()} – expected three finite numbers (x, y, z)")
