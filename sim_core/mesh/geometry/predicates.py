"""Exact signs of `orient` and `incircle` for float64 points: a rounding filter first, expansions where it is unsure.

The filters are static error bounds; what they leave open is settled by sums of floats that do not overlap
("expansions", Shewchuk 1997: error-free sums and products, nothing is ever rounded). So the sign is that of the real
number for any float64 points whose coordinates are zero or between 1e-60 and 1e60 in size; beyond that a product may
leave the range of float64. `tests` hold both against Python's rational numbers.
"""

import numpy as np
from numba import njit

__all__ = ["INCIRCLE_BOUND", "ORIENT_BOUND", "incircle", "orient"]

UNIT = 2.0**-53
ORIENT_BOUND = 4 * UNIT  # (3 + 16 u) u in Shewchuk's count of roundings
INCIRCLE_BOUND = 16 * UNIT  # of the form in `incircle`, whose roundings add to 11 u (argument in the README)
SPLITTER = 2.0**27 + 1
MOST_TERMS = 4096  # of an expansion: two-term differences make at most 3 * 512 terms in `incircle`


@njit(cache=True)
def orient(ax, ay, bx, by, cx, cy):
    """A number whose sign is exactly that of the area of a, b, c: > 0 where c lies left of a -> b (y up)."""
    left, right = (bx - ax) * (cy - ay), (by - ay) * (cx - ax)
    area = left - right
    if abs(area) > ORIENT_BOUND * (abs(left) + abs(right)):
        return area
    if left == 0.0 and right == 0.0:  # differences of floats vanish only where the floats are equal
        return 0.0
    return float(_exact_orient(ax, ay, bx, by, cx, cy))


@njit(cache=True)
def incircle(ax, ay, bx, by, cx, cy, dx, dy):
    """Sign of d against the circle through a, b, c (counter-clockwise, y up): 1 inside, 0 on it, -1 outside. Exact."""
    ux, uy, vx, vy, wx, wy = bx - ax, by - ay, cx - ax, cy - ay, dx - ax, dy - ay
    us, vs, ws = ux * ux + uy * uy, vx * vx + vy * vy, wx * wx + wy * wy
    total = (uy * vs - vy * us) * wx + (vx * us - ux * vs) * wy + (ux * vy - uy * vx) * ws
    size = (abs(uy) * vs + abs(vy) * us) * abs(wx) + (abs(vx) * us + abs(ux) * vs) * abs(wy)
    bound = INCIRCLE_BOUND * (size + (abs(ux * vy) + abs(uy * vx)) * ws)
    if total < -bound:
        return 1
    if total > bound:
        return -1
    return -_exact_incircle(ax, ay, bx, by, cx, cy, dx, dy)


@njit(cache=True)
def _exact_orient(ax, ay, bx, by, cx, cy):
    terms, room = np.zeros((6, 2)), np.zeros((5, 64))
    counts = np.zeros(6, np.int64)
    for k, (p, q) in enumerate(((bx, ax), (cy, ay), (by, ay), (cx, ax))):
        counts[k] = _difference(p, q, terms[k])
    left = _product(terms[0], counts[0], terms[1], counts[1], room[0], room[3], room[4])
    right = _product(terms[2], counts[2], terms[3], counts[3], room[1], room[3], room[4])
    room[1, :right] *= -1.0
    return _sign(room[2], _sum(room[0], left, room[1], right, room[2]))


@njit(cache=True)
def _exact_incircle(ax, ay, bx, by, cx, cy, dx, dy):
    """Sign of the 3 x 3 determinant of the differences to a, lifted by their squares."""
    terms, counts = np.zeros((6, 2)), np.zeros(6, np.int64)
    for k, (p, q) in enumerate(((bx, ax), (by, ay), (cx, ax), (cy, ay), (dx, ax), (dy, ay))):
        counts[k] = _difference(p, q, terms[k])
    plain = counts.max() <= 1  # all differences are floats themselves, as on a lattice: everything is short
    few, many = (8, 128) if plain else (64, MOST_TERMS)
    short, long = np.zeros((6, few)), np.zeros((4, many))
    minor, lifted = short[4], short[5]
    part, spare, total, other = long[0], long[1], long[2], long[3]
    length = 0
    for i in range(3):  # the minor of two points times the square of the third
        u, v, w = 2 * i, 2 * ((i + 1) % 3), 2 * ((i + 2) % 3)
        p = _product(terms[u], counts[u], terms[v + 1], counts[v + 1], short[0], short[2], short[3])
        q = _product(terms[u + 1], counts[u + 1], terms[v], counts[v], short[1], short[2], short[3])
        short[1, :q] *= -1.0
        minors = _sum(short[0], p, short[1], q, minor)
        p = _product(terms[w], counts[w], terms[w], counts[w], short[0], short[2], short[3])
        q = _product(terms[w + 1], counts[w + 1], terms[w + 1], counts[w + 1], short[1], short[2], short[3])
        squares = _sum(short[0], p, short[1], q, lifted)
        whole = _product(minor, minors, lifted, squares, part, spare, other)
        length = _sum(total, length, part, whole, spare)
        total[:length] = spare[:length]
    return _sign(total, length)


@njit(cache=True)
def _difference(a, b, out):
    """a - b as an expansion of one or two terms, least first; returns their number (0 for zero)."""
    x = a - b
    turned = a - x
    y = (a - (x + turned)) + (turned - b)
    count = 0
    if y != 0.0:
        out[0] = y
        count = 1
    if x != 0.0:
        out[count] = x
        count += 1
    return count


@njit(cache=True)
def _sum(e, e_count, f, f_count, out):
    """Sum of two expansions into `out` without zeros (Shewchuk's expansion sum, one term after the other)."""
    out[:e_count] = e[:e_count]
    count = e_count
    for k in range(f_count):
        carry, kept = f[k], 0
        for i in range(count):
            x = carry + out[i]
            turned = x - carry
            y = (carry - (x - turned)) + (out[i] - turned)
            carry = x
            if y != 0.0:
                out[kept] = y
                kept += 1
        if carry != 0.0:
            out[kept] = carry
            kept += 1
        count = kept
    return count


@njit(cache=True)
def _product(e, e_count, f, f_count, out, row, spare):
    """Product of two expansions into `out`: e times each term of f, summed up."""
    count = 0
    for k in range(f_count):
        b, rows = f[k], 0
        high = SPLITTER * b
        b_high = high - (high - b)
        b_low = b - b_high
        for i in range(e_count):
            x = e[i] * b
            high = SPLITTER * e[i]
            e_high = high - (high - e[i])
            e_low = e[i] - e_high
            y = e_low * b_low - (((x - e_high * b_high) - e_low * b_high) - e_high * b_low)
            for term in (y, x):  # grow the row by one term
                carry, kept = term, 0
                for m in range(rows):
                    z = carry + row[m]
                    turned = z - carry
                    y2 = (carry - (z - turned)) + (row[m] - turned)
                    carry = z
                    if y2 != 0.0:
                        row[kept] = y2
                        kept += 1
                if carry != 0.0:
                    row[kept] = carry
                    kept += 1
                rows = kept
        total = _sum(out, count, row, rows, spare)
        out[:total] = spare[:total]
        count = total
    return count


@njit(cache=True)
def _sign(e, count):
    """Sign of an expansion: that of its last and largest term."""
    if count == 0:
        return 0
    return 1 if e[count - 1] > 0 else -1
