"""The compiled time loop: leapfrog, contact and self-contact, over one frame."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from sim_core.cloth.collider import MOVING
from sim_core.cloth.contact import collide_samples, collide_vertices, near_samples
from sim_core.cloth.forces import edge_tensions, kick
from sim_core.cloth.holding import bound, draw_together, mirror
from sim_core.cloth.repulsion import candidate_pairs, repel

CONTACT_REACH = 0.02  # [m] samples further away than this are left out until the cloth has moved half of it

SAMPLES_EVERY = 4  # substeps between two looks at midpoints and centroids (and always the last of a frame)


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


@njit(cache=True, error_model="numpy")
def _drift(x, v, dt, speed_limit):
    """x += dt v with speeds held below the limit; returns the mean step (3,) and the longest off the mean [m]."""
    mean = np.zeros(3)
    for i in range(len(x)):
        speed2 = v[i, 0] ** 2 + v[i, 1] ** 2 + v[i, 2] ** 2
        if speed2 > speed_limit * speed_limit:
            slower = speed_limit / np.sqrt(speed2)
            v[i, 0], v[i, 1], v[i, 2] = v[i, 0] * slower, v[i, 1] * slower, v[i, 2] * slower
        for c in range(3):
            x[i, c] += dt * v[i, c]
            mean[c] += v[i, c]
    mean /= len(x)
    fastest = 0.0
    for i in range(len(x)):
        off = (v[i, 0] - mean[0]) ** 2 + (v[i, 1] - mean[1]) ** 2 + (v[i, 2] - mean[2]) ** 2
        fastest = max(fastest, off)
    return dt * mean, dt * np.sqrt(fastest)


@njit(cache=True, error_model="numpy")
def _moved(x, mark, shift):
    """Largest distance of any vertex from its mark moved by shift (3,) [m]."""
    far = 0.0
    for i in range(len(x)):
        dx, dy, dz = (
            x[i, 0] - mark[i, 0] - shift[0],
            x[i, 1] - mark[i, 1] - shift[1],
            x[i, 2] - mark[i, 2] - shift[2],
        )
        far = max(far, dx * dx + dy * dy + dz * dz)
    return np.sqrt(far)


@njit(cache=True, error_model="numpy")
def advance(stencil, rest, faces, packed, vertices, middles, holds, shell, around, x, v, last, dt, substeps):
    """Simulates `substeps` steps of dt [s]; x, v (V, 3) change in place; returns how often pairs were looked for.

    v lives half a step behind x; `last` is the previous step (0 at the start). Lists are renewed before the cloth
    has moved half their margin (for pairs: off its mean).
    """
    strain, tension = np.zeros(len(stencil.edges)), np.zeros(len(stencil.edges))
    force, inverse = np.zeros_like(x), stencil.inverse_mass
    solids, layers = len(packed.kind) > 0, shell.thickness > 0.0
    mark_solid, mark_layer, near_v, near_m = x.copy(), x.copy(), vertices[:0], middles[:0]
    points, crossings = np.zeros((0, 2), np.int32), np.zeros((0, 2), np.int32)
    moved_solid, moved_layer, searches = np.inf, np.inf, 0
    shift, still = np.zeros(3), np.zeros(3)
    for step in range(substeps):
        edge_tensions(stencil, x, v, around.beta, strain, tension)
        kick(stencil, x, v, tension, force, 0.5 * (last + dt), around.damping, around.gravity)
        last = dt
        if layers and step % shell.every == 0:
            if moved_layer > 0.5 * shell.skin:
                moved_layer = _moved(x, mark_layer, shift) if moved_layer < np.inf else np.inf
                if moved_layer > 0.4 * shell.skin:
                    points, crossings = candidate_pairs(
                        x, rest, faces, stencil.edges, stencil.length2, holds.same, shell
                    )
                    mark_layer[:], shift[:], moved_layer, searches = x, 0.0, 0.0, searches + 1
            repel(x, v, inverse, faces, stencil.edges, points, crossings, shell, dt * shell.every)
        mean, way = _drift(x, v, dt, around.speed_limit)
        shift += mean
        moved_layer += way + around.cap * solids
        moved_solid += way + np.sqrt((mean * mean).sum()) + around.cap * solids
        if len(holds.pairs) > 0:
            early, late = around.sewing
            share = early + (late - early) * (step + 1) / substeps
            draw_together(holds, inverse, x, v, share, (early - late) / (substeps * dt))
        if not solids:
            bound(holds, x, v)
            mirror(holds, x, v)
            continue
        if packed.kind[0] == MOVING:
            early, late = around.body
            packed.blend[0] = early + (late - early) * (step + 1) / substeps
            packed.blend[1] = (late - early) / (substeps * dt)
        if moved_solid > 0.5 * CONTACT_REACH:
            moved_solid = _moved(x, mark_solid, still) if moved_solid < np.inf else np.inf
            if moved_solid > 0.4 * CONTACT_REACH:
                reach = around.clearance + CONTACT_REACH
                near_v, near_m = (
                    near_samples(packed, x, vertices, reach),
                    near_samples(packed, x, middles, reach),
                )
                mark_solid[:], moved_solid = x, 0.0
        if step % SAMPLES_EVERY == 0 or step == substeps - 1:
            collide_samples(packed, inverse, x, v, near_m, around.sample_clearance, around.cap)
        collide_vertices(packed, inverse, x, v, near_v, around.clearance, dt, around.friction, around.cap)
        bound(holds, x, v)
        mirror(holds, x, v)
    return searches
