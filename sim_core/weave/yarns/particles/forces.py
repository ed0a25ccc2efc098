"""Kernels of stage B: bending, tension, contact, friction and side contact of yarn particles in one periodic repeat.

Lengths in D, the mean height of warp and weft; forces in EI/D^2. Particles of an end stay at their place along the
warp (l apart) and move sideways (u) and in height (z); the yarn's length flows through them, so that particles stay
abreast of the crossings whatever the yarn takes up. Likewise for the picks.
"""

from math import floor, sqrt

import numpy as np
from numba import njit

__all__ = ["contact_forces", "set_out", "side_forces", "touch", "yarn_forces"]

NEWTON = 4  # steps to the nearest point; with fewer the force is no slope of the energy where yarns are steep and flat
# A point in the bowl of a curve that bends round it has two nearest points, and would jump between them. From this
# share of the focal distance on it is held to the place below it; the curve's own particles touch on both flanks.
BOWL = 0.6
FARTHEST = 0.05  # a contact is set out
SKIN = 1.08  # norm below which a particle may come to touch before the crossing is looked at as a whole again


@njit(cache=True, error_model="numpy")
def yarn_forces(u, z, length, stiffness, tension, fu, fz):
    """Add bending and tension of the yarns u, z (yarns, particles) to the forces fu, fz. Returns the energy.

    Bending energy of the angle between two pieces: EI phi^2 / (2 l), phi^2 = 2 (1 - c) (1 + (1 - c) / 6 + ...), c its
    cosine; tension times length besides.
    """
    energy = 0.0
    count = u.shape[1]
    # directions and inverse lengths of the pieces before particles 0 .. count, then forces of their angles on the
    # particle before and behind: plain passes over rows, which the compiler turns into vector instructions
    tl, tu, tz, inverse = np.zeros(count + 1), np.zeros(count + 1), np.zeros(count + 1), np.zeros(count + 1)
    u1, z1, u2, z2 = np.zeros(count + 1), np.zeros(count + 1), np.zeros(count + 1), np.zeros(count + 1)
    for yarn in range(u.shape[0]):
        row, rise = u[yarn], z[yarn]
        for k in range(1, count):
            tu[k], tz[k] = row[k] - row[k - 1], rise[k] - rise[k - 1]
        tu[0], tz[0] = row[0] - row[count - 1], rise[0] - rise[count - 1]
        for k in range(count):
            inverse[k] = 1.0 / sqrt(length * length + tu[k] * tu[k] + tz[k] * tz[k])
            tl[k] = length * inverse[k]
            tu[k] *= inverse[k]
            tz[k] *= inverse[k]
        tl[count], tu[count], tz[count], inverse[count] = tl[0], tu[0], tz[0], inverse[0]
        for k in range(count):
            cosine = tl[k] * tl[k + 1] + tu[k] * tu[k + 1] + tz[k] * tz[k + 1]
            turn = 1.0 - cosine
            # 1 / mean length of the two pieces
            close = 2.0 * inverse[k] * inverse[k + 1] / (inverse[k] + inverse[k + 1])
            bend = stiffness * turn * (1.0 + turn / 6.0) * close
            slope = stiffness * (1.0 + turn / 3.0) * close  # -dE/dc
            shrink = 0.5 * bend * close  # -dE/d piece
            a, b = slope * inverse[k], slope * inverse[k + 1]
            u1[k] = -a * (tu[k + 1] - cosine * tu[k]) - shrink * tu[k]
            z1[k] = -a * (tz[k + 1] - cosine * tz[k]) - shrink * tz[k]
            u2[k] = -b * (tu[k] - cosine * tu[k + 1]) - shrink * tu[k + 1] + tension * tu[k + 1]
            z2[k] = -b * (tz[k] - cosine * tz[k + 1]) - shrink * tz[k + 1] + tension * tz[k + 1]
            energy += bend + tension / inverse[k + 1]
        u1[count], z1[count] = u1[0], z1[0]
        for k in range(count):
            fu[yarn, k] += u2[k] - u1[k] + u1[k + 1]
            fz[yarn, k] += z2[k] - z1[k] + z1[k + 1]
        for k in range(1, count):
            fu[yarn, k] -= u2[k - 1]
            fz[yarn, k] -= z2[k - 1]
        fu[yarn, 0] -= u2[count - 1]
        fz[yarn, 0] -= z2[count - 1]
    return energy


