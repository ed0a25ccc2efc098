"""The three moves of a step, over bands and over lanes; compiled code takes those of the layout that it is given.

`look_back` sets what stiffness damping remembers, `leap` changes the velocities by all that pulls, and moves the cloth
where nothing comes between the kick and the drift (`steps.whole`), `arrive` does what is left of the step. Over bands
they change positions in place; over lanes a step is one pass from one array into another. All is inlined: a call
counts references to every array of the records that it hands on, and a small cloth has few vertices to pay for that.
"""

from __future__ import annotations

from typing import Any

from numba import njit
from numba.extending import overload

from sim_core.cloth.contact.constraints import keep_lengths
from sim_core.cloth.step.kernels.banded import (
    axes,
    band_add,
    band_ahead,
    band_air,
    band_bends,
    band_damped_strains,
    band_drift,
    band_kick,
    band_pulls,
    band_strain_before,
    band_strains,
    band_tensions,
)
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
from sim_core.cloth.step.kernels.lanes import Lanes

AIR_EVERY = 2  # substeps between two looks at the air
LEAST_KEPT = 1e-3  # share of its speed that heavy damping leaves in one step


@njit(error_model="numpy", inline="always")
def _span(frame, steps, k):
    """The step before step k [s], the share of its velocity that step k keeps, and the gain [s] of forces."""
    last = steps.last if k == 0 else steps.dt
    span = 0.5 * (last + steps.dt)
    loss = 0.5 * frame.damping * span
    return last, (1.0 - loss) / (1.0 + loss), span / (1.0 + loss)


@njit(error_model="numpy", inline="always")
def _rate(steps, last):
    """Stiffness damping for each change of strain in the step before."""
    return steps.beta / last if last > 0.0 else 0.0


@njit(error_model="numpy", inline="always")
def _look_at_air(face_runs, frame, steps, room, here, k, last):
    """Renews room.air (3, V) [N], every few steps."""
    if k % AIR_EVERY != 0:
        return
    raw, part, early, late = room.air_now, k / steps.count, frame.wind[0], frame.wind[1]
    wx = early[0] + part * (late[0] - early[0])
    wy = early[1] + part * (late[1] - early[1])
    wz = early[2] + part * (late[2] - early[2])
    at, speed, wind = axes(here.x), axes(here.v), (wx, wy, wz)
    band_air(face_runs, at, speed, 0.5 * last, wind, frame.press, axes(raw), axes(room.face))
    # Taken where velocities are, half a step ago, and held for the next steps, it acts on average half an
    # interval later: that far it is carried on.
    ahead = 0.5 if part > 0.0 else 0.0
    for axis in range(3):
        band_ahead(raw[axis], room.air_past[axis], ahead, room.air[axis])


@njit(error_model="numpy", inline="always")
def _bands_look_back(bands, steps, room, here):
    band_strain_before(bands.edge_runs, bands.length2, axes(here.x), axes(here.v), steps.last, room.before)


@njit(error_model="numpy", inline="always")
def _bands_forces(bands, frame, steps, room, here, k, last):
    """Everything that pulls on the vertices, into room.force [N]."""
    at, out = axes(here.x), axes(room.force)
    runs, length2 = bands.edge_runs, bands.length2
    if steps.beta > 0.0:
        band_damped_strains(runs, length2, at, _rate(steps, last), room.before, room.strain)
    else:
        band_strains(runs, length2, at, room.strain)
    band_tensions(bands.tension_runs, bands.own, bands.coupling, room.strain, room.tension)
    band_pulls(bands.vertex_runs, room.tension, at, out)
    if k % steps.slow == 0:
        band_bends(bands.bend_runs, bands.bend, float(steps.slow), at, out)
    if frame.press > 0.0:
        _look_at_air(bands.face_runs, frame, steps, room, here, k, last)
        band_add(out, axes(room.air))
    for n in range(len(frame.pulled)):
        for axis in range(3):
            room.force[axis, frame.pulled[n]] += frame.pulls[n, axis]


@njit(error_model="numpy", inline="always")
def _bands_leap(bands, inverse, frame, steps, room, here, there, k):
    last, keep, gain = _span(frame, steps, k)
    _bands_forces(bands, frame, steps, room, here, k, last)
    band_kick(inverse, axes(room.force), axes(frame.gravity), keep, gain, axes(here.v))
    if steps.whole:
        band_drift(axes(here.x), axes(here.v), steps.dt)
    return here, there


