"""What a frame is watched by, in passes as cheap as the loop's: energies, stretch, the stiffest mode over lanes."""

from __future__ import annotations

import numpy as np
from numba import njit

from sim_core.cloth.step.kernels.banded import axes, band_bends, band_strains, band_tensions
from sim_core.cloth.step.kernels.laned import (
    lane_bends,
    lane_further,
    lane_leap,
    lane_odd_bends,
    lane_strain_changes,
    lane_strains,
    lane_tensions,
)


@njit(cache=True, error_model="numpy")
def _works(f, inverse, x, v):
    """Sum of f.x and of m v.v over the vertices: f, x, v (3, V); axis by axis, so that sums do not wait for another."""
    ax, ay, az = x[0, 0], x[1, 0], x[2, 0]  # forces sum to zero: what they are counted from does not matter
    bx = by = bz = kx = ky = kz = 0.0
    for i in range(len(inverse)):
        bx += f[0, i] * (x[0, i] - ax)
        by += f[1, i] * (x[1, i] - ay)
        bz += f[2, i] * (x[2, i] - az)
        m = 1.0 / inverse[i] if inverse[i] > 0.0 else 0.0
        kx += m * (v[0, i] * v[0, i])
        ky += m * (v[1, i] * v[1, i])
        kz += m * (v[2, i] * v[2, i])
    return bx + by + bz, kx + ky + kz


@njit(cache=True, error_model="numpy")
def stored_lanes(lanes, inverse, ones, room, x, v):
    """`stored_energy` of x, v (3, V) float64 over lanes, its terms taken from x in their precision; ones (V,)."""
    b, here, f = lanes.bands, room.air_now, room.force
    for k in range(3):
        for i in range(len(inverse)):
            here[k, i] = x[k, i] - x[k, 0]
    lane_strains(b.edge_runs, b.length2, axes(here), room.strain)
    lane_tensions(b.tension_runs, b.own, b.coupling, room.strain, room.tension)
    half = len(room.strain) // 2
    stretch, other = 0.0, room.tension[2 * half] * room.strain[-1] if len(room.strain) > 2 * half else 0.0
    for e in range(half):
        stretch += room.tension[e] * room.strain[e]
        other += room.tension[half + e] * room.strain[half + e]
    f[:] = 0.0
    lane_bends(b.bend_runs, b.bend, ones, 1.0, axes(here), axes(f))
    lane_odd_bends(lanes.odd, ones, 1.0, axes(here), axes(f))
    bend, kinetic = _works(f, inverse, x, v)
    return 0.25 * (stretch + other) - 0.5 * bend + 0.5 * kinetic


@njit(cache=True, error_model="numpy")
def stored_energy(bands, inverse, room, x, v):
    """Membrane, bending and kinetic energy [J] of x, v (3, V); inverse (V,) [1/kg] without pins. Uses the room."""
    f = room.force
    band_strains(bands.edge_runs, bands.length2, axes(x), room.strain)
    band_tensions(bands.tension_runs, bands.own, bands.coupling, room.strain, room.tension)
    stretch = 0.0
    for e in range(len(room.strain)):
        stretch += room.tension[e] * room.strain[e]
    f[:] = 0.0
    band_bends(bands.bend_runs, bands.bend, 1.0, axes(x), axes(f))
    bend, kinetic = _works(f, inverse, x, v)
    return 0.25 * stretch - 0.5 * bend + 0.5 * kinetic


@njit(cache=True, error_model="numpy")
def height_energy(mass, gravity, x):
    """Energy of height [J] of x (3, V) under gravity (3,) [m/s2]."""
    along = 0.0
    for i in range(len(mass)):
        along += mass[i] * (gravity[0] * x[0, i] + gravity[1] * x[1, i] + gravity[2] * x[2, i])
    return -along


@njit(cache=True, error_model="numpy")
def ways(before, after, out):
    """How far each vertex has come, out (V,) [m], from before to after (3, V)."""
    for i in range(len(out)):
        a, b, c = after[0, i] - before[0, i], after[1, i] - before[1, i], after[2, i] - before[2, i]
        out[i] = np.sqrt(a * a + b * b + c * c)


@njit(cache=True, error_model="numpy")
def scattered(array, place, out):
    """out (V, 3): array (3, V) in another order, vertex i of out being place[i] of array."""
    for i in range(len(place)):
        n = place[i]
        out[i, 0], out[i, 1], out[i, 2] = array[0, n], array[1, n], array[2, n]


@njit(cache=True, error_model="numpy")
def longest2(edges, length2, x):
    """The largest |d|^2 / L^2 of any edge at x (3, V)."""
    most = 0.0
    for e in range(len(edges)):
        i, j = edges[e, 0], edges[e, 1]
        a, b, c = x[0, i] - x[0, j], x[1, i] - x[1, j], x[2, i] - x[2, j]
        ratio = (a * a + b * b + c * c) / length2[e]
        if not ratio <= most:  # NaN is the longest of all
            most = ratio
    return most


@njit(cache=True, error_model="numpy")
def lane_mode(lanes, inverse, room, x, mode, least, most, settled):
    """`stability._grown` for lanes: the largest eigenvalue of M^-1 K [1/s2] at x, mode (3, V), which is renewed."""
    b, out, aside = lanes.bands, room.force, room.air
    tension, change, none = room.tension, room.change, np.zeros(3)
    lane_strains(b.edge_runs, b.length2, axes(x), room.strain)
    lane_tensions(b.tension_runs, b.own, b.coupling, room.strain, tension)
    value = 0.0
    out[:] = 0.0
    for turn in range(most):
        before = value
        at, way, f, h = axes(x), axes(mode), axes(out), axes(aside)
        lane_strain_changes(b.edge_runs, at, way, room.strain)
        lane_tensions(b.tension_runs, b.own, b.coupling, room.strain, change)
        lane_leap(b.vertex_runs, change, inverse, at, none, (0.0, 1.0, 0.0), f, h)
        lane_leap(b.vertex_runs, tension, inverse, way, none, (1.0, 1.0, 0.0), f, h)
        if len(lanes.further_runs) > 0:
            lane_further(lanes.further_runs, change, inverse, at, 1.0, f)
            lane_further(lanes.further_runs, tension, inverse, way, 1.0, f)
        lane_bends(b.bend_runs, b.bend, inverse, 1.0, way, f)
        lane_odd_bends(lanes.odd, inverse, 1.0, way, f)
        sx = sy = sz = 0.0
        for i in range(len(inverse)):
            sx += out[0, i] * out[0, i]
            sy += out[1, i] * out[1, i]
            sz += out[2, i] * out[2, i]
        value = np.sqrt(sx + sy + sz)
        scale = mode.dtype.type(-1.0 / value if value > 0.0 else 0.0)
        for k in range(3):
            for i in range(len(inverse)):
                mode[k, i] = scale * out[k, i]
        if turn + 1 >= least and not value - before > settled * value:
            break
    return value
