"""The loops of `banded.py` over lanes (`lanes.py`), in either precision: force, kick and drift are one pass.

A run names where its coefficients begin, its last column: those of a lattice repeat and lie in short tables. A product
and a sum may be one instruction here (contracted), so the last bits depend on whether the processor has it; on one
machine equal input gives equal bits. Literals are avoided: they are double, and one of them makes a loop double.
"""

from __future__ import annotations

from sim_core.cloth.step.kernels.compiled import distinct_contracted


@distinct_contracted
def lane_strains(runs, length2, at, strain):
    """eps = |d|^2 - L^2 [m2] of every edge."""
    x, y, z = at
    for r in range(len(runs)):
        e0, count, i0, j0, c0 = runs[r, 0], runs[r, 1], runs[r, 2], runs[r, 3], runs[r, 4]
        for t in range(count):
            a, b, c = x[i0 + t] - x[j0 + t], y[i0 + t] - y[j0 + t], z[i0 + t] - z[j0 + t]
            strain[e0 + t] = a * a + b * b + c * c - length2[c0 + t]


@distinct_contracted
def lane_damped_strains(runs, length2, at, given_rate, before, strain):
    """eps of every edge plus `given_rate` times its change since `before`, which is renewed."""
    x, y, z = at
    rate = x.dtype.type(given_rate)
    for r in range(len(runs)):
        e0, count, i0, j0, c0 = runs[r, 0], runs[r, 1], runs[r, 2], runs[r, 3], runs[r, 4]
        for t in range(count):
            a, b, c = x[i0 + t] - x[j0 + t], y[i0 + t] - y[j0 + t], z[i0 + t] - z[j0 + t]
            now = a * a + b * b + c * c - length2[c0 + t]
            strain[e0 + t] = now + rate * (now - before[e0 + t])
            before[e0 + t] = now


@distinct_contracted
def lane_tensions(runs, own, coupling, strain, tension):
    """T = 2 sum K eps [N/m] of every edge, from its own strain and those of the four around it."""
    c0, c1, c2, c3 = coupling[0], coupling[1], coupling[2], coupling[3]
    for r in range(len(runs)):
        e0, count, k0 = runs[r, 0], runs[r, 1], runs[r, 6]
        a0, a1, a2, a3 = runs[r, 2], runs[r, 3], runs[r, 4], runs[r, 5]
        for t in range(count):
            e, k = e0 + t, k0 + t
            near = c0[k] * strain[a0 + t] + c1[k] * strain[a1 + t]
            far = c2[k] * strain[a2 + t] + c3[k] * strain[a3 + t]
            tension[e] = own[k] * strain[e] + near + far


@distinct_contracted
def lane_leap(runs, weight, inverse, at, fall, pace, speed, there):
    """One step: v = keep v + gain (pulls / m + fall), there = x + step v; what is pinned keeps its velocity.

    The pulls are sum of weight_e (x_j - x_i) over the first six neighbours; fall (3,) [m/s2]; pace: keep, gain [s],
    step [s].
    """
    (x, y, z), (u, v, w), (nx, ny, nz) = at, speed, there
    real = x.dtype.type
    keep, gain, dt = real(pace[0]), real(pace[1]), real(pace[2])
    one, nothing = real(1), real(0)
    gx, gy, gz = real(fall[0]), real(fall[1]), real(fall[2])
    for r in range(len(runs)):
        i0, count = runs[r, 0], runs[r, 1]
        a, b, c, d, e, f = runs[r, 3], runs[r, 4], runs[r, 5], runs[r, 6], runs[r, 7], runs[r, 8]
        ea, eb, ec, ed, ee, ef = runs[r, 9], runs[r, 10], runs[r, 11], runs[r, 12], runs[r, 13], runs[r, 14]
        for t in range(count):
            i = i0 + t
            xi, yi, zi, m = x[i], y[i], z[i], inverse[i]
            wa, wb, wc = weight[ea + t], weight[eb + t], weight[ec + t]
            wd, we, wf = weight[ed + t], weight[ee + t], weight[ef + t]
            px = wa * (x[a + t] - xi) + wb * (x[b + t] - xi) + wc * (x[c + t] - xi)
            py = wa * (y[a + t] - yi) + wb * (y[b + t] - yi) + wc * (y[c + t] - yi)
            pz = wa * (z[a + t] - zi) + wb * (z[b + t] - zi) + wc * (z[c + t] - zi)
            qx = wd * (x[d + t] - xi) + we * (x[e + t] - xi) + wf * (x[f + t] - xi)
            qy = wd * (y[d + t] - yi) + we * (y[e + t] - yi) + wf * (y[f + t] - yi)
            qz = wd * (z[d + t] - zi) + we * (z[e + t] - zi) + wf * (z[f + t] - zi)
            held = keep if m > nothing else one
            gone = gain if m > nothing else nothing
            un = held * u[i] + gone * (m * (px + qx) + gx)
            vn = held * v[i] + gone * (m * (py + qy) + gy)
            wn = held * w[i] + gone * (m * (pz + qz) + gz)
            u[i], v[i], w[i] = un, vn, wn
            nx[i], ny[i], nz[i] = xi + dt * un, yi + dt * vn, zi + dt * wn


