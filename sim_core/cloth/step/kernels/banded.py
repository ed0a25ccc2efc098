"""The loops over runs (`bands.py`): strains, tensions, forces, air and their derivatives, as vector instructions.

Every function takes positions, velocities and forces as three arrays (V,), a tuple for each (see `axes`), and no array
overlaps another.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from sim_core.cloth.step.kernels.compiled import distinct


@njit(error_model="numpy", inline="always")
def axes(x):
    """The rows of x (3, V): what the kernels take as x, y and z."""
    return x[0], x[1], x[2]


@distinct
def band_strains(runs, length2, at, strain):
    """eps = |d|^2 - L^2 [m2] of every edge."""
    x, y, z = at
    for r in range(len(runs)):
        e0, count, i0, j0 = runs[r, 0], runs[r, 1], runs[r, 2], runs[r, 3]
        for t in range(count):
            a, b, c = x[i0 + t] - x[j0 + t], y[i0 + t] - y[j0 + t], z[i0 + t] - z[j0 + t]
            strain[e0 + t] = a * a + b * b + c * c - length2[e0 + t]


@distinct
def band_damped_strains(runs, length2, at, rate, before, strain):
    """eps of every edge plus `rate` times its change since `before` (E,), which is renewed."""
    x, y, z = at
    for r in range(len(runs)):
        e0, count, i0, j0 = runs[r, 0], runs[r, 1], runs[r, 2], runs[r, 3]
        for t in range(count):
            a, b, c = x[i0 + t] - x[j0 + t], y[i0 + t] - y[j0 + t], z[i0 + t] - z[j0 + t]
            now = a * a + b * b + c * c - length2[e0 + t]
            strain[e0 + t] = now + rate * (now - before[e0 + t])
            before[e0 + t] = now


@distinct
def band_strain_changes(runs, at, way, change):
    """2 d.(p_i - p_j) of every edge: the derivative of eps along the way p."""
    (x, y, z), (p, q, s) = at, way
    for r in range(len(runs)):
        e0, count, i0, j0 = runs[r, 0], runs[r, 1], runs[r, 2], runs[r, 3]
        for t in range(count):
            i, j = i0 + t, j0 + t
            along = (x[i] - x[j]) * (p[i] - p[j]) + (y[i] - y[j]) * (q[i] - q[j])
            change[e0 + t] = 2.0 * (along + (z[i] - z[j]) * (s[i] - s[j]))


@distinct
def band_tensions(runs, own, coupling, strain, tension):
    """T = 2 sum K eps [N/m] of every edge, from its own strain and those of the four around it."""
    c0, c1, c2, c3 = coupling[0], coupling[1], coupling[2], coupling[3]
    for r in range(len(runs)):
        e0, count = runs[r, 0], runs[r, 1]
        a0, a1, a2, a3 = runs[r, 2], runs[r, 3], runs[r, 4], runs[r, 5]
        for t in range(count):
            e = e0 + t
            near = c0[e] * strain[a0 + t] + c1[e] * strain[a1 + t]
            far = c2[e] * strain[a2 + t] + c3[e] * strain[a3 + t]
            tension[e] = own[e] * strain[e] + near + far


@distinct
def band_pulls(runs, weight, at, out):
    """Force (V,) per axis: sum of weight_e (x_j - x_i) over the neighbours; the first group of a vertex sets it."""
    (x, y, z), (fx, fy, fz) = at, out
    for r in range(len(runs)):
        i0, count, more = runs[r, 0], runs[r, 1], float(runs[r, 2])
        a, b, c, d, e, f = runs[r, 3], runs[r, 4], runs[r, 5], runs[r, 6], runs[r, 7], runs[r, 8]
        ea, eb, ec, ed, ee, ef = runs[r, 9], runs[r, 10], runs[r, 11], runs[r, 12], runs[r, 13], runs[r, 14]
        for t in range(count):
            i = i0 + t
            xi, yi, zi = x[i], y[i], z[i]
            wa, wb, wc = weight[ea + t], weight[eb + t], weight[ec + t]
            wd, we, wf = weight[ed + t], weight[ee + t], weight[ef + t]
            px = wa * (x[a + t] - xi) + wb * (x[b + t] - xi) + wc * (x[c + t] - xi)
            py = wa * (y[a + t] - yi) + wb * (y[b + t] - yi) + wc * (y[c + t] - yi)
            pz = wa * (z[a + t] - zi) + wb * (z[b + t] - zi) + wc * (z[c + t] - zi)
            qx = wd * (x[d + t] - xi) + we * (x[e + t] - xi) + wf * (x[f + t] - xi)
            qy = wd * (y[d + t] - yi) + we * (y[e + t] - yi) + wf * (y[f + t] - yi)
            qz = wd * (z[d + t] - zi) + we * (z[e + t] - zi) + wf * (z[f + t] - zi)
            fx[i] = more * fx[i] + (px + qx)
            fy[i] = more * fy[i] + (py + qy)
            fz[i] = more * fz[i] + (pz + qz)


@distinct
def band_bends(runs, bend, factor, at, out):
    """Adds `factor` times the bending force -Q x to `out`."""
    (x, y, z), (fx, fy, fz) = at, out
    for r in range(len(runs)):
        i0, count, k = runs[r, 0], runs[r, 1], runs[r, 2]
        a, b, c, d, e, f = runs[r, 4], runs[r, 5], runs[r, 6], runs[r, 7], runs[r, 8], runs[r, 9]
        ka, kb, kc, kd, ke, kf = bend[k], bend[k + 1], bend[k + 2], bend[k + 3], bend[k + 4], bend[k + 5]
        for t in range(count):
            i = i0 + t
            xi, yi, zi = x[i], y[i], z[i]
            wa, wb, wc, wd, we, wf = ka[i], kb[i], kc[i], kd[i], ke[i], kf[i]
            px = wa * (x[a + t] - xi) + wb * (x[b + t] - xi) + wc * (x[c + t] - xi)
            py = wa * (y[a + t] - yi) + wb * (y[b + t] - yi) + wc * (y[c + t] - yi)
            pz = wa * (z[a + t] - zi) + wb * (z[b + t] - zi) + wc * (z[c + t] - zi)
            qx = wd * (x[d + t] - xi) + we * (x[e + t] - xi) + wf * (x[f + t] - xi)
            qy = wd * (y[d + t] - yi) + we * (y[e + t] - yi) + wf * (y[f + t] - yi)
            qz = wd * (z[d + t] - zi) + we * (z[e + t] - zi) + wf * (z[f + t] - zi)
            fx[i] -= factor * (px + qx)
            fy[i] -= factor * (py + qy)
            fz[i] -= factor * (pz + qz)


@distinct
def band_air(runs, at, speed, back, wind, press, out, aside):
    """Air on every face into `out`: a quarter rho Cd |s| s / |c|^2 c, c twice the area vector.

    s = (wind - mean velocity).c, wind [m/s], press = rho Cd / 12 (a third of it for each corner); aside: room for the
    longest run. Faces are taken where they were `back` [s] ago, with these velocities.
    """
    (x, y, z), (u, v, w), (ux, uy, uz) = at, speed, wind
    (fx, fy, fz), (hx, hy, hz) = out, aside
    fx[:] = 0.0
    fy[:] = 0.0
    fz[:] = 0.0
    third = 1.0 / 3.0
    for r in range(len(runs)):
        count, a, b, c = runs[r, 1], runs[r, 2], runs[r, 3], runs[r, 4]
        for t in range(count):
            i, j, k = a + t, b + t, c + t
            ex = x[j] - x[i] - back * (u[j] - u[i])
            ey = y[j] - y[i] - back * (v[j] - v[i])
            ez = z[j] - z[i] - back * (w[j] - w[i])
            gx = x[k] - x[i] - back * (u[k] - u[i])
            gy = y[k] - y[i] - back * (v[k] - v[i])
            gz = z[k] - z[i] - back * (w[k] - w[i])
            cx, cy, cz = ey * gz - ez * gy, ez * gx - ex * gz, ex * gy - ey * gx
            wx = ux - third * (u[i] + u[j] + u[k])
            wy = uy - third * (v[i] + v[j] + v[k])
            wz = uz - third * (w[i] + w[j] + w[k])
            s = wx * cx + wy * cy + wz * cz
            scale = press * abs(s) * s / (cx * cx + cy * cy + cz * cz + 1e-30)
            hx[t], hy[t], hz[t] = scale * cx, scale * cy, scale * cz
        for t in range(count):
            fx[a + t] += hx[t]
            fy[a + t] += hy[t]
            fz[a + t] += hz[t]
        for t in range(count):
            fx[b + t] += hx[t]
            fy[b + t] += hy[t]
            fz[b + t] += hz[t]
        for t in range(count):
            fx[c + t] += hx[t]
            fy[c + t] += hy[t]
            fz[c + t] += hz[t]


@distinct
def band_ahead(now, past, ahead, out):
    """out = now + ahead (now - past), each (V,); then past = now."""
    for i in range(len(now)):
        out[i] = now[i] + ahead * (now[i] - past[i])
        past[i] = now[i]


@distinct
def band_add(out, more):
    """out += more."""
    (fx, fy, fz), (gx, gy, gz) = out, more
    for i in range(len(fx)):
        fx[i] += gx[i]
        fy[i] += gy[i]
        fz[i] += gz[i]


@distinct
def band_kick(inverse_mass, force, fall, keep, gain, speed):
    """v = keep v + gain (f / m + a), a the acceleration `fall` of all; what is pinned keeps its velocity."""
    (fx, fy, fz), (ax, ay, az), (u, v, w) = force, fall, speed
    for i in range(len(u)):
        m = inverse_mass[i]
        free = 1.0 if m > 0.0 else 0.0
        held, gone = 1.0 + free * (keep - 1.0), gain * free
        u[i] = held * u[i] + gone * (fx[i] * m + ax)
        v[i] = held * v[i] + gone * (fy[i] * m + ay)
        w[i] = held * w[i] + gone * (fz[i] * m + az)


@distinct
def band_drift(at, speed, dt):
    """x += dt v."""
    (x, y, z), (u, v, w) = at, speed
    for i in range(len(x)):
        x[i] += dt * u[i]
        y[i] += dt * v[i]
        z[i] += dt * w[i]


@distinct
def band_limit(speed, limit):
    """Speeds above `limit` [m/s] are brought down to it."""
    u, v, w = speed
    most = limit * limit
    for i in range(len(u)):
        slower = limit / np.sqrt(max(u[i] * u[i] + v[i] * v[i] + w[i] * w[i], most))
        u[i] *= slower
        v[i] *= slower
        w[i] *= slower


@distinct
def band_strain_before(runs, length2, at, speed, dt, before):
    """eps (E,) of the positions a step of dt [s] ago."""
    (x, y, z), (u, v, w) = at, speed
    for r in range(len(runs)):
        e0, count, i0, j0 = runs[r, 0], runs[r, 1], runs[r, 2], runs[r, 3]
        for t in range(count):
            i, j = i0 + t, j0 + t
            a = x[i] - x[j] - dt * (u[i] - u[j])
            b = y[i] - y[j] - dt * (v[i] - v[j])
            c = z[i] - z[j] - dt * (w[i] - w[j])
            before[e0 + t] = a * a + b * b + c * c - length2[e0 + t]
