"""Contact of two curves at their closest pairs of places, between the particles too.

Both yarns of a crossing are Catmull-Rom curves through their particles. Contact at particles alone lets slanting yarns
meet between them. So once the yarns are at rest, every local minimum of the distance over both curves that overlaps is
pinned: this place of one yarn may not come closer to the curve of the other either, and hands its force to the four
particles round it. The place stays and only its partner slides along, since yarns that slide sideways would leave a
pair of fixed places; a pair of which both are followed jumps where yarns wrap each other, for there the distance hardly
changes along them. In the bowl of the other yarn the partner is held to the flank where it was found.

Places s along the warp and t along the weft count in pieces between particles, from the crossing. Sections are flat:
the norm is (dx / wide_x)^2 + dy^2 + dz^2 round the warp, and dx^2 + (dy / wide_y)^2 + dz^2 round the weft.
"""

from math import floor, sqrt

import numpy as np
from numba import njit

from sim_core.weave.yarns.particles.forces import set_out, touch

__all__ = ["curve_gaps", "curve_overlap", "pin_forces"]

APART = 0.02  # of a piece: pins of one crossing and norm that are nearer are one
POLISH = 12  # steps of Newton
BOWL = 0.02  # determinant relative to straight yarns that cross, above which Newton's step is taken
NEAR = 1.2  # norm on the grid up to which a minimum is polished
LOW = 0.05  # least height in the norm: yarns on the wrong side are still pushed apart


@njit(cache=True, error_model="numpy")
def place_on(u, z, yarn, base, s):
    """(side, height) of the curve at s pieces from particle `base`, their first and their second derivatives by s."""
    count = u.shape[1]
    k = int(floor(s))
    f = s - k
    n1 = (base + k) % count
    n0, n2, n3 = (n1 - 1) % count, (n1 + 1) % count, (n1 + 2) % count
    g = 1.0 - f
    w0, w3 = -0.5 * f * g * g, -0.5 * f * f * g
    w1, w2 = 1.0 + f * f * (1.5 * f - 2.5), 1.0 + g * g * (1.5 * g - 2.5)
    v0, v3 = -0.5 * g * (g - 2 * f), -0.5 * f * (2 * g - f)
    v1, v2 = f * (4.5 * f - 5.0), -g * (4.5 * g - 5.0)
    a0, a1, a2, a3 = 2.0 - 3.0 * f, 9.0 * f - 5.0, 4.0 - 9.0 * f, 3.0 * f - 1.0
    p0, p1, p2, p3 = u[yarn, n0], u[yarn, n1], u[yarn, n2], u[yarn, n3]
    q0, q1, q2, q3 = z[yarn, n0], z[yarn, n1], z[yarn, n2], z[yarn, n3]
    return (
        w0 * p0 + w1 * p1 + w2 * p2 + w3 * p3, w0 * q0 + w1 * q1 + w2 * q2 + w3 * q3,
        v0 * p0 + v1 * p1 + v2 * p2 + v3 * p3, v0 * q0 + v1 * q1 + v2 * q2 + v3 * q3,
        a0 * p0 + a1 * p1 + a2 * p2 + a3 * p3, a0 * q0 + a1 * q1 + a2 * q2 + a3 * q3,
    )  # fmt: skip