@njit(cache=True, error_model="numpy")
def set_out(held, norm):
    """By how much a contact at `norm` is to be set out: then it presses as before, and does not overlap."""
    return min(max(held + 1.0 - norm, 0.0), FARTHEST)


@njit(cache=True, error_model="numpy")
def touch(
    c,
    d,
    z,
    u2,
    z2,
    yarn2,
    base,
    l2,
    reach,
    wide_d,
    sign,
    stiff,
    fu2,
    fz2,
    weigh,
    hu2,
    hz2,
    aside,
    held,
    one,
    out,
):
    """Contact of a point with the curve of a crossing yarn.

    c: place of the point along the crossing yarn, from its particle `base`; d: sideways to it; z: height.
    The curve runs through its particles (Catmull-Rom); the nearest point in the anisotropic norm
    dc^2 + (dd / wide_d)^2 + dz^2 is found by Newton: a flat section lies on the yarn that it crosses and turns with its
    slope. sign: +1 where the point belongs above.  aside: pieces from the place below the point to where Newton starts.
    held: by how much the contact is set out, in D; where that is too much, it presses across a gap, told as overlap.
    one: the norm at which they touch, 1, or more where the curves come nearer to each other than the point does.
    Adds the reaction to fu2, fz2; writes force on the point along c, along z, overlap, pressing force, the contact's
    stiffness along c and z, and the norm to out. weigh: add the stiffness that the curve's particles feel to hu2, hz2.
    """
    count = u2.shape[1]
    s = min(max(c / l2 + aside, -reach), reach)
    n1 = base + int(floor(s + 0.5))
    n1 = n1 + count if n1 < 0 else n1 - count if n1 >= count else n1
    dd, dz = (d - u2[yarn2, n1]) / wide_d, z - z2[yarn2, n1]
    out[6] = 2.0
    if dd * dd >= SKIN * SKIN or (dz * sign > 0.0 and dd * dd + dz * dz > 2.2):
        return 0.0
    n0, n2, n3 = 0, 0, 0
    w0, w1, w2, w3 = 0.0, 0.0, 0.0, 0.0
    dc = 0.0
    moved, middle, hold = 1.0, s, 0.0
    for step in range(NEWTON + 1):
        s = min(max(s, -reach), reach)
        k = int(floor(s))
        f = s - k
        n1 = base + k
        n1 = n1 + count if n1 < 0 else n1 - count if n1 >= count else n1
        n0, n2 = n1 - 1 if n1 > 0 else count - 1, n1 + 1 if n1 < count - 1 else 0
        n3 = n2 + 1 if n2 < count - 1 else 0
        g = 1.0 - f
        w0, w3 = -0.5 * f * g * g, -0.5 * f * f * g
        w1, w2 = 1.0 + f * f * (1.5 * f - 2.5), 1.0 + g * g * (1.5 * g - 2.5)
        dc = c - s * l2
        dd = d - (w0 * u2[yarn2, n0] + w1 * u2[yarn2, n1] + w2 * u2[yarn2, n2] + w3 * u2[yarn2, n3])
        dz = z - (w0 * z2[yarn2, n0] + w1 * z2[yarn2, n1] + w2 * z2[yarn2, n2] + w3 * z2[yarn2, n3])
        if step == NEWTON or abs(moved) < 1e-4:
            break
        v0, v3 = -0.5 * g * (g - 2 * f), -0.5 * f * (2 * g - f)
        v1, v2 = f * (4.5 * f - 5.0), -g * (4.5 * g - 5.0)
        su = v0 * u2[yarn2, n0] + v1 * u2[yarn2, n1] + v2 * u2[yarn2, n2] + v3 * u2[yarn2, n3]
        sz = v0 * z2[yarn2, n0] + v1 * z2[yarn2, n1] + v2 * z2[yarn2, n2] + v3 * z2[yarn2, n3]
        bent = (
            (2.0 - 3.0 * f) * z2[yarn2, n0] + (9.0 * f - 5.0) * z2[yarn2, n1]
            + (4.0 - 9.0 * f) * z2[yarn2, n2] + (3.0 * f - 1.0) * z2[yarn2, n3]
        )  # fmt: skip
        flat = l2 * l2 + su * su / (wide_d * wide_d) + sz * sz
        rise = dc * l2 + dd * su / (wide_d * wide_d) + dz * sz
        if step == 0:
            hold = max(dz * bent - BOWL * flat, 0.0)
        moved = (rise - hold * (s - middle)) / max(flat - dz * bent + hold, 0.2 * flat)
        s += moved
    high = sign * dz
    if high < 0.05:
        high = 0.05
    norm = sqrt(dc * dc + dd * dd / (wide_d * wide_d) + high * high)
    out[6] = norm
    if norm >= one + held:
        return 0.0
    press = stiff * (one + held - norm)
    along_c, along_d, along_z = (
        press * dc / norm, press * dd / (wide_d * wide_d * norm), press * sign * high / norm
    )  # fmt: skip
    fu2[yarn2, n0] -= w0 * along_d
    fu2[yarn2, n1] -= w1 * along_d
    fu2[yarn2, n2] -= w2 * along_d
    fu2[yarn2, n3] -= w3 * along_d
    fz2[yarn2, n0] -= w0 * along_z
    fz2[yarn2, n1] -= w1 * along_z
    fz2[yarn2, n2] -= w2 * along_z
    fz2[yarn2, n3] -= w3 * along_z
    stiff_d, stiff_z = stiff * (dd / (wide_d * wide_d * norm)) ** 2, stiff * (high / norm) ** 2
    if weigh:
        for n, w in ((n0, abs(w0)), (n1, abs(w1)), (n2, abs(w2)), (n3, abs(w3))):
            hu2[yarn2, n] += w * stiff_d
            hz2[yarn2, n] += w * stiff_z
        out[4], out[5] = stiff * (dc / norm) ** 2, stiff_z
    out[0], out[1], out[2], out[3] = along_c, along_z, abs(one - norm), press * high / norm
    return 0.5 * press * (one + held - norm)


