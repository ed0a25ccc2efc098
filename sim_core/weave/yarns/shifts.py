"""Drafts whose picks are shifts of one another, as in satins and twills: one pick holds all heights.

In stage A mode k along the ends is mode -shift k along the picks, the two dimensions are one, and few of its crossings
touch (in a satin those round the one that interlaces). So the contact is found exactly by an active set, even over
floats so long that the alternating direction method would need millions of iterations. In stage B one pick and one end
are relaxed (`Turns`).
"""

from dataclasses import dataclass
from math import gcd

import numpy as np

__all__ = ["MANY", "Turns", "draft_shift", "shifted_forces", "turns_of"]

MANY = (
    10_000  # crossings, beyond which satins and twills are solved by one pick, and maps are content with less
)
EXCHANGES = 2000
TOGETHER = 30  # exchanges of all crossings that are wrong, then one at a time
ZERO = 1e-9  # of D, and of the largest force


def draft_shift(lift: np.ndarray) -> int | None:
    """By how many ends each pick is the one before it, shifted; None where it is not. lift: (picks, ends) bool."""
    picks, ends = lift.shape
    row = np.concatenate([lift[0], lift[0]])
    for shift in range(ends):
        if np.array_equal(row[ends - shift : 2 * ends - shift], lift[1 % picks]):
            whole = shift * picks % ends == 0 and (lift[0][_places(lift.shape, shift)] == lift).all()
            return shift if whole else None
    return None


def shifted_forces(warp: np.ndarray, weft: np.ndarray, sign: np.ndarray, shift: int):
    """Contact forces of a draft that shifts. Returns force on the warp and gap, both (picks, ends), and exchanges.

    warp: (picks,), weft: (ends,) stiffness of the modes along either yarn, in any unit U.  sign: (picks, ends) +1 where
    the warp is on top.  The gap is in D and at least 1 on its side, the force in U D.
    Returns None where the active set does not settle.
    """
    picks, ends = sign.shape
    along = warp[np.arange(ends) * (shift * picks // ends) % picks]
    together = along * weft
    answer = np.divide(along + weft, together, out=np.zeros(ends), where=together > 0)
    kernel = np.fft.ifft(answer).real
    side = sign[0]
    active = np.zeros(ends, bool)
    for step in (1, -1, shift, -shift):
        active |= np.roll(side, step) != side
    for exchange in range(1, EXCHANGES + 1):
        at = np.flatnonzero(active)
        press, level = _balance(kernel, side, at)
        if press.min() < -ZERO * press.max():  # these pull: let go
            active[at[press < 0] if exchange < TOGETHER else at[press.argmin()]] = False
            if len(set(side[active])) < 2:
                return None
            continue
        force = np.zeros(ends)
        force[at] = side[at] * press
        gap = np.fft.ifft(np.fft.fft(force) * answer).real + level
        gap[at] = side[at]
        deep = 1 - side * gap
        if deep.max() < ZERO:
            places = _places(sign.shape, shift)
            return force[places], gap[places], exchange
        peaks = (deep > ZERO) & (deep >= np.roll(deep, 1)) & (deep >= np.roll(deep, -1))
        active[peaks if exchange < TOGETHER else deep.argmax()] = True
    return None


def _balance(kernel: np.ndarray, side: np.ndarray, at: np.ndarray) -> tuple[np.ndarray, float]:
    """Pressing forces of the crossings `at` that bring all of them to a gap of 1, in balance, and the mean gap."""
    here, count = side[at], len(at)
    matrix = np.zeros((count + 1, count + 1))
    matrix[:count, :count] = kernel[(at[:, None] - at) % len(side)] / kernel[0] * here[:, None] * here
    matrix[:count, count] = matrix[count, :count] = here
    found = np.linalg.solve(matrix, np.append(np.ones(count), 0.0))
    return found[:count] / kernel[0], float(found[count])


def _places(shape: tuple[int, ...], shift: int) -> np.ndarray:
    """(picks, ends) place in the first pick of every crossing."""
    return (np.arange(shape[1]) - shift * np.arange(shape[0])[:, None]) % shape[1]


@dataclass(frozen=True, eq=False)
class Turns:
    """How one end and one pick stand for all: from pick to pick the cloth is the same, `shift` ends further.

    pick: (ends,) the pick that crosses end 0 as pick 0 crosses this end. Every crossing of the one pick is so one of
    the one end, and all forces between them are those on either.
    """

    shift: int
    pick: np.ndarray

    def particles(self, per: int) -> tuple[np.ndarray, int, int]:
        """`turns` of the kernels: (ends,) particle of end 0 for each end; turns of the next end and the next pick."""
        count = len(self.pick)
        return self.pick * per, int(self.pick[1]) * per, (-self.shift) % count * per

    def all_yarns(
        self, per: int, places: list[np.ndarray], force: np.ndarray
    ) -> tuple[list[np.ndarray], np.ndarray]:
        """Places and forces of all yarns from those of one.

        places: side and height of the end, side and height of the pick, (1, n) each; returned as (count, n).
        force: (1, ends) at the crossings of the pick; returned as (count, count).
        """
        count = len(self.pick)
        made = [np.zeros((count, place.shape[1])) for place in places]
        for k in range(count):
            for yarn, turn, of in ((self.shift * k % count, k, 0), (k, self.shift * k, 2)):
                for system in (of, of + 1):
                    made[system][yarn] = np.roll(places[system][0], turn * per)
        return made, force[0][_places((count, count), self.shift)]


def turns_of(lift: np.ndarray) -> Turns | None:
    """The turns of a draft whose picks and ends are all shifts of one; None of any other. lift: (picks, ends) bool."""
    picks, ends = lift.shape
    shift = draft_shift(lift) if picks == ends else None
    if shift is None or gcd(shift, ends) != 1:
        return None
    pick = np.zeros(ends, np.int64)
    pick[np.arange(ends) * shift % ends] = -np.arange(ends) % ends
    return Turns(shift, pick)
