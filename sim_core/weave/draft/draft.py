"""Drafts: one repeat of a weave, its smallest repeat, face and interlacings, and the three basic weaves.

A draft is more than a 0/1 matrix: `Channels` holds what leno, compound weaves, tapestry and brocade need besides.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from math import gcd

import numpy as np

from sim_core.errors import WeaveError

__all__ = ["Channels", "Draft", "check_size", "plain", "satin", "twill"]

MOST = 16_384  # ends or picks of one draft; beyond, it is counted by its factors
MOST_CROSSINGS = 40_000_000
MOST_MOTIF = 1024  # of what a weave file or a picture makes
KINDS = ("main", "inner", "extra")


@dataclass(frozen=True, eq=False)
class Channels:
    """What a lift matrix cannot say; every channel is optional (None).

    end_series: (ends,) int, which set of warp ends (the colours of a compound weave; 1 = doup ends of a leno).
    pick_series: (picks,) int, the same of the wefts.
    pick_kind: (picks,) int, index into ("main", "inner", "extra"): binding pick, inner pick between face and back of
    a compound weave, or supplementary weft that is not part of the ground.
    layer: (picks, ends) int, 0 the face, 1 and more behind it, of the warp end at that pick.
    order: (picks, ends) int, the place (in end spacings from the left) that an end takes at a pick; ends that
    change places between two picks cross there, the doup end (series 1) beneath the other.
    region: (picks, ends) int, number of the weft bobbin (colour) at a crossing, -1 where the pick is not there.
    """

    end_series: np.ndarray | None = None
    pick_series: np.ndarray | None = None
    pick_kind: np.ndarray | None = None
    layer: np.ndarray | None = None
    order: np.ndarray | None = None
    region: np.ndarray | None = None

    def items(self) -> list[tuple[str, np.ndarray]]:
        """The channels that are there, by name."""
        return [(f.name, getattr(self, f.name)) for f in fields(self) if getattr(self, f.name) is not None]


AXES = {
    "end_series": (1,),
    "pick_series": (0,),
    "pick_kind": (0,),
    "layer": (0, 1),
    "order": (0, 1),
    "region": (0, 1),
}


@dataclass(frozen=True, eq=False)
class Draft:
    """One repeat of a weave.

    lift: (picks, ends) bool, True where the warp end passes over the weft pick (a warp point).
    channels: see Channels.  Raises WeaveError where the matrix or a channel has the wrong shape or values.
    """

    name: str
    lift: np.ndarray
    channels: Channels = Channels()

    def __post_init__(self) -> None:
        lift = np.array(self.lift)
        if lift.ndim != 2 or lift.size == 0:
            raise WeaveError(f"draft {self.name}: lift has shape {lift.shape} – give rows of picks by ends")
        check_size(self.name, *lift.shape)
        if lift.dtype != bool and not np.isin(lift, (0, 1)).all():
            raise WeaveError(f"draft {self.name}: lift holds values other than 0 and 1")
        lift = lift.astype(bool)
        lift.setflags(write=False)
        object.__setattr__(self, "lift", lift)
        made = {name: self._channel(name, values) for name, values in self.channels.items()}
        object.__setattr__(self, "channels", Channels(**made))
        self._check_channels()

    def _check_channels(self) -> None:
        """Channels that need one another, and cloths without a weft; raises WeaveError."""
        c = self.channels
        if c.layer is not None and c.end_series is None and c.pick_series is None:
            raise WeaveError(f"draft {self.name}: layer without series – add end_series or pick_series")
        if c.region is not None and c.region.max() < 0:
            raise WeaveError(f"draft {self.name}: region is -1 everywhere – give the weft a colour somewhere")
        if c.pick_kind is not None and (c.pick_kind == KINDS.index("extra")).all():
            raise WeaveError(f"draft {self.name}: every pick is extra – a cloth needs picks of its ground")

    def _channel(self, name: str, values) -> np.ndarray:
        values = np.array(values)
        wanted = tuple(self.lift.shape[axis] for axis in AXES[name])
        if values.shape != wanted or values.dtype.kind not in "iu":
            raise WeaveError(
                f"draft {self.name}: {name} has shape {values.shape} – whole numbers, shape {wanted}"
            )
        least, most = (-1 if name == "region" else 0), (len(KINDS) - 1 if name == "pick_kind" else 4 * MOST)
        if name == "order":
            least = -4 * MOST
        if values.min() < least or values.max() > most:
            raise WeaveError(f"draft {self.name}: {name} holds values outside {least} to {most}")
        values = values.astype(np.int32)
        values.setflags(write=False)
        return values

    def __eq__(self, other: object) -> bool:
        if (
            not isinstance(other, Draft)
            or self.name != other.name
            or not np.array_equal(self.lift, other.lift)
        ):
            return False
        mine, theirs = dict(self.channels.items()), dict(other.channels.items())
        return mine.keys() == theirs.keys() and all(np.array_equal(v, theirs[k]) for k, v in mine.items())

    @property
    def picks(self) -> int:
        return self.lift.shape[0]

    @property
    def ends(self) -> int:
        return self.lift.shape[1]

    @property
    def face(self) -> str:
        """Face class of the paper: "warp" with more warp points than weft points, "weft" with fewer, else "same"."""
        ones = int(self.lift.sum())
        rest = self.lift.size - ones
        return "warp" if ones > rest else "weft" if ones < rest else "same"

    def interlacings(self) -> tuple[np.ndarray, np.ndarray]:
        """How often each end (ends,) and each pick (picks,) changes side within the repeat, cyclically."""
        ends = (self.lift != np.roll(self.lift, -1, axis=0)).sum(axis=0)
        picks = (self.lift != np.roll(self.lift, -1, axis=1)).sum(axis=1)
        return ends, picks

    def loose(self) -> str | None:
        """The first yarn of the ground that never changes side, such as "end 3", or None; it would fall out.

        Ends of a leno may stay on one side: their crossings hold them.
        """
        kind = self.channels.pick_kind
        ground = np.arange(self.picks) if kind is None else np.flatnonzero(kind != KINDS.index("extra"))
        lift = self.lift[ground]
        systems = [(0, "end", np.arange(self.ends)), (1, "pick", ground)]
        for axis, name, numbers in systems[self.channels.order is not None and self.channels.layer is None :]:
            loose = np.flatnonzero(lift.all(axis=axis) | ~lift.any(axis=axis))
            if loose.size:
                return f"{name} {numbers[loose[0]]}"
        return None

    def repeat(self) -> Draft:
        """The same weave in its smallest repeat of ends and picks (all channels repeat as well)."""
        # An order may run on by a whole repeat of places; its steps are what repeats.
        picks, ends = (_period(self, axis) for axis in (0, 1))
        if (picks, ends) == self.lift.shape:
            return self
        cut = {
            name: values[:picks, :ends] if len(AXES[name]) == 2 else values[: (picks, ends)[AXES[name][0]]]
            for name, values in self.channels.items()
        }
        return Draft(self.name, self.lift[:picks, :ends], Channels(**cut))

    def renamed(self, name: str) -> Draft:
        """The same draft under another name."""
        return replace(self, name=name)

    def back(self) -> Draft:
        """The same cloth seen from the other side, turned about a pick (ends in opposite order); lift only."""
        return Draft(f"{self.name} (back)", ~self.lift[:, ::-1])


def _period(draft: Draft, axis: int) -> int:
    """Smallest count of picks (axis 0) or ends (axis 1) after which lift and every channel repeat."""
    count = draft.lift.shape[axis]
    ends = np.arange(draft.ends)
    # places are told from the end's own column, so that they repeat across the cloth as the lift does
    layers = [
        (values - ends if name == "order" else values, AXES[name])
        for name, values in draft.channels.items()
        if axis in AXES[name]
    ]
    layers.append((draft.lift, (0, 1)))
    for period in range(1, count):
        if count % period == 0 and all(
            np.array_equal(values, np.roll(values, -period, axis=axes.index(axis))) for values, axes in layers
        ):
            return period
    return count


def check_size(name: str, *counts: int) -> None:
    """Raises WeaveError where a draft would have more ends or picks (one count: as many of both) than can be held."""
    if max(counts) > MOST:
        raise WeaveError(f"draft {name}: {max(counts):,} yarns – give at most {MOST:,} ends and picks")
    crossings = counts[0] * counts[-1]
    if crossings > MOST_CROSSINGS:
        raise WeaveError(f"draft {name}: {crossings:,} crossings – give at most {MOST_CROSSINGS:,}")


def plain() -> Draft:
    """Tabby, 1/1: every yarn goes over one and under one."""
    return Draft("plain", np.eye(2, dtype=bool))


def twill(up: int, down: int, step: int = 1) -> Draft:
    """A regular twill: each end goes over `up` and under `down` picks, moved by `step` from end to end.

    With step 1 the line rises to the right, pick 0 lowest: a Z twill.

    step: +1 rises to later picks with later ends, -1 falls; it must share no factor with up + down.
    """
    size = up + down
    if up < 1 or down < 1 or size < 3:
        raise WeaveError(f"twill {up}/{down}: floats must be at least 1 and their sum at least 3")
    check_size(f"twill {up}/{down}", size)
    if gcd(abs(step), size) != 1:
        raise WeaveError(f"twill {up}/{down}: step {step} shares a factor with {size} – choose one without")
    picks, ends = np.indices((size, size))
    return Draft(f"twill {up}/{down}", (picks - step * ends) % size < up)


def satin(ends: int, step: int) -> Draft:
    """A warp-faced regular satin over `ends` ends: one weft point an end, moved by `step` picks from end to end.

    Regular satins need gcd(ends, step) = 1 and 1 < step < ends - 1, so that no two binding points touch.
    """
    if ends < 5:
        raise WeaveError(f"satin of {ends}: a regular satin needs 5 ends, or 7 and more")
    check_size(f"satin of {ends}", ends)
    if not 1 < step < ends - 1:
        raise WeaveError(f"satin {ends}: step {step} makes a twill – choose 1 < step < {ends - 1}")
    if gcd(ends, step) != 1:
        good = [s for s in range(2, ends - 1) if gcd(ends, s) == 1]
        remedy = f"choose one of {good}" if good else "no regular satin has so many ends"
        raise WeaveError(f"satin {ends}: step {step} shares a factor with {ends} – {remedy}")
    picks, columns = np.indices((ends, ends))
    return Draft(f"satin {ends}/{step}", (picks - step * columns) % ends != 0)
