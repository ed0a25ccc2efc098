"""What a run goes through: the phases that a caller writes, and the one record of what each frame is under."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from sim_core.cloth.contact.layers.repulsion import Shell
from sim_core.cloth.step.haste import HASTE
from sim_core.errors import SimCoreError
from sim_core.validation import excerpt, finite, instance_of, integer, vector, vertex_indices

FRAME = 1 / 25  # [s]
FREE = 1e3  # [m/s] a speed limit from here on is none
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
    rest: float | None = None  # [m] leave the phase early once p99 of eight frames in a row is below
    pins: tuple[int, ...] = ()  # vertices held still in this phase, beside those of the run
    sewing: tuple[float, float] = (
        0.0,
        0.0,
    )  # share of their first distance that sewing pairs may have, from..to
    body: tuple[float, float] | None = None  # keys of a moving body, from..to (None: where it is)

    def __post_init__(self) -> None:
        finite("phase.seconds", self.seconds, above=0, most=MOST_FRAMES * FRAME)
        kept: dict[str, object] = {
            "gravity": vector("phase.gravity", self.gravity, "two finite numbers [m/s2], from and to", 2),
            "sewing": vector("phase.sewing", self.sewing, "two shares, from and to, 0 or more", 2, least=0),
            "pins": vertex_indices("phase.pins", self.pins),
        }
        if self.body is not None:
            kept["body"] = vector("phase.body", self.body, "two keys, from and to, 0 or more", 2, least=0)
        for name, value in kept.items():
            object.__setattr__(self, name, value)
        for name in ("damping", "friction", "speed_limit", "rest"):
            if getattr(self, name) is not None:
                finite(f"phase.{name}", getattr(self, name), least=0)
        instance_of("phase.label", self.label, str, "a text is meant")


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
        integer("contact.every", self.every, 1, "substeps between two looks, 1 or more")
        integer("contact.untangle", self.untangle, 0, "steps after each frame, 0 to 1000", most=1000)
        instance_of("contact.partly", self.partly, bool, "True or False is meant")
        if self.thickness > 0 and self.skin <= 0:
            raise SimCoreError("contact.skin: 0 – self-contact has to look further than its thickness")

    def shell(self) -> Shell:
        """The distances that are kept, as the compiled loops read them."""
        kept = {name: float(getattr(self, name)) for name in Shell._fields if name != "every"}
        if self.thickness > 0.0:  # no push may carry a layer through another
            kept["cap"] = min(kept["cap"], HASTE * kept["thickness"])
        return Shell(**kept, every=int(self.every))


_NO_VERTICES, _NO_VECTORS, _CALM = np.zeros(0, np.int64), np.zeros((0, 3)), np.zeros((2, 3))


class Frame(NamedTuple):
    """What one frame is under, from the schedule to the compiled loop, which reads the same record.

    Vertices are told in the caller's order; the engine renumbers those that its loops read.
    """

    gravity: np.ndarray  # (3,) [m/s2]
    damping: float  # of mass [1/s]
    friction: float  # against solids
    speed_limit: float = FREE  # [m/s]
    sewing: tuple[float, float] = (
        0.0,
        0.0,
    )  # share of their first distance that pairs may have, begin and end
    body: tuple[float, float] = (0.0, 0.0)  # where a moving body stands, in its keys, at begin and end
    wind: np.ndarray = _CALM  # (2, 3) [m/s] at begin and end
    press: float = 0.0  # density Cd / 12 of the air [kg/m3]; 0: none
    pins: np.ndarray = _NO_VERTICES  # (K,) int64 held
    led: np.ndarray = _NO_VERTICES  # (L,) int64 of those, not held where they are but led to
    places: np.ndarray = _NO_VECTORS  # (L, 3) [m], by the frame's end
    pulled: np.ndarray = _NO_VERTICES  # (P,) int64 that are pulled
    pulls: np.ndarray = _NO_VECTORS  # (P, 3) [N]
    phase: int = 0  # number of the phase it is of

    def part(self, early: float, late: float, here: np.ndarray) -> Frame:
        """What holds from `early` to `late`, shares of the frame; here (V, 3) [m]: where the vertices are now."""

        def between(ends: tuple[float, float]) -> tuple[float, float]:
            first, last = ends
            return first + (last - first) * early, first + (last - first) * late

        begin = here[self.led]
        return self._replace(
            sewing=between(self.sewing),
            body=between(self.body),
            wind=np.stack([self.wind_at(early), self.wind_at(late)]),
            places=begin + (self.places - begin) * (late - early) / (1.0 - early),
        )

    def wind_at(self, share: float) -> np.ndarray:
        """The wind (3,) [m/s] when this share of the frame is over."""
        return self.wind[0] + share * (self.wind[1] - self.wind[0])

    @property
    def quiet(self) -> bool:
        """Nothing from outside does work on the cloth but gravity and a wind that only brakes."""
        still = self.sewing[0] == self.sewing[1] and self.body[0] == self.body[1]
        free = not len(self.pulled) and not len(self.led)
        return still and free and (self.press == 0.0 or not np.any(self.wind))


class State(NamedTuple):
    """Where a cloth is and how fast: positions x [m] and velocities v [m/s], (3, V) each, which steps write over."""

    x: np.ndarray
    v: np.ndarray

    def copy(self) -> State:
        """Arrays of its own."""
        return State(self.x.copy(), self.v.copy())


USUAL = Frame(gravity=np.array([0.0, -1.0, 0.0]), damping=0.0, friction=0.0)


def schedule(phases: Sequence[Phase], usual: Frame = USUAL) -> list[Frame]:
    """What each frame is under; gravity is constant within a frame, so that energies compare.

    usual: what holds where a phase says nothing; its gravity (3,) is the way down, which a phase's is counted in, and
    its pins are held in every phase.
    """
    frames: list[Frame] = []
    place = 0.0
    for number, phase in enumerate(phases):
        count = max(1, round(phase.seconds / FRAME))
        path = phase.body or (place, place)
        place = path[1]
        own = usual._replace(
            damping=usual.damping if phase.damping is None else float(phase.damping),
            friction=usual.friction if phase.friction is None else float(phase.friction),
            speed_limit=usual.speed_limit if phase.speed_limit is None else float(phase.speed_limit),
            pins=np.array(sorted({*usual.pins.tolist(), *phase.pins}), np.int64),
            phase=number,
        )
        low, high = phase.gravity
        for k in range(count):
            sewing, body = (
                (a + (b - a) * k / count, a + (b - a) * (k + 1) / count) for a, b in (phase.sewing, path)
            )
            gravity = usual.gravity * (low + (high - low) * (k + 1) / count)
            frames.append(own._replace(gravity=gravity, sewing=sewing, body=body))
    return frames


def checked_phases(phases: Sequence[Phase]) -> tuple[Phase, ...]:
    """The phases of a run; raises SimCoreError where they are none, or too long."""
    try:
        found = tuple(phases)
    except TypeError:
        raise SimCoreError(
            f"phases: {excerpt(phases)} – give a sequence of them, such as [Phase(1.0)]"
        ) from None
    if not found:
        raise SimCoreError("phases: there is none – a run needs one")
    for number, phase in enumerate(found):
        instance_of(f"phases: {number}", phase, Phase, "a Phase is meant")
    frames = sum(max(1, round(phase.seconds / FRAME)) for phase in found)
    if frames > MOST_FRAMES:
        raise SimCoreError(f"phases: {frames} frames – a run has at most {MOST_FRAMES}")
    return found
