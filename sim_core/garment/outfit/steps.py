"""Dressing steps: what is done to a layer of dress, for how long, and how the cloth is braked and rubbed meanwhile."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Literal

from sim_core.body.pose import Pose
from sim_core.cloth import Contact
from sim_core.garment.pattern import Spot

__all__ = ["GRAVITY", "Belt", "Do", "Step", "Touch"]

GRAVITY = 9.81  # [m/s2]
Do = Literal["sew", "weld", "pin", "release", "close", "pose", "settle", "rest"]


@dataclass(frozen=True)
class Belt:
    """A belt round the wearer, over the layer: at the height of the landmark `mark`, rise [m] above it; drawn to its
    length [m]."""

    length: float
    mark: str = "waist"
    rise: float = 0.0


@dataclass(frozen=True)
class Touch:
    """How cloth touches what lies beneath and itself from a step on; None: as before.

    clearance, sample_clearance [m]; thickness [m] that layers keep from each other; self_friction; separation: share
    of the speed of parting that near layers lose; partly: whether what passed through itself is taken apart as far as
    it goes, or left where it would not come free; untangle: steps a frame in which that is tried, 0: none.
    """

    clearance: float | None = None
    sample_clearance: float | None = None
    thickness: float | None = None
    self_friction: float | None = None
    separation: float | None = None
    partly: bool | None = None
    untangle: int | None = None

    def of(self, contact: Contact) -> Contact:
        """`contact` with what is given here."""
        return replace(contact, **{name: value for name, value in self.__dict__.items() if value is not None})


@dataclass(frozen=True)
class Step:
    """One dressing step.

    do: sew – seams are drawn together, weld – they become one cloth, pin, release – `spots` are held and let go,
    close – `ties` are drawn to their length (none named: all), or `belt` is, pose – the wearer goes to `pose` (None:
    the outfit's), settle, rest – time passes, at most until eight frames in a row move less than `still` [m, p99].
    seconds; gravity [m/s2] from..to; damping [1/s]; friction on what lies beneath (None: the cloth's own); speed
    [m/s] that nothing passes; touch: how it touches from here on; label: what the progress says; key: where a layer's
    table says it, "step.3" or "then.1", for errors.
    """

    do: Do
    seconds: float = 0.0
    gravity: tuple[float, float] = (GRAVITY, GRAVITY)
    damping: float | None = None
    friction: float | None = None
    speed: float | None = None
    still: float | None = None
    spots: tuple[Spot | Literal["nape", "top", "middle", "belt"], ...] = ()
    ties: tuple[str, ...] = ()
    belt: Belt | None = None
    pose: Pose | None = None
    touch: Touch = Touch()
    label: str = ""
    key: str = field(default="", repr=False, compare=False)

    def named(self, number: int) -> str:
        """How errors name it, the number-th of its layer: as its table does, else by that number."""
        return self.key or f"step.{number}"

    @property
    def timed(self) -> bool:
        """Whether time passes in it."""
        return self.do not in ("weld", "pin", "release")