@njit(cache=True, error_model="numpy")
def contact_forces(wu, wz, fu, fz, gwu, gwz, gfu, gfz, lift, pressing, near, held, renew, per, l1, l2, wide_x, wide_y,
                   reach1, reach2, stiff, friction, slip, weigh, hwu, hwz, hfu, hfz, turns, apart,
                   stuck):  # fmt: skip
    """Add contact and friction at every crossing. Returns (energy, deepest overlap, largest pressing force).

    wu, wz (ends, picks * per), fu, fz (picks, ends * per) and their forces g...; lift (picks, ends).
    pressing: (picks, ends), read as the friction's normal force of the last evaluation, then written.
    near: (picks, ends, 2 (reach1 + reach2 + 1)) uint8, particles that touch or nearly do: written where `weigh` is
    set; else only those are looked at.
    held: of the shape of near, float64, by how much each contact is set out [D].  renew: set them out by what they
    overlap now, after their forces are taken (only where `weigh` is set).
    wide_x, wide_y: half widths of the contact norm along the weft and the warp; reach1, reach2: particles on both
    sides of a crossing that can touch.  friction: Coulomb's mu at the crossings, with elastic slip `slip` from the
    place as woven.  turns: empty, or of one pick and one end that stand for all (see Turns in shifts.py).
    apart: empty, or (picks, ends, 2) [D] by how much points keep farther from the warp and from the weft, so that the
    curves keep apart between the particles too (see curve_gaps).
    stuck: empty, or (picks, ends, 3) places [D] of end and pick at which a crossing came to stick, and by how much
    static friction exceeds sliding friction there, as a share of it.
    """
    picks, ends = lift.shape
    n1, n2 = wu.shape[1], fu.shape[1]
    energy, deepest, largest = 0.0, 0.0, 0.0
    second = 2 * reach1 + 1 + reach2
    out = np.zeros(7)
    for i in range(picks):
        for j in range(ends):
            sign = 1.0 if lift[i, j] else -1.0
            e = 0 if len(turns) else j
            c1, c2 = turns[j] if len(turns) else i * per, j * per
            total = 0.0
            one_f, one_w = (1.0 + apart[i, j, 0], 1.0 + apart[i, j, 1]) if len(apart) else (1.0, 1.0)
            for a in range(-reach1, reach1 + 1):
                if not weigh and near[i, j, reach1 + a] == 0:
                    continue
                n = c1 + a
                n = n + n1 if n < 0 else n - n1 if n >= n1 else n
                more = touch(wu[e, n], a * l1, wz[e, n], fu, fz, i, c2, l2, reach2, wide_y, sign, stiff,
                              gfu, gfz, weigh, hfu, hfz, 0.0, held[i, j, reach1 + a], one_w, out)  # fmt: skip
                if weigh:
                    near[i, j, reach1 + a] = out[6] < SKIN
                if renew:
                    held[i, j, reach1 + a] = set_out(held[i, j, reach1 + a], out[6] + (1.0 - one_w))
                if more == 0.0:
                    continue
                energy += more
                if weigh:
                    hwu[e, n] += out[4]
                    hwz[e, n] += out[5]
                gwu[e, n] += out[0]
                gwz[e, n] += out[1]
                total += out[3]
                deepest = max(deepest, out[2])
            for b in range(-reach2, reach2 + 1):
                if not weigh and near[i, j, second + b] == 0:
                    continue
                n = c2 + b
                n = n + n2 if n < 0 else n - n2 if n >= n2 else n
                more = touch(fu[i, n], b * l2, fz[i, n], wu, wz, e, c1, l1, reach1, wide_x, -sign, stiff,
                              gwu, gwz, weigh, hwu, hwz, 0.0, held[i, j, second + b], one_f, out)  # fmt: skip
                if weigh:
                    near[i, j, second + b] = out[6] < SKIN
                if renew:
                    held[i, j, second + b] = set_out(held[i, j, second + b], out[6] + (1.0 - one_f))
                if more == 0.0:
                    continue
                energy += more
                if weigh:
                    hfu[i, n] += out[4]
                    hfz[i, n] += out[5]
                gfu[i, n] += out[0]
                gfz[i, n] += out[1]
                total += out[3]
                deepest = max(deepest, out[2])
            if friction > 0.0:
                x, y = wu[e, c1], fu[i, c2]
                hold = friction * pressing[i, j] / sqrt(x * x + y * y + slip * slip)
                if len(stuck):
                    dx, dy = x - stuck[i, j, 0], y - stuck[i, j, 1]
                    more = stuck[i, j, 2] * friction * pressing[i, j] / sqrt(dx * dx + dy * dy + slip * slip)
                    gwu[e, c1] -= more * dx
                    gfu[i, c2] -= more * dy
                    if weigh:
                        hwu[e, c1] += more
                        hfu[i, c2] += more
                gwu[e, c1] -= hold * x
                gfu[i, c2] -= hold * y
                if weigh:
                    hwu[e, c1] += hold
                    hfu[i, c2] += hold
            pressing[i, j] = total
            largest = max(largest, total)
    return energy, deepest, largest