@njit(cache=True, error_model="numpy")
def polished(s, t, wu, wz, end, base1, l1, fu, fz, pick, base2, l2, over_x, over_y, sign):
    """Newton from (s, t) to the nearest local minimum of the norm. Returns (s, t, squared norm).

    over_x, over_y: 1 / the square of the half widths.
    """
    square = 9.0
    for step in range(POLISH + 1):
        u, z, du, dz, ddu, ddz = place_on(wu, wz, end, base1, s)
        v, y, dv, dy, ddv, ddy = place_on(fu, fz, pick, base2, t)
        x, d, h = (u - t * l2) * over_x, (s * l1 - v) * over_y, z - y
        high = max(sign * h, LOW)
        square = x * x / over_x + d * d / over_y + high * high
        if step == POLISH:
            break
        fs, ft = x * du + d * l1 + h * dz, -(x * l2 + d * dv + h * dy)
        along1 = du * du * over_x + l1 * l1 * over_y + dz * dz
        along2 = l2 * l2 * over_x + dv * dv * over_y + dy * dy
        ss, tt = along1 + x * ddu + h * ddz, along2 - d * ddv - h * ddy
        st = -(du * l2 * over_x + l1 * dv * over_y + dz * dy)
        det = ss * tt - st * st
        if ss > 0.0 and det > BOWL * along1 * along2:
            ms, mt = (st * ft - tt * fs) / det, (st * fs - ss * ft) / det
        else:  # no bowl: downhill by steps that straight yarns would allow
            ms, mt = -0.5 * fs / along1, -0.5 * ft / along2
        ms, mt = min(max(ms, -0.5), 0.5), min(max(mt, -0.5), 0.5)
        if abs(ms) + abs(mt) < 1e-7:
            break
        s, t = s + ms, t + mt
    return s, t, square


@njit(cache=True, error_model="numpy")
def half_pieces(u, z, yarn, base, reach, out):
    """(side, height) of a curve at every half piece up to `reach` both ways from particle `base`, into out."""
    for a in range(4 * reach + 1):
        out[a, 0], out[a, 1], _, _, _, _ = place_on(u, z, yarn, base, 0.5 * a - reach)


@njit(cache=True, error_model="numpy")
def least_by_line(warp, weft, reach1, reach2, l1, l2, over_x, over_y, sign, norm, grid, least, where):
    """Least squared norm along each line across the one yarn, in the second norm across the other, and where it is.

    warp, weft: as half_pieces wrote them.  grid, least, where: written.  Returns how many lines there are.
    """
    rows, columns = 4 * reach1 + 1, 4 * reach2 + 1
    for a in range(rows):
        for b in range(columns):
            x = warp[a, 0] - (0.5 * b - reach2) * l2
            d = (0.5 * a - reach1) * l1 - weft[b, 0]
            high = max(sign * (warp[a, 1] - weft[b, 1]), LOW)
            grid[a, b] = x * x * over_x + d * d * over_y + high * high
    lines = columns if norm else rows
    for a in range(lines):
        line = grid[:, a] if norm else grid[a]
        where[a] = np.argmin(line)
        least[a] = line[where[a]]
    return lines


@njit(cache=True, error_model="numpy")
def is_minimum(least, a, lines):
    """Whether line a is no farther than its neighbours, and near enough to be polished."""
    here = least[a]
    if here > NEAR * NEAR or (a > 0 and least[a - 1] < here):
        return False
    return not (a < lines - 1 and least[a + 1] < here)


