"""The time loop over lanes: as `leapfrog.advance`, but a step is one pass from one array into another."""

from __future__ import annotations

import numpy as np
from numba import njit

from sim_core.cloth.contact.repulsion import candidate_pairs, repel
from sim_core.cloth.step.kernels.banded import band_ahead, band_air, band_limit
from sim_core.cloth.step.kernels.laned import (
    lane_bends,
    lane_damped_strains,
    lane_drift,
    lane_further,
    lane_kick,
    lane_leap,
    lane_odd_bends,
    lane_strain_before,
    lane_strains,
    lane_tensions,
)
from sim_core.cloth.step.leapfrog import AIR_EVERY, FREE, held, patience, travel

LEAST_KEPT = 1e-3  # share of its speed that heavy damping leaves in one step


@njit(cache=True, error_model="numpy")
def _tensions(lanes, around, room, x, last):
    """Fills room.tension at x (3, V)."""
    b = lanes.bands
    c, t = b.coupling, room.tension
    if around.beta > 0.0:
        rate = around.beta / last if last > 0.0 else 0.0
        lane_damped_strains(b.edge_runs, b.length2, x[0], x[1], x[2], rate, room.before, room.strain)
    else:
        lane_strains(b.edge_runs, b.length2, x[0], x[1], x[2], room.strain)
    lane_tensions(b.tension_runs, b.own, c[0], c[1], c[2], c[3], room.strain, t)


@njit(cache=True, error_model="numpy")
def _kicks(lanes, around, room, inverse, x, v, gain, part, last, slow_now, air_now):
    """What pulls beside the membrane's first six neighbours changes v (3, V); gain [s].

    Air comes first: it asks for the velocities of half a step ago, without any of this step's impulses.
    """
    b = lanes.bands
    if around.press > 0.0:
        air, raw, past = room.air, room.air_now, room.air_past
        if air_now:
            h, wind = room.face, around.wind
            wx = wind[0, 0] + part * (wind[1, 0] - wind[0, 0])
            wy = wind[0, 1] + part * (wind[1, 1] - wind[0, 1])
            wz = wind[0, 2] + part * (wind[1, 2] - wind[0, 2])
            ends = (raw[0], raw[1], raw[2], h[0], h[1], h[2])
            band_air(
                b.face_runs, x[0], x[1], x[2], v[0], v[1], v[2], 0.5 * last, wx, wy, wz, around.press, *ends
            )
            ahead = 0.5 if part > 0.0 else 0.0
            for k in range(3):
                band_ahead(raw[k], past[k], ahead, air[k])
        lane_kick(inverse, gain, air[0], air[1], air[2], v[0], v[1], v[2])
    if len(lanes.further_runs) > 0:
        lane_further(lanes.further_runs, room.tension, inverse, x[0], x[1], x[2], gain, v[0], v[1], v[2])
    if slow_now:
        most = gain * around.slow
        lane_bends(b.bend_runs, b.bend, inverse, most, x[0], x[1], x[2], v[0], v[1], v[2])
        odd = (lanes.odd_rows, lanes.odd_vertex, lanes.odd_other, lanes.odd_weight)
        lane_odd_bends(*odd, inverse, most, x[0], x[1], x[2], v[0], v[1], v[2])
    for k in range(len(around.pulled)):
        for axis in range(3):
            i = around.pulled[k]
            v[axis, i] += gain * inverse[i] * around.pull[k, axis]


@njit(cache=True, error_model="numpy")
def advance_lanes(
    lanes,
    inverse,
    edges,
    faces,
    rest,
    length2,
    packed,
    vertices,
    middles,
    holds,
    shell,
    around,
    room,
    finder,
    points,
    crossings,
    xs,
    vs,
    spare,
    last,
    dt,
    substeps,
):
    """`leapfrog.advance` for xs, vs, spare (3, V) of the lanes' numbers; xs and vs change in place, spare is room."""
    here, there, mark = xs, spare, room.mark.T
    layers, push = shell.thickness > 0.0, around.cap if len(packed.kind) > 0 else 0.0
    halved = layers or around.speed_limit < FREE  # something comes between the kick and the drift
    room.wake_vertices[:] = 0
    room.wake_middles[:] = 0
    look_layer, counts = -1, (0, 0)
    b = lanes.bands
    if around.beta > 0.0:
        lane_strain_before(
            b.edge_runs, b.length2, xs[0], xs[1], xs[2], vs[0], vs[1], vs[2], last, room.before
        )
    for step in range(substeps):
        span = 0.5 * (last + dt)
        loss = 0.5 * around.damping * span
        keep, gain = max((1.0 - loss) / (1.0 + loss), LEAST_KEPT), span / (1.0 + loss)
        _tensions(lanes, around, room, here, last)
        slow_now, air_now = step % around.slow == 0, step % AIR_EVERY == 0
        _kicks(lanes, around, room, inverse, here, vs, gain / keep, step / substeps, last, slow_now, air_now)
        ends = (there[0], there[1], there[2])
        begin, speed = (here[0], here[1], here[2]), (vs[0], vs[1], vs[2])
        way = 0.0 if halved else dt
        lane_leap(
            b.vertex_runs, room.tension, inverse, *begin, around.gravity, keep, gain, way, *speed, *ends
        )
        last = dt
        here, there = there, here
        x, v = here.T, vs.T
        if layers and step % shell.every == 0:
            if step >= look_layer:
                far, fast = travel(x, v, mark) if look_layer >= 0 else (np.inf, 0.0)
                if far > 0.3 * shell.skin:
                    points, crossings, counts = candidate_pairs(
                        x, rest, faces, edges, length2, holds.same, shell, finder, points, crossings
                    )
                    room.mark[:] = here
                    far, fast = travel(x, v, mark)
                look_layer = step + 1 + patience(0.5 * shell.skin - far, fast, dt, push)
            repel(x, v, inverse, faces, edges, points, crossings, counts, shell, dt * shell.every)
        if halved:
            if around.speed_limit < FREE:
                band_limit(vs[0], vs[1], vs[2], around.speed_limit)
            lane_drift(here[0], here[1], here[2], vs[0], vs[1], vs[2], dt)
        held(holds, packed, inverse, vertices, middles, around, room, x, v, dt, step, substeps)
    if substeps % 2 == 1:
        xs[:] = spare
    return points, crossings