@njit(cache=True, error_model="numpy")
def side_forces(u, z, spacing, wide, high, stiff, gu, gz, held, renew, weigh, hu, hz, turn):
    """Contact of neighbouring yarns of one system, section against section. Returns (energy, deepest overlap).

    held: (yarns, particles) by how much the contact with the next yarn is set out, and renew as of contact_forces.
    turn: by how many particles the next yarn is the one before it, shifted back, where one stands for all; else 0.
    """
    yarns, count = u.shape
    energy, deepest = 0.0, 0.0
    for yarn in range(yarns):
        other = yarn + 1 if yarn < yarns - 1 else 0
        for k in range(count):
            m = k + turn if k + turn < count else k + turn - count
            du = (spacing + u[other, m] - u[yarn, k]) / wide
            dz = (z[other, m] - z[yarn, k]) / high
            square = du * du + dz * dz
            gap = 1.0 + held[yarn, k]
            if square >= gap * gap or square < 1e-12:
                if renew:
                    held[yarn, k] = set_out(held[yarn, k], sqrt(square))
                continue
            norm = sqrt(square)
            if renew:
                held[yarn, k] = set_out(held[yarn, k], norm)
            press = stiff * (gap - norm)
            energy += 0.5 * press * (gap - norm)
            deepest = max(deepest, abs(1.0 - norm))
            if weigh:
                for y, n in ((yarn, k), (other, m)):
                    hu[y, n] += stiff * (du / (norm * wide)) ** 2
                    hz[y, n] += stiff * (dz / (norm * high)) ** 2
            side, up = press * du / (norm * wide), press * dz / (norm * high)
            gu[other, m] += side
            gz[other, m] += up
            gu[yarn, k] -= side
            gz[yarn, k] -= up
    return energy, deepest
