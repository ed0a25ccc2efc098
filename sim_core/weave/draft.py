"""Drafts: which yarn lies on top at each crossing of one repeat, and the generators of the three basic weaves."""

from dataclasses import dataclass
from math import gcd

import numpy as np

from sim_core.errors import WeaveError

__all__ = ["Draft", "plain", "satin", "twill"]

MOST = 256  # ends or picks of one repeat; to relax that many takes up to a minute


@dataclass(frozen=True, eq=False)
class Draft:
    """One repeat of a weave.

    lift: (picks, ends) bool, True where the warp end passes over the weft pick (a warp point).
    Raises WeaveError where a yarn never interlaces, since such a yarn would fall out of the cloth.
    """

    name: str
    lift: np.ndarray

    def __post_init__(self) -> None:
        lift = np.array(self.lift)
        if lift.ndim != 2 or lift.size == 0:
            raise WeaveError(f"draft {self.name}: lift has shape {lift.shape} – give rows of picks by ends")
        _check_size(self.name, *lift.shape)
        if not np.isin(lift, (0, 1)).all():
            raise WeaveError(f"draft {self.name}: lift holds values other than 0 and 1")
        lift = lift.astype(bool)
        for axis, kind in ((0, "end"), (1, "pick")):
            loose = np.flatnonzero(lift.all(axis=axis) | ~lift.any(axis=axis))
            if loose.size:
                raise WeaveError(
                    f"draft {self.name}: {kind} {loose[0]} never interlaces – it needs both warp and weft points"
                )
        lift.setflags(write=False)
        object.__setattr__(self, "lift", lift)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Draft) and self.name == other.name and np.array_equal(self.lift, other.lift)

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

    def float_lengths(self) -> dict[str, list[int]]:
        """Cyclic float lengths on the face, in crossings: of the warp ends over picks, of the picks over ends."""
        return {
            "warp": sorted(run for end in self.lift.T for run in _runs(end)),
            "weft": sorted(run for pick in ~self.lift for run in _runs(pick)),
        }

    def interlacings(self) -> tuple[np.ndarray, np.ndarray]:
        """How often each end (ends,) and each pick (picks,) changes side within the repeat, cyclically."""
        ends = (self.lift != np.roll(self.lift, -1, axis=0)).sum(axis=0)
        picks = (self.lift != np.roll(self.lift, -1, axis=1)).sum(axis=1)
        return ends, picks

    def back(self) -> "Draft":
        """The same cloth seen from the other side, turned about a pick (ends in opposite order)."""
        return Draft(f"{self.name} (back)", ~self.lift[:, ::-1])


def _check_size(name: str, *counts: int) -> None:
    if max(counts) > MOST:
        raise WeaveError(
            f"draft {name}: a repeat of {max(counts)} yarns – give at most {MOST} ends and picks"
        )


def _runs(cycle: np.ndarray) -> list[int]:
    """Lengths of the runs of True in a cyclic sequence."""
    if cycle.all():
        return [cycle.size]
    if not cycle.any():
        return []
    start = int(np.flatnonzero(~cycle)[0])
    runs, length = [], 0
    for value in np.roll(cycle, -start):
        if value:
            length += 1
        elif length:
            runs.append(length)
            length = 0
    return [*runs, length] if length else runs


def plain() -> Draft:
    """Tabby, 1/1: every yarn goes over one and under one."""
    return Draft("plain", np.eye(2, dtype=bool))


def twill(up: int, down: int, step: int = 1) -> Draft:
    """A regular twill: each end goes over `up` and under `down` picks, moved by `step` from end to end.

    step: +1 rises to later picks with later ends, -1 falls; it must share no factor with up + down.
    """
    size = up + down
    if up < 1 or down < 1 or size < 3:
        raise WeaveError(f"twill {up}/{down}: floats must be at least 1 and their sum at least 3")
    _check_size(f"twill {up}/{down}", size)
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
    _check_size(f"satin of {ends}", ends)
    if not 1 < step < ends - 1:
        raise WeaveError(f"satin {ends}: step {step} makes a twill – choose 1 < step < {ends - 1}")
    if gcd(ends, step) != 1:
        good = [s for s in range(2, ends - 1) if gcd(ends, s) == 1]
        raise WeaveError(
            f"satin {ends}: step {step} shares a factor with {ends} – choose one of {good or 'none'}"
        )
    picks, columns = np.indices((ends, ends))
    return Draft(f"satin {ends}/{step}", (picks - step * columns) % ends != 0)
