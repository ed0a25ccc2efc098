"""What a run goes through: phases of gravity, damping, friction, sewing and a moving body, frame by frame."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from sim_core.errors import SimCoreError
from sim_core.validation import finite, of_kind, row, told, vertex_numbers, whole

__all__ = ["FRAME", "Contact", "Moment", "Phase", "checked_phases", "schedule"]

FRAME = 1 / 25  # [s]
MOST_FRAMES = 1_000_000  # of a run: eleven hours of cloth
WIDEST = 1.0  # [m] that a cloth may keep away from things and from itself


@dataclass(frozen=True)
class Phase:
    """A stretch of a run: seconds, gravity [m/s2] from..to, mass damping [1/s], friction (None: the material's).

    Raises SimCoreError, naming the value, for what cannot be run.
    """

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

    def __post_init__(self) -> None:
        finite("phase.seconds", self.seconds, above=0, most=MOST_FRAMES * FRAME)
        kept: dict[str, object] = {
            "gravity": row("phase.gravity", self.gravity, "two finite numbers [m/s2], from and to", 2),
            "sewing": row("phase.sewing", self.sewing, "two shares, from and to, 0 or more", 2, least=0),
            "pins": vertex_numbers("phase.pins", self.pins),
        }
        if self.body is not None:
            kept["body"] = row("phase.body", self.body, "two keys, from and to, 0 or more", 2, least=0)
        for name, value in kept.items():
            object.__setattr__(self, name, value)
        for name in ("damping", "friction", "speed_limit", "rest"):
            if getattr(self, name) is not None:
                finite(f"phase.{name}", getattr(self, name), least=0)
        of_kind("phase.label", self.label, str, "a text is meant")


@dataclass(frozen=True)
class Contact:
    """How the cloth touches: clearance [m] of vertices and of midpoints and centroids, self-contact shell.

    thickness [m] is the distance two layers of cloth keep (0: no self-contact). untangle: in how many steps of a tenth
    of it, after each frame, the cloth is taken out of itself where it passed through (0: it is left so); partly: also
    where some of it stays, for a start that is tangled. separation: share of the speed at which near layers part that
    they lose; with little of it squeezed folds bounce in their shell for ever. Raises SimCoreError, naming the value,
    for what has no meaning.
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

    def __post_init__(self) -> None:
        for name in ("clearance", "sample_clearance", "thickness", "skin", "cap"):
            finite(f"contact.{name} [m]", getattr(self, name), least=0, most=WIDEST)
        for name in ("spring", "separation", "self_friction", "speed_limit"):
            finite(f"contact.{name}", getattr(self, name), least=0)
        whole("contact.every", self.every, 1, "substeps between two looks, 1 or more")
        whole("contact.untangle", self.untangle, 0, "steps after each frame, 0 to 1000", most=1000)
        of_kind("contact.partly", self.partly, bool, "True or False is meant")
        if self.thickness > 0 and self.skin <= 0:
            raise SimCoreError("contact.skin: 0 – self-contact has to look further than its thickness")


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


def checked_phases(phases: Sequence[Phase]) -> tuple[Phase, ...]:
    """The phases of a run; raises SimCoreError where they are none, or too long."""
    try:
        found = tuple(phases)
    except TypeError:
        raise SimCoreError(
            f"phases: {told(phases)} – give a sequence of them, such as [Phase(1.0)]"
        ) from None
    if not found:
        raise SimCoreError("phases: there is none – a run needs one")
    for number, phase in enumerate(found):
        of_kind(f"phases: {number}", phase, Phase, "a Phase is meant")
    frames = sum(max(1, round(phase.seconds / FRAME)) for phase in found)
    if frames > MOST_FRAMES:
        raise SimCoreError(f"phases: {frames} frames – a run has at most {MOST_FRAMES}")
    return found
