"""Speeds at which layers close their gap, taken until none of them is through before the next step.

`repel` goes once through its pairs, and a pair that it has stopped is set going again by the next one, by a floor, by a
heavy layer that comes after. So where anything is fast for the narrowest gap, pairs are gone through again and again
(Gauss and Seidel), with what solids say in between, and the speed is taken by which a pair would lose more than its
share of the gap: momentum stays, and nothing is pushed.
"""

from __future__ import annotations

import math

from numba import njit

from sim_core.cloth.contact.closest_points import at, segment_parameters, triangle_weights
from sim_core.cloth.contact.layers.repulsion import CLOSE, LEVER

__all__ = ["PASSES", "SHARE", "THROUGH", "hold_apart", "listed_close", "may_close"]

SHARE, HELD = 0.5, 0.25  # of a gap: what a pair may lose in a step, and does where it would lose more
THROUGH = 0.9  # of a gap: a pair that still loses more after all passes needs shorter steps
TAKEN_BACK = 0.7  # what is said of a pair that solids had pushed through each other: to be gone through again
PASSES = 24  # at most
NOTHING = 1e-6  # of the thickness: what is nearer and still closes cannot be kept apart


@njit(cache=True, error_model="numpy")
def may_close(x, v, leapt, gap2, dt):
    """Whether a share of a gap, whose square [m2] is given, may be closed: by velocities v (3, V) in a step of dt [s],
    and by the ways that vertices were pushed since they were at `leapt` (3, V)."""
    most, dt2 = 0.0, dt * dt
    (x0, x1, x2), (v0, v1, v2), (a0, a1, a2) = (
        (x[0], x[1], x[2]),
        (v[0], v[1], v[2]),
        (leapt[0], leapt[1], leapt[2]),
    )
    for i in range(len(v0)):
        pushed2 = (x0[i] - a0[i]) ** 2 + (x1[i] - a1[i]) ** 2 + (x2[i] - a2[i]) ** 2
        most = max(most, dt2 * (v0[i] * v0[i] + v1[i] * v1[i] + v2[i] * v2[i]) + pushed2)
    return 8.0 * most > SHARE * SHARE * gap2  # two vertices, and (a + b)² <= 2 (a² + b²)


@njit(cache=True, error_model="numpy")
def listed_close(x, v, near, thickness, dt):
    """Whether every pair that may lose its share of its gap in a step of dt [s] is listed as close: see `NearPairs`.

    One that is not is wider than CLOSE, and too wide for the speeds v (3, V) of its vertices and for the ways to x
    (3, V) that solids have pushed them since the leap – but for those that are noted as restless here, whose pairs will
    be listed from now on, as long as they are within the shell.
    """
    if near.close[0] >= len(near.close):
        return False
    restless, leapt, listed = near.jerks.restless, near.jerks.leapt, True
    (x0, x1, x2), (v0, v1, v2), (a0, a1, a2) = (
        (x[0], x[1], x[2]),
        (v[0], v[1], v[2]),
        (leapt[0], leapt[1], leapt[2]),
    )
    calm = 0.5 * CLOSE * thickness
    for i in range(len(restless)):
        way = math.sqrt((x0[i] - a0[i]) ** 2 + (x1[i] - a1[i]) ** 2 + (x2[i] - a2[i]) ** 2)
        way += math.sqrt(v0[i] * v0[i] + v1[i] * v1[i] + v2[i] * v2[i]) * dt / SHARE
        if way > calm and not restless[i]:
            restless[i], listed = True, False
    return listed