@njit(cache=True, error_model="numpy")
def curve_overlap(wu, wz, fu, fz, lift, per, l1, l2, wide_x, wide_y, reach1, reach2, pins, least_deep, turns):
    """Deepest overlap [D] of the curves of crossing yarns, whatever the particles touch, and the pins it asks for.

    wu, wz: (ends, picks * per), fu, fz: (picks, ends * per).  pins: (n, 6) pick, end, norm (0 round the warp, 1 round
    the weft), place t along the weft or s along the warp, how many pieces beside it the partner lies, and by how much
    the contact is set out [D]; those that there are.  least_deep: overlap [D] from which
    a place is pinned.  turns: as of contact_forces.  Returns (overlap, (m, 6) new pins), the overlap negative where no
    yarns touch. Minima are sought on a grid of half pieces, and polished.
    """
    picks, ends = lift.shape
    rows, columns = 4 * reach1 + 1, 4 * reach2 + 1
    warp, weft, grid = np.zeros((rows, 2)), np.zeros((columns, 2)), np.zeros((rows, columns))
    least, where = np.zeros(max(rows, columns)), np.zeros(max(rows, columns), np.int64)
    chain = np.full((picks, ends), -1)  # last pin of each crossing, then the one before it
    before = np.full(len(pins), -1)
    for k in range(len(pins)):
        i, j = int(pins[k, 0]), int(pins[k, 1])
        before[k], chain[i, j] = chain[i, j], k
    new = [(0.0, 0.0, 0.0, 0.0, 0.0) for _ in range(0)]
    best = 81.0
    for i in range(picks):
        for j in range(ends):
            sign = 1.0 if lift[i, j] else -1.0
            e, c1 = (0, turns[j]) if len(turns) else (j, i * per)
            half_pieces(wu, wz, e, c1, reach1, warp)
            half_pieces(fu, fz, i, j * per, reach2, weft)
            for norm in range(2):
                over_x = 1.0 / wide_x**2 if norm == 0 else 1.0
                over_y = 1.0 / wide_y**2 if norm == 1 else 1.0
                lines = least_by_line(
                    warp, weft, reach1, reach2, l1, l2, over_x, over_y, sign, norm, grid, least, where
                )
                fresh = len(new)
                for a in range(lines):
                    here = least[a]
                    best = min(best, here)
                    if not is_minimum(least, a, lines):
                        continue
                    s, t = 0.5 * (where[a] if norm else a) - reach1, 0.5 * (a if norm else where[a]) - reach2
                    s1, t1, square = polished(
                        s, t, wu, wz, e, c1, l1, fu, fz, i, j * per, l2, over_x, over_y, sign
                    )
                    if square < here and abs(s1) <= reach1 + 1 and abs(t1) <= reach2 + 1:
                        here, s, t = square, s1, t1
                        best = min(best, here)
                    if here >= (1.0 - least_deep) ** 2:
                        continue
                    if norm:
                        place, aside = s, t - place_on(wu, wz, e, c1, s)[0] / l2
                    else:
                        place, aside = t, s - place_on(fu, fz, i, j * per, t)[0] / l1
                    known = False
                    k = chain[i, j]
                    while k >= 0:
                        if pins[k, 2] == norm and abs(pins[k, 3] - place) + abs(pins[k, 4] - aside) < APART:
                            known = True
                        k = before[k]
                    for k in range(fresh, len(new)):
                        if abs(new[k][3] - place) + abs(new[k][4] - aside) < APART:
                            known = True
                    if not known:
                        new.append((float(i), float(j), float(norm), place, aside))
    made = np.zeros((len(new), 6))
    for k in range(len(new)):
        for m in range(5):
            made[k, m] = new[k][m]
    return 1.0 - sqrt(best), made


@njit(cache=True, error_model="numpy")
def _weights(base, s, count):
    """The four particles round a place, and their share in it."""
    k = int(floor(s))
    f = s - k
    g = 1.0 - f
    n = base + k
    return (
        ((n - 1) % count, -0.5 * f * g * g), (n % count, 1.0 + f * f * (1.5 * f - 2.5)),
        ((n + 1) % count, 1.0 + g * g * (1.5 * g - 2.5)), ((n + 2) % count, -0.5 * f * f * g),
    )  # fmt: skip


@njit(cache=True, error_model="numpy")
def pin_forces(pins, wu, wz, fu, fz, gwu, gwz, gfu, gfz, lift, pressing, per, l1, l2, wide_x, wide_y, reach1, reach2,
               stiff, renew, weigh, hwu, hwz, hfu, hfz, turns):  # fmt: skip
    """Add the contact of the pinned places. Returns (energy, deepest overlap, largest pressing force).

    Arguments as of contact_forces, whose `pressing` grows by the pins' share; pins: (n, 6) as of curve_overlap.
    """
    energy, deepest, largest = 0.0, 0.0, 0.0
    out = np.zeros(7)
    for k in range(len(pins)):
        i, j = int(pins[k, 0]), int(pins[k, 1])
        sign = 1.0 if lift[i, j] else -1.0
        e, c1 = (0, turns[j]) if len(turns) else (j, i * per)
        if pins[k, 2] == 1.0:
            more = _pinned(pins[k, 3], pins[k, 4], pins[k, 5],
                           wu, wz, gwu, gwz, hwu, hwz, e, c1, l1, fu, fz, gfu, gfz, hfu, hfz, i, j * per,
                           l2, reach2, wide_y, sign, stiff, weigh, out)  # fmt: skip
        else:
            more = _pinned(pins[k, 3], pins[k, 4], pins[k, 5],
                           fu, fz, gfu, gfz, hfu, hfz, i, j * per, l2, wu, wz, gwu, gwz, hwu, hwz, e, c1,
                           l1, reach1, wide_x, -sign, stiff, weigh, out)  # fmt: skip
        if renew:
            pins[k, 5] = set_out(pins[k, 5], out[6])
        if more == 0.0:
            continue
        energy += more
        deepest = max(deepest, out[2])
        pressing[i, j] += out[3]
        largest = max(largest, pressing[i, j])
    return energy, deepest, largest


