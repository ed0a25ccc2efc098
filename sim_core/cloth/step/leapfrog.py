"""The compiled time loop: leapfrog with bending and air at longer steps, contact and self-contact, over one frame."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from sim_core.cloth.contact.collisions import (
    collide_due_samples,
    collide_due_vertices,
    settle_samples,
)
from sim_core.cloth.contact.constraints import bound, draw_together, keep_lengths, limits, mirror
from sim_core.cloth.contact.packed import MOVING
from sim_core.cloth.contact.repulsion import candidate_pairs, repel
from sim_core.cloth.step.kernels.banded import (
    band_add,
    band_ahead,
    band_air,
    band_bends,
    band_damped_strains,
    band_drift,
    band_kick,
    band_limit,
    band_pulls,
    band_strain_before,
    band_strains,
    band_tensions,
)

SAMPLES_EVERY = 2  # substeps between two looks at midpoints and centroids (and always the last of a frame)
SETTLED = (
    0.2  # of the clearance, up to which the last look of a frame insists: all of it would strain the cloth
)
AIR_EVERY = 2  # substeps between two looks at the air
LOOK_EVERY = 16  # substeps at most between two looks at how far the cloth has moved
FREE = 1e3  # [m/s] a speed limit from here on is none


class Surroundings(NamedTuple):
    """What a frame is simulated under."""

    gravity: np.ndarray  # (3,) [m/s2]
    damping: float  # [1/s]
    beta: float  # [s]
    friction: float
    clearance: float  # [m] of vertices
    sample_clearance: float  # [m] of midpoints and centroids
    cap: float  # [m] largest push per substep
    speed_limit: float  # [m/s]
    sewing: tuple[
        float, float
    ]  # share of their first distance that pairs may have, at begin and end of the frame
    body: tuple[
        float, float
    ]  # where a moving grid stands between its keys, 0..1, at begin and end of the frame
    wind: np.ndarray  # (2, 3) [m/s] at begin and end of the frame
    press: float  # rho Cd / 12 [kg/m3]; 0: no air
    pulled: np.ndarray  # (P,) vertices that are pulled
    pull: np.ndarray  # (P, 3) [N]
    slow: int  # substeps between two looks at bending


class Room(NamedTuple):
    """Working memory of the loop, made once a run."""

    strain: np.ndarray
    before: np.ndarray
    tension: np.ndarray
    change: np.ndarray
    force: np.ndarray
    air: np.ndarray
    air_now: np.ndarray
    air_past: np.ndarray
    face: np.ndarray
    mark: np.ndarray
    wake_vertices: np.ndarray
    wake_middles: np.ndarray


def room_of(
    edges: int, vertices: int, longest: int, samples: tuple[int, int], kind: type = np.float64
) -> Room:
    """Room for E edges, V vertices, runs of `longest` faces and so many vertex and middle samples."""
    lines = [np.zeros(n, kind) for n in (edges, edges, edges + vertices, edges + vertices)]
    sizes = (vertices, vertices, vertices, vertices, max(longest, 1), vertices)
    fields = [np.zeros((3, n), kind) for n in sizes]
    return Room(*lines, *fields, *(np.zeros(n, np.int32) for n in samples))


@njit(cache=True, error_model="numpy")
def travel(x, v, mark):
    """How far (V, 3) x has come from its mark and how fast it goes, at most, off the cloth's mean."""
    dx = dy = dz = vx = vy = vz = 0.0
    for i in range(len(x)):
        dx, dy, dz = dx + x[i, 0] - mark[i, 0], dy + x[i, 1] - mark[i, 1], dz + x[i, 2] - mark[i, 2]
        vx, vy, vz = vx + v[i, 0], vy + v[i, 1], vz + v[i, 2]
    share = 1.0 / len(x)
    dx, dy, dz, vx, vy, vz = share * dx, share * dy, share * dz, share * vx, share * vy, share * vz
    far = fast = 0.0
    for i in range(len(x)):
        a, b, c = x[i, 0] - mark[i, 0] - dx, x[i, 1] - mark[i, 1] - dy, x[i, 2] - mark[i, 2] - dz
        far = max(far, a * a + b * b + c * c)
        a, b, c = v[i, 0] - vx, v[i, 1] - vy, v[i, 2] - vz
        fast = max(fast, a * a + b * b + c * c)
    return np.sqrt(far), np.sqrt(fast)


@njit(cache=True, error_model="numpy")
def patience(left, fast, dt, cap):
    """Substeps until `left` [m] may be used up at twice the speed `fast`, with pushes of `cap` each."""
    if not left > 0.0:
        return 0
    return int(min(LOOK_EVERY, left / (2.0 * fast * dt + cap + 1e-12)))