@distinct_contracted
def lane_further(runs, weight, inverse, at, gained, speed):
    """v += gained / m times the pulls of a seventh and later neighbour."""
    (x, y, z), (u, v, w) = at, speed
    gain = x.dtype.type(gained)
    for r in range(len(runs)):
        i0, count = runs[r, 0], runs[r, 1]
        for t in range(count):
            i = i0 + t
            px = py = pz = x.dtype.type(0)
            for k in range(6):
                j, s = runs[r, 3 + k] + t, weight[runs[r, 9 + k] + t]
                px += s * (x[j] - x[i])
                py += s * (y[j] - y[i])
                pz += s * (z[j] - z[i])
            m = gain * inverse[i]
            u[i] += m * px
            v[i] += m * py
            w[i] += m * pz


@distinct_contracted
def lane_bends(runs, bend, inverse, gained, at, speed):
    """v += gained / m times the bending force -Q x."""
    (x, y, z), (u, v, w) = at, speed
    gain = x.dtype.type(gained)
    for r in range(len(runs)):
        i0, count, k, k0 = runs[r, 0], runs[r, 1], runs[r, 2], runs[r, 10]
        a, b, c, d, e, f = runs[r, 4], runs[r, 5], runs[r, 6], runs[r, 7], runs[r, 8], runs[r, 9]
        ka, kb, kc, kd, ke, kf = bend[k], bend[k + 1], bend[k + 2], bend[k + 3], bend[k + 4], bend[k + 5]
        for t in range(count):
            i = i0 + t
            xi, yi, zi, m = x[i], y[i], z[i], gain * inverse[i]
            n = k0 + t
            wa, wb, wc, wd, we, wf = ka[n], kb[n], kc[n], kd[n], ke[n], kf[n]
            px = wa * (x[a + t] - xi) + wb * (x[b + t] - xi) + wc * (x[c + t] - xi)
            py = wa * (y[a + t] - yi) + wb * (y[b + t] - yi) + wc * (y[c + t] - yi)
            pz = wa * (z[a + t] - zi) + wb * (z[b + t] - zi) + wc * (z[c + t] - zi)
            qx = wd * (x[d + t] - xi) + we * (x[e + t] - xi) + wf * (x[f + t] - xi)
            qy = wd * (y[d + t] - yi) + we * (y[e + t] - yi) + wf * (y[f + t] - yi)
            qz = wd * (z[d + t] - zi) + we * (z[e + t] - zi) + wf * (z[f + t] - zi)
            u[i] -= m * (px + qx)
            v[i] -= m * (py + qy)
            w[i] -= m * (pz + qz)


@distinct_contracted
def lane_odd_bends(odd, inverse, gained, at, speed):
    """`lane_bends` for `Odd` entries one by one."""
    (x, y, z), (u, v, w) = at, speed
    rows, vertex, other, weight = odd
    real = x.dtype.type
    gain, nothing = real(gained), real(0)
    for n in range(len(vertex)):
        i = vertex[n]
        xi, yi, zi = x[i], y[i], z[i]
        px = py = pz = nothing
        for k in range(rows[n], rows[n + 1]):
            j, s = other[k], weight[k]
            px += s * (x[j] - xi)
            py += s * (y[j] - yi)
            pz += s * (z[j] - zi)
        m = gain * inverse[i]
        u[i] -= m * px
        v[i] -= m * py
        w[i] -= m * pz


@distinct_contracted
def lane_kick(inverse, gained, force, speed):
    """v += gained f / m, each (V,)."""
    (fx, fy, fz), (u, v, w) = force, speed
    gain = u.dtype.type(gained)
    for i in range(len(u)):
        m = gain * inverse[i]
        u[i] += m * fx[i]
        v[i] += m * fy[i]
        w[i] += m * fz[i]


@distinct_contracted
def lane_drift(at, speed, step):
    """x += step v."""
    (x, y, z), (u, v, w) = at, speed
    dt = x.dtype.type(step)
    for i in range(len(x)):
        x[i] += dt * u[i]
        y[i] += dt * v[i]
        z[i] += dt * w[i]


@distinct_contracted
def lane_strain_before(runs, length2, at, speed, step, before):
    """eps of the positions a step [s] ago."""
    (x, y, z), (u, v, w) = at, speed
    dt = x.dtype.type(step)
    for r in range(len(runs)):
        e0, count, i0, j0, c0 = runs[r, 0], runs[r, 1], runs[r, 2], runs[r, 3], runs[r, 4]
        for t in range(count):
            i, j = i0 + t, j0 + t
            a = x[i] - x[j] - dt * (u[i] - u[j])
            b = y[i] - y[j] - dt * (v[i] - v[j])
            c = z[i] - z[j] - dt * (w[i] - w[j])
            before[e0 + t] = a * a + b * b + c * c - length2[c0 + t]


@distinct_contracted
def lane_strain_changes(runs, at, way, change):
    """2 d.(p_i - p_j) of every edge: the derivative of eps along the way p."""
    (x, y, z), (p, q, s) = at, way
    for r in range(len(runs)):
        e0, count, i0, j0 = runs[r, 0], runs[r, 1], runs[r, 2], runs[r, 3]
        for t in range(count):
            i, j = i0 + t, j0 + t
            along = (x[i] - x[j]) * (p[i] - p[j]) + (y[i] - y[j]) * (q[i] - q[j])
            along += (z[i] - z[j]) * (s[i] - s[j])
            change[e0 + t] = along + along