@njit(cache=True, error_model="numpy")
def _pinned(s, aside, held, u, z, gu, gz, hu, hz, yarn, base, l1, u2, z2, gu2, gz2, hu2, hz2, yarn2, base2, l2, reach,
            wide, sign, stiff, weigh, out):  # fmt: skip
    """Contact of the place s of one yarn with the curve of the other. Returns the energy; out as of touch."""
    around = _weights(base, s, u.shape[1])
    c, high = 0.0, 0.0
    for n, w in around:
        c += w * u[yarn, n]
        high += w * z[yarn, n]
    more = touch(
        c,
        s * l1,
        high,
        u2,
        z2,
        yarn2,
        base2,
        l2,
        reach,
        wide,
        sign,
        stiff,
        gu2,
        gz2,
        weigh,
        hu2,
        hz2,
        aside,
        held,
        1.0,
        out,
    )
    if more > 0.0:
        for n, w in around:
            gu[yarn, n] += w * out[0]
            gz[yarn, n] += w * out[1]
            if weigh:
                hu[yarn, n] += abs(w) * out[4]
                hz[yarn, n] += abs(w) * out[5]
    return more


@njit(cache=True, error_model="numpy")
def curve_gaps(wu, wz, fu, fz, lift, per, l1, l2, wide_x, wide_y, reach1, reach2, gaps):
    """How far the curves of crossing yarns are from touching, in each of the two norms; less than 0 where they overlap.

    wu, wz: (ends, picks * per), fu, fz: (picks, ends * per) [D], curves through these as in curve_overlap, the minima
    of whose distance are found likewise.  gaps: (picks, ends, 2) [D], written: round the warp, round the weft; yarns
    farther than 1 D beyond touching count as that far.
    """
    picks, ends = lift.shape
    rows, columns = 4 * reach1 + 1, 4 * reach2 + 1
    warp, weft, grid = np.zeros((rows, 2)), np.zeros((columns, 2)), np.zeros((rows, columns))
    least, where = np.zeros(max(rows, columns)), np.zeros(max(rows, columns), np.int64)
    for i in range(picks):
        for j in range(ends):
            sign = 1.0 if lift[i, j] else -1.0
            e, c1 = j, i * per
            half_pieces(wu, wz, e, c1, reach1, warp)
            half_pieces(fu, fz, i, j * per, reach2, weft)
            for norm in range(2):
                over_x = 1.0 / wide_x**2 if norm == 0 else 1.0
                over_y = 1.0 / wide_y**2 if norm == 1 else 1.0
                best = 4.0
                lines = least_by_line(
                    warp, weft, reach1, reach2, l1, l2, over_x, over_y, sign, norm, grid, least, where
                )
                for a in range(lines):
                    here = least[a]
                    best = min(best, here)
                    if not is_minimum(least, a, lines):
                        continue
                    s, t = 0.5 * (where[a] if norm else a) - reach1, 0.5 * (a if norm else where[a]) - reach2
                    s1, t1, square = polished(
                        s, t, wu, wz, e, c1, l1, fu, fz, i, j * per, l2, over_x, over_y, sign
                    )
                    if square < here and abs(s1) <= reach1 + 1 and abs(t1) <= reach2 + 1:
                        best = min(best, square)
                gaps[i, j, norm] = np.sqrt(best) - 1.0