@njit(cache=True, error_model="numpy")
def hold_apart(x, v, mesh, near, thickness, dt, step, listed):
    """One pass over the pairs of `NearPairs` that were within the shell after the leap, or only those that are `listed`
    as close; the greatest share of its gap that one was found losing. Wider ones are none of its business: whether
    they are in the lists depends on when these were made.

    What solids have pushed through each other since the substep's leap goes back to where it was then, and
    `near.jerks.back` tells of it, and of what is pressed to nothing.
    """
    now, close, jerked, leapt, back = (
        near.now,
        near.close,
        near.jerks.jerked,
        near.jerks.leapt.T,
        near.jerks.back,
    )
    points, crossings, counts, inverse_mass = now.points, now.crossings, now.count, mesh.inverse_mass
    faces, edges, most, within = mesh.faces, mesh.edges, 0.0, (dt, thickness * thickness)
    if listed:
        for n in range(1, close[0] + 1):
            k = close[n]
            if k >= 0:
                index, weight = _of_point(x, points[k, 0], points[k, 1], faces)
            else:
                index, weight = _of_edges(x, crossings[-1 - k, 0], crossings[-1 - k, 1], edges)
            most = max(most, _held(x, v, leapt, back, inverse_mass, index, weight, within))
        return most
    for k in range(counts[1]):
        i, f = points[k, 0], points[k, 1]
        woken = jerked[i] or jerked[faces[f, 0]] or jerked[faces[f, 1]] or jerked[faces[f, 2]]
        if points[k, 2] <= step or woken:
            index, weight = _of_point(x, i, f, faces)
            most = max(most, _held(x, v, leapt, back, inverse_mass, index, weight, within))
    for k in range(counts[2]):
        e, g = crossings[k, 0], crossings[k, 1]
        woken = jerked[edges[e, 0]] or jerked[edges[e, 1]] or jerked[edges[g, 0]] or jerked[edges[g, 1]]
        if crossings[k, 2] <= step or woken:
            index, weight = _of_edges(x, e, g, edges)
            most = max(most, _held(x, v, leapt, back, inverse_mass, index, weight, within))
    return most


@njit(error_model="numpy", inline="always")
def _of_point(x, i, f, faces):
    """The four vertices of a vertex and a face, and their weights (signed, sum 0) in the gap between."""
    a, b, c = faces[f, 0], faces[f, 1], faces[f, 2]
    wa, wb, wc = triangle_weights(at(x, i), at(x, a), at(x, b), at(x, c))
    return (i, a, b, c), (1.0, -wa, -wb, -wc)


@njit(error_model="numpy", inline="always")
def _of_edges(x, e, g, edges):
    """Those of two edges likewise; nothing where an end is closest, which a vertex and a face tell."""
    a, b, c, d = edges[e, 0], edges[e, 1], edges[g, 0], edges[g, 1]
    s, t = segment_parameters(at(x, a), at(x, b), at(x, c), at(x, d))
    if not (0.0 < s < 1.0 and 0.0 < t < 1.0):
        return (a, b, c, d), (0.0, 0.0, 0.0, 0.0)
    return (a, b, c, d), (1.0 - s, s, t - 1.0, -t)


@njit(cache=True, error_model="numpy")
def _held(x, v, leapt, back, inverse_mass, index, weight, within):
    """One pair, whose four vertices' weights span its gap; the share that it was losing in a step."""
    dx = dy = dz = vx = vy = vz = ox = oy = oz = 0.0
    for k in range(4):
        i, w = index[k], weight[k]
        dx, dy, dz = dx + w * x[i, 0], dy + w * x[i, 1], dz + w * x[i, 2]
        vx, vy, vz = vx + w * v[i, 0], vy + w * v[i, 1], vz + w * v[i, 2]
        ox, oy, oz = ox + w * leapt[i, 0], oy + w * leapt[i, 1], oz + w * leapt[i, 2]
    least, (dt, reach2), leapt2 = 0.0, within, ox * ox + oy * oy + oz * oz
    if leapt2 >= reach2:
        return least
    if ox * dx + oy * dy + oz * dz < (1.0 - THROUGH) * leapt2:
        for k in range(4):
            for c in range(3):
                x[index[k], c] = leapt[index[k], c]
        dx, dy, dz, least, back[0] = ox, oy, oz, TAKEN_BACK, True
    gap2 = dx * dx + dy * dy + dz * dz
    meets = -(vx * dx + vy * dy + vz * dz)
    if meets * dt <= SHARE * gap2:
        return least
    if min(gap2, leapt2) < NOTHING * NOTHING * reach2:
        back[1] = True
    if gap2 == 0.0:
        return least
    total = most = 0.0
    for k in range(4):
        i, w = index[k], weight[k]
        total += w * w * inverse_mass[i]
        most = max(most, abs(w) * inverse_mass[i])
    total = max(total, most / LEVER)
    if total > 0.0:
        # Speed over the gap, so that directions need no root.
        gain = (meets - HELD * gap2 / dt) / gap2 / total
        for k in range(4):
            share = gain * weight[k] * inverse_mass[index[k]]
            v[index[k], 0] += share * dx
            v[index[k], 1] += share * dy
            v[index[k], 2] += share * dz
    return max(least, meets * dt / gap2)