@njit(cache=True, error_model="numpy")
def _forces(bands, around, room, x, v, part, slow_now, air_now, last):
    """Everything that pulls on the vertices, into room.force [N]."""
    f, air = room.force, room.air
    runs, length2, c = bands.edge_runs, bands.length2, bands.coupling
    if around.beta > 0.0:
        rate = around.beta / last if last > 0.0 else 0.0
        band_damped_strains(runs, length2, x[0], x[1], x[2], rate, room.before, room.strain)
    else:
        band_strains(runs, length2, x[0], x[1], x[2], room.strain)
    band_tensions(bands.tension_runs, bands.own, c[0], c[1], c[2], c[3], room.strain, room.tension)
    band_pulls(bands.vertex_runs, room.tension, x[0], x[1], x[2], f[0], f[1], f[2])
    if slow_now:
        band_bends(bands.bend_runs, bands.bend, float(around.slow), x[0], x[1], x[2], f[0], f[1], f[2])
    if around.press > 0.0:
        if air_now:
            h, u, wind = room.face, around.press, around.wind
            wx = wind[0, 0] + part * (wind[1, 0] - wind[0, 0])
            wy = wind[0, 1] + part * (wind[1, 1] - wind[0, 1])
            wz = wind[0, 2] + part * (wind[1, 2] - wind[0, 2])
            raw, past = room.air_now, room.air_past
            ends = (raw[0], raw[1], raw[2], h[0], h[1], h[2])
            band_air(bands.face_runs, x[0], x[1], x[2], v[0], v[1], v[2], 0.5 * last, wx, wy, wz, u, *ends)
            # Taken where velocities are, half a step ago, and held for the next steps, it acts on average half an
            # interval later: that far it is carried on.
            ahead = 0.5 if part > 0.0 else 0.0
            for k in range(3):
                band_ahead(raw[k], past[k], ahead, air[k])
        band_add(f[0], f[1], f[2], air[0], air[1], air[2])
    for k in range(len(around.pulled)):
        for axis in range(3):
            f[axis, around.pulled[k]] += around.pull[k, axis]


@njit(cache=True, error_model="numpy")
def against_solids(packed, inverse, around, room, vertices, middles, x, v, dt, step, last):
    """Vertices whenever they may touch, midpoints and centroids every few substeps and at the frame's end."""
    r, c, cap = around.sample_clearance, around.clearance, around.cap
    if step % SAMPLES_EVERY == 0 or last:
        collide_due_samples(packed, inverse, x, v, middles, room.wake_middles, step, last, r, dt, cap)
        if last:
            settle_samples(packed, inverse, x, v, middles, room.wake_middles, step, SETTLED * r, cap)
    wake = room.wake_vertices
    collide_due_vertices(packed, inverse, x, v, vertices, wake, step, c, dt, around.friction, cap)


@njit(cache=True, error_model="numpy")
def held(holds, packed, inverse, vertices, middles, around, room, x, v, dt, step, substeps):
    """Seams, solids, bounds and images at the end of a substep: x, v (V, 3) change in place."""
    if len(holds.pairs) > 0:
        early, late = around.sewing
        share = early + (late - early) * (step + 1) / substeps
        draw_together(holds, inverse, x, v, share, (early - late) / (substeps * dt))
    if len(packed.kind) > 0:
        if packed.kind[0] == MOVING:
            early, late = around.body
            packed.blend[0] = early + (late - early) * (step + 1) / substeps
            packed.blend[1] = (late - early) / (substeps * dt)
        end = step == substeps - 1
        against_solids(packed, inverse, around, room, vertices, middles, x, v, dt, step, end)
    bound(holds, x, v)
    mirror(holds, x, v)


@njit(cache=True, error_model="numpy")
def advance(
    bands,
    inverse,
    edges,
    faces,
    rest,
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
    last,
    dt,
    substeps,
):
    """Simulates `substeps` steps of dt [s]; xs, vs (3, V) change in place.

    points, crossings (K, 2): lists for pairs, written over; returned, longer where they were full. v lives half a step
    behind x; `last` is the previous step (0 at the start). Lists of pairs are renewed before the cloth has moved half
    their margin off its mean.
    """
    x, v, mark = xs.T, vs.T, room.mark.T
    layers, push = shell.thickness > 0.0, around.cap if len(packed.kind) > 0 else 0.0
    room.wake_vertices[:] = 0
    room.wake_middles[:] = 0
    look_layer, counts = -1, (0, 0)
    g = around.gravity
    if around.beta > 0.0:
        band_strain_before(
            bands.edge_runs, bands.length2, xs[0], xs[1], xs[2], vs[0], vs[1], vs[2], last, room.before
        )
    for step in range(substeps):
        slow_now, air_now = step % around.slow == 0, step % AIR_EVERY == 0
        _forces(bands, around, room, xs, vs, step / substeps, slow_now, air_now, last)
        span = 0.5 * (last + dt)
        loss = 0.5 * around.damping * span
        f, keep, gain = room.force, (1.0 - loss) / (1.0 + loss), span / (1.0 + loss)
        band_kick(inverse, f[0], f[1], f[2], g[0], g[1], g[2], keep, gain, vs[0], vs[1], vs[2])
        last = dt
        if layers and step % shell.every == 0:
            if step >= look_layer:
                far, fast = travel(x, v, mark) if look_layer >= 0 else (np.inf, 0.0)
                if far > 0.3 * shell.skin:
                    points, crossings, counts = candidate_pairs(
                        x, rest, faces, edges, bands.length2, holds.same, shell, finder, points, crossings
                    )
                    room.mark[:] = xs
                    far, fast = travel(x, v, mark)
                look_layer = step + 1 + patience(0.5 * shell.skin - far, fast, dt, push)
            repel(x, v, inverse, faces, edges, points, crossings, counts, shell, dt * shell.every)
        if around.speed_limit < FREE:
            band_limit(vs[0], vs[1], vs[2], around.speed_limit)
        band_drift(xs[0], xs[1], xs[2], vs[0], vs[1], vs[2], dt)
        if limits(holds):
            strain = room.before if around.beta > 0.0 else room.strain
            keep_lengths(holds.limit, inverse, edges, bands.length2, strain, x, v)
        held(holds, packed, inverse, vertices, middles, around, room, x, v, dt, step, substeps)
    return points, crossings
