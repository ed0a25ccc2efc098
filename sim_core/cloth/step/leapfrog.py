"""The compiled time loop: leapfrog with bending and air at longer steps, contact and self-contact, over one frame."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from sim_core.cloth.contact.collisions import (
    Push,
    Watch,
    collide_due_samples,
    collide_due_vertices,
    settle_samples,
)
from sim_core.cloth.contact.constraints import Holds, bound, draw_together, mirror
from sim_core.cloth.contact.layers.closing import PASSES, SHARE, THROUGH, hold_apart, listed_close, may_close
from sim_core.cloth.contact.layers.jerks import feel, look_from, stand_by
from sim_core.cloth.contact.layers.near_pairs import go_on, likely_way, no_pairs, renew_pairs
from sim_core.cloth.contact.layers.patches import Patches, Shapes
from sim_core.cloth.contact.layers.repulsion import Shell, repel, search_for, search_with
from sim_core.cloth.contact.packed import MOVING, Packed
from sim_core.cloth.step.frame import FREE, State
from sim_core.cloth.step.haste import LATE, passing_step
from sim_core.cloth.step.kernels.banded import axes, band_limit
from sim_core.cloth.step.kernels.leaps import arrive, leap, look_back

SHARED = 0.5  # of the largest push of a vertex, that a sample is pushed by: a dozen of them move one vertex
SETTLED = (
    0.2  # of the clearance, up to which the last look of a frame insists: all of it would strain the cloth
)
STRAYING = 0.25  # [m/s] beside what solids push, by which lists allow for ways that are not straight; more of it makes
# looks rarer that somebody strays to, and those more frequent that were planned
WATCH_EVERY = 8  # substeps between two looks at whether layers are too fast, whatever else is looked at
FEW = 32  # such looks a frame at least, as far as it has substeps


class Steps(NamedTuple):
    """How a frame is cut into steps."""

    count: int
    dt: float  # [s]
    last: float  # [s] the step before the frame; 0 at the start
    beta: float  # stiffness damping [s]
    slow: int  # steps between two looks at bending
    breaks: bool  # where layers are too fast for these steps
    whole: bool  # nothing comes between the kick and the drift of a step: no layers, no limit of speed


class Touch(NamedTuple):
    """What the cloth may touch, and what holds it: a solid and the samples it is felt with, its own layers, holds."""

    solid: Packed
    vertices: Watch
    middles: Watch  # edge midpoints and centroids
    shell: Shell
    patches: Patches
    shapes: Shapes
    holds: Holds


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
    spare: np.ndarray


def room_of(edges: int, vertices: int, longest: int, lanes: type | None = None) -> Room:
    """Room for E edges, V vertices and runs of `longest` faces.

    lanes: the numbers of lanes, which need a second array of positions; None: bands.
    """
    kind = lanes or np.float64

    def axes(count: int) -> np.ndarray:
        return np.zeros((3, count), kind)

    return Room(
        strain=np.zeros(edges, kind),
        before=np.zeros(edges, kind),
        tension=np.zeros(edges + vertices, kind),
        change=np.zeros(edges + vertices, kind),
        force=axes(vertices),
        air=axes(vertices),
        air_now=axes(vertices),
        air_past=axes(vertices),
        face=axes(max(longest, 1)),
        spare=axes(vertices if lanes else 0),
    )


@njit(error_model="numpy", inline="always")  # calls would count references to every array of the records
def _against_solids(touch, inverse, frame, steps, x, v, k):
    """Vertices whenever they may touch, then midpoints and centroids; returns how far vertices may have been pushed
    [m].

    Vertices come first, and once more at a frame's end those whom samples have pushed: what bears on samples alone
    slides without friction. Samples met in every second substep only shake the cloth at the highest frequency it has.
    """
    solid, shell, last, cap, dt = touch.solid, touch.shell, k == steps.count - 1, touch.shell.cap, steps.dt
    if solid.kind[0] == MOVING:
        early, late = frame.body
        solid.blend[0] = early + (late - early) * (k + 1) / steps.count
        solid.blend[1] = (late - early) / (steps.count * dt)
    push = Push(shell.clearance, cap, frame.friction, dt)
    pushed = collide_due_vertices(solid, inverse, x, v, touch.vertices, k, push)
    middles, r, most = touch.middles, shell.sample_clearance, SHARED * cap
    pushed += collide_due_samples(solid, inverse, x, v, middles, k, last, Push(r, most, 0.0, dt))
    if last:
        settle_samples(solid, inverse, x, v, middles, k, Push(SETTLED * r, cap, 0.0, dt))
        collide_due_vertices(solid, inverse, x, v, touch.vertices, k, push)
    return pushed


@njit(cache=True, error_model="numpy")
def _held_apart(touch, mesh, frame, steps, here, k, until, near):
    """Takes the speeds at which layers would be through each other `until` [s] they are asked again after substep k;
    whether that went.

    How far solids push meanwhile shows in the next substep, as the ways of vertices that are jerked.
    """
    x, v, most, solids = here.x.T, here.v.T, 1.0, len(touch.solid.kind) > 0
    thickness = touch.shell.thickness
    listed = listed_close(here.x, here.v, near, thickness, until)
    for n in range(PASSES + 1):
        most = hold_apart(x, v, mesh, near, thickness, until, k, listed)
        if most <= SHARE or n == PASSES:
            break
        if solids:
            _against_solids(touch, mesh.inverse_mass, frame, steps, x, v, k)
        listed = listed and listed_close(here.x, here.v, near, thickness, until)
    if most > SHARE and near.jerks.back[0]:
        near.jerks.back[1] = True
    return most <= THROUGH


@njit(error_model="numpy", inline="always")
def _sew(holds, inverse, frame, steps, x, v, k):
    """Draws sewing pairs together as far as they may be apart after substep k."""
    early, late = frame.sewing
    share = early + (late - early) * (k + 1) / steps.count
    draw_together(holds, inverse, x, v, share, (early - late) / (steps.count * steps.dt))


@njit(cache=True, error_model="numpy")
def advance(layout, mesh, touch, frame, steps, room, state, near):
    """Simulates a frame's steps over `Bands` or `Lanes`; the state's x, v (3, V) change in place.

    frame: its vertices and its body in the numbers of this loop. near: `NearPairs`, written over and returned, with
    longer lists where they were full; after it, whether all steps were done: see `Steps.breaks`. v lives half a step
    behind x.
    """
    here, there = state, State(room.spare, state.v)
    shell, inverse, holds, solids = touch.shell, mesh.inverse_mass, touch.holds, len(touch.solid.kind) > 0
    layers, pushed, straight = shell.thickness > 0.0, 0.0, (0.0, 0.0)
    late, bounded = not steps.whole or min(holds.limit) < 1.0, len(holds.low) + len(holds.slaves) > 0
    touch.vertices.wake[:] = 0
    touch.middles.wake[:] = 0
    look_layer, patches, shapes, done, nearest2, narrow = -1, touch.patches, touch.shapes, True, 0.0, False
    watch_every = min(WATCH_EVERY, max(1, steps.count // FEW))
    how = search_for(mesh, shell.thickness, shell.skin, 0.0)
    if steps.beta > 0.0:
        look_back(layout, steps, room, here)
    for k in range(steps.count):
        here, there = leap(layout, inverse, frame, steps, room, here, there, k)
        x, v = here.x.T, here.v.T
        if layers and k % shell.every == 0:
            astray, narrow, every = False, False, steps.dt * shell.every
            if k == 0:
                stand_by(here.x, here.v, near.jerks)
            else:
                straight = straight[0] + every, straight[1]
                astray = feel(here.x, here.v, near.jerks, every, straight)
            if k >= look_layer or astray:
                if look_layer < 0:
                    way = likely_way(x, v, patches, shapes, steps.count * steps.dt)
                    how = search_for(mesh, shell.thickness, shell.skin, way)
                    if go_on(near, how):
                        how = search_with(how.thickness, how.edge, near.kept[0])
                    else:
                        no_pairs(near, how)
                free = STRAYING + pushed / steps.dt
                within = free, k * steps.dt, (steps.count - k) * steps.dt
                near, holds_for, stray = renew_pairs(x, v, mesh, patches, shapes, how, near, within)
                # Until layers are asked the next time lists hold: who is too fast is seen from outside the shell.
                look_layer = k + 1 + int(min(holds_for / steps.dt, steps.count)) - shell.every
                straight, pushed = (0.0, stray), 0.0
                look_from(here.x, here.v, near.jerks)
            if near.now.count[1] + near.now.count[2] > 0:
                late_pairs, nearest2 = repel(x, v, mesh, near, shell, steps.dt * shell.every, k)
                if late_pairs and steps.breaks:
                    done = False
                    break
                narrow = nearest2 < shell.thickness * shell.thickness
        if narrow:
            near.jerks.leapt[:] = here.x
        if frame.speed_limit < FREE:
            band_limit(axes(here.v), frame.speed_limit)
        watch = layers and steps.breaks and k % watch_every == 0
        if watch and steps.dt * shell.every > LATE * passing_step(shell.thickness, here.v, solids):
            done = False
            break
        if late:
            arrive(layout, mesh, holds.limit, steps, room, here)
        if len(holds.pairs) > 0:
            _sew(holds, inverse, frame, steps, x, v, k)
        if solids:
            pushed = max(pushed, _against_solids(touch, inverse, frame, steps, x, v, k))
        until = steps.dt * (shell.every - k % shell.every)  # layers are asked again
        if narrow and may_close(here.x, here.v, near.jerks.leapt, nearest2, until):
            if not _held_apart(touch, mesh, frame, steps, here, k, until, near) and steps.breaks:
                done = False
                break
        if bounded:
            bound(holds, x, v)
            mirror(holds, x, v)
    near.course.plan[2] = steps.count * steps.dt
    state.x[:] = here.x  # lanes go to and fro between two arrays
    return near, done