@njit(error_model="numpy", inline="always")
def _bands_arrive(bands, mesh, limit, steps, room, here):
    if not steps.whole:
        band_drift(axes(here.x), axes(here.v), steps.dt)
    if min(limit) < 1.0:
        strain = room.before if steps.beta > 0.0 else room.strain
        keep_lengths(limit, mesh.inverse_mass, mesh.edges, mesh.length2, strain, here.x.T, here.v.T)


@njit(error_model="numpy", inline="always")
def _lanes_look_back(lanes, steps, room, here):
    b = lanes.bands
    lane_strain_before(b.edge_runs, b.length2, axes(here.x), axes(here.v), steps.last, room.before)


@njit(error_model="numpy", inline="always")
def _lanes_tensions(lanes, steps, room, x, last):
    """Fills room.tension at x (3, V)."""
    b = lanes.bands
    if steps.beta > 0.0:
        lane_damped_strains(b.edge_runs, b.length2, axes(x), _rate(steps, last), room.before, room.strain)
    else:
        lane_strains(b.edge_runs, b.length2, axes(x), room.strain)
    lane_tensions(b.tension_runs, b.own, b.coupling, room.strain, room.tension)


@njit(error_model="numpy", inline="always")
def _lanes_kicks(lanes, inverse, frame, steps, room, here, k, gain):
    """What pulls beside the membrane's first six neighbours changes the velocities; gain [s].

    Air comes first: it asks for the velocities of half a step ago, without any of this step's impulses.
    """
    b, at, speed = lanes.bands, axes(here.x), axes(here.v)
    if frame.press > 0.0:
        _look_at_air(b.face_runs, frame, steps, room, here, k, steps.last if k == 0 else steps.dt)
        lane_kick(inverse, gain, axes(room.air), speed)
    if len(lanes.further_runs) > 0:
        lane_further(lanes.further_runs, room.tension, inverse, at, gain, speed)
    if k % steps.slow == 0:
        most = gain * steps.slow
        lane_bends(b.bend_runs, b.bend, inverse, most, at, speed)
        lane_odd_bends(lanes.odd, inverse, most, at, speed)
    for n in range(len(frame.pulled)):
        for axis in range(3):
            i = frame.pulled[n]
            here.v[axis, i] += gain * inverse[i] * frame.pulls[n, axis]


@njit(error_model="numpy", inline="always")
def _lanes_leap(lanes, inverse, frame, steps, room, here, there, k):
    last, keep, gain = _span(frame, steps, k)
    keep = max(keep, LEAST_KEPT)
    _lanes_tensions(lanes, steps, room, here.x, last)
    _lanes_kicks(lanes, inverse, frame, steps, room, here, k, gain / keep)
    runs, pace = lanes.bands.vertex_runs, (keep, gain, steps.dt if steps.whole else 0.0)
    at, speed = axes(here.x), axes(here.v)
    lane_leap(runs, room.tension, inverse, at, frame.gravity, pace, speed, axes(there.x))
    return there, here


@njit(error_model="numpy", inline="always")
def _lanes_arrive(lanes, mesh, limit, steps, room, here):
    if not steps.whole:
        lane_drift(axes(here.x), axes(here.v), steps.dt)


def look_back(layout, steps, room, here) -> Any:
    """Fills room.before, the strains of a step ago, at the begin of a frame."""
    raise NotImplementedError("for compiled code")


def leap(layout, inverse, frame, steps, room, here, there, k) -> Any:
    """Step k from `here`, where `there` is room for positions; returns where the cloth is now, and the other."""
    raise NotImplementedError("for compiled code")


def arrive(layout, mesh, limit, steps, room, here) -> Any:
    """What is left of a step once layers and a limit of speed have changed the velocities: drift, limits of lengths."""
    raise NotImplementedError("for compiled code")


@overload(look_back, inline="always")
def _look_back(layout, steps, room, here):
    way = _lanes_look_back if layout.instance_class is Lanes else _bands_look_back
    return lambda layout, steps, room, here: way(layout, steps, room, here)


@overload(leap, inline="always")
def _leap(layout, inverse, frame, steps, room, here, there, k):
    way = _lanes_leap if layout.instance_class is Lanes else _bands_leap
    return lambda layout, inverse, frame, steps, room, here, there, k: way(
        layout, inverse, frame, steps, room, here, there, k
    )


@overload(arrive, inline="always")
def _arrive(layout, mesh, limit, steps, room, here):
    way = _lanes_arrive if layout.instance_class is Lanes else _bands_arrive
    return lambda layout, mesh, limit, steps, room, here: way(layout, mesh, limit, steps, room, here)
