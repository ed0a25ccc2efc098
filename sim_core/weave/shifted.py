"""Stage A of drafts whose picks are shifts of one another, as in satins and twills: one pick holds all heights.

Then mode k along the ends is mode -shift k along the picks, the two dimensions are one, and few of its crossings touch
(in a satin those round the one that interlaces). So the contact is found exactly by an active set, even over floats so
long that the alternating direction method would need millions of iterations.
"""

import numpy as np

__all__ = ["draft_shift", "shifted_forces"]

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
