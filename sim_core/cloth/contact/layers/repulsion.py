"""Self-contact by velocity impulses on near vertex-triangle and edge-edge pairs.

A position push pumps energy into stacked folds; a velocity impulse of spring / dt per depth with damping of
the approach does not. The sign of a pair is its present side, so pairs must never pass through each other:
below a quarter of the shell the whole approaching velocity is taken away.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from numba import njit

from sim_core.cloth.contact.closest_points import at, segment_parameters, triangle_weights
from sim_core.cloth.contact.layers.pairs import NEARER, Search
from sim_core.cloth.contact.layers.patches import CONE
from sim_core.cloth.contact.sleep import apart_for

SHORT, LEAST_ROOM = (
    0.25,
    0.25,
)  # of the thickness, that is left of a gap after a step, and that any may lose in one
MOST_SLEEP = 10_000  # substeps: more than a frame has
WIDEST = math.cos(math.radians(120.0))  # of two normals in a stretch of cloth that does not meet itself
LEAST = 0.45  # of the skin, that calm cloth is looked through
CLOSE = 0.5  # of the thickness: what is nearer is noted as close
PARTING = 0.3  # of the thickness: as far as the spring lets a pair part in a step
LEVER = 4.0  # times the change of the gap's speed that one vertex may change its own by: near a pin arms are short


class Shell(NamedTuple):
    """The distances that a cloth keeps, from solids and from itself, as the compiled loops read them."""

    clearance: float  # [m] of vertices from solids
    sample_clearance: float  # [m] of midpoints and centroids
    cap: float  # [m] largest push out of a solid in a substep
    thickness: float  # [m] distance two layers keep; 0: they do not feel each other
    skin: float  # [m] candidates reach this much further
    spring: float  # impulse per depth, in units of mass / dt
    self_friction: float
    every: int  # substeps between two impulses
    separation: float  # share of the separating speed that is taken, as far as the spring pushes


@njit(cache=True, error_model="numpy")
def _impulse(x, v, inverse_mass, index, weight, shell, dt):
    """One contact between four vertices whose weights (signed, sum 0) span the separation; whether it pushed."""
    dx = dy = dz = vx = vy = vz = 0.0
    total = most = 0.0
    for k in range(4):
        i, w = index[k], weight[k]
        dx, dy, dz = dx + w * x[i, 0], dy + w * x[i, 1], dz + w * x[i, 2]
        vx, vy, vz = vx + w * v[i, 0], vy + w * v[i, 1], vz + w * v[i, 2]
        total += w * w * inverse_mass[i]
        most = max(most, abs(w) * inverse_mass[i])
    total = max(total, most / LEVER)
    gap = math.sqrt(dx * dx + dy * dy + dz * dz)
    if gap >= shell.thickness or gap < 1e-9 or total == 0.0:
        return False
    nx, ny, nz = dx / gap, dy / gap, dz / gap
    vn = vx * nx + vy * ny + vz * nz
    depth = 1.0 - gap / shell.thickness
    gain = shell.spring * (1.0 + 8.0 * depth * depth) * depth * shell.thickness / dt
    if vn < 0.0:
        gain += (1.0 if depth > 0.75 else 0.3) * -vn
    else:
        gain = max(gain - shell.separation * vn, 0.0)
    gain = max(min(gain, PARTING * shell.thickness / dt - vn), 0.0)
    tx, ty, tz = vx - vn * nx, vy - vn * ny, vz - vn * nz
    slide = math.sqrt(tx * tx + ty * ty + tz * tz)
    lost = 0.0
    if slide > 0.0:
        lost = min(0.5, shell.self_friction * gain / slide)
    for k in range(4):
        share = weight[k] * inverse_mass[index[k]] / total
        v[index[k], 0] += share * (gain * nx - lost * tx)
        v[index[k], 1] += share * (gain * ny - lost * ty)
        v[index[k], 2] += share * (gain * nz - lost * tz)
    return gain > 0.0


@njit(cache=True, error_model="numpy")
def _apart2(v, i, j):
    """The square of the speed [m2/s2], of velocities v (3, V), at which i and j part or meet, or pass each other."""
    return (v[0, i] - v[0, j]) ** 2 + (v[1, i] - v[1, j]) ** 2 + (v[2, i] - v[2, j]) ** 2


@njit(error_model="numpy", inline="always")
def _too_fast(meets, gap2, short, least, dt):
    """Whether what is gap away and comes nearer at meets / gap [m/s] is there in a step of dt [s], but for `short` [m].

    Slower than `least` [m/s] nothing is.
    """
    if meets <= 0.0 or meets * meets <= least * least * gap2:
        return False
    gap = math.sqrt(gap2)
    return meets * dt > gap * (gap - short)


@njit(error_model="numpy", inline="always")
def _struck(v, jerks, index):
    """Whether an impulse has made one of four vertices go otherwise than pairs that sleep reckon with: they are
    woken in this very pass, as if nobody had slept."""
    any_is = False
    for i in index:
        off2 = 0.0
        for c in range(3):
            off2 += (v[i, c] - jerks.going[c, i]) ** 2
        if off2 > jerks.sway2[i]:
            jerks.jerked[i] = any_is = True
    return any_is


@njit(error_model="numpy", inline="always")
def _among(close, place):
    """Notes a pair's place among the closest; where they are more than fit, only how many they are."""
    close[0] += 1
    if close[0] < len(close):
        close[close[0]] = place


@njit(cache=True, error_model="numpy")
def repel(x, v, mesh, near, shell, dt, step):
    """Impulses for the vertex-face pairs and edge-edge pairs of `NearPairs`, in its order, but for those that sleep: as
    long as they cannot meet while none of their vertices is jerked. Returns whether any come nearer so fast that they
    would be through each other a step later, and the square [m2] of the narrowest gap, the thickness at most.
    """
    reach2 = shell.thickness * shell.thickness
    points, crossings, counts, inverse_mass = (
        near.now.points,
        near.now.crossings,
        near.now.count,
        mesh.inverse_mass,
    )
    faces, edges = mesh.faces, mesh.edges
    going, jerked, some, sway2 = near.jerks.going, near.jerks.jerked, near.jerks.some[0], near.jerks.sway2
    short, least, late = SHORT * shell.thickness, LEAST_ROOM * shell.thickness / dt, False
    nearest2, close2, close, restless = reach2, CLOSE * CLOSE * reach2, near.close, near.jerks.restless
    close[0] = 0
    for k in range(counts[1]):
        if points[k, 2] > step and not some:
            continue
        i, f = points[k, 0], points[k, 1]
        a, b, c = faces[f, 0], faces[f, 1], faces[f, 2]
        if points[k, 2] > step and not (jerked[i] or jerked[a] or jerked[b] or jerked[c]):
            continue
        wa, wb, wc = triangle_weights(at(x, i), at(x, a), at(x, b), at(x, c))
        dx = x[i, 0] - wa * x[a, 0] - wb * x[b, 0] - wc * x[c, 0]
        dy = x[i, 1] - wa * x[a, 1] - wb * x[b, 1] - wc * x[c, 1]
        dz = x[i, 2] - wa * x[a, 2] - wb * x[b, 2] - wc * x[c, 2]
        gap2 = dx * dx + dy * dy + dz * dz
        meets = -(
            dx * (v[i, 0] - wa * v[a, 0] - wb * v[b, 0] - wc * v[c, 0])
            + dy * (v[i, 1] - wa * v[a, 1] - wb * v[b, 1] - wc * v[c, 1])
            + dz * (v[i, 2] - wa * v[a, 2] - wb * v[b, 2] - wc * v[c, 2])
        )
        if gap2 < reach2:
            nearest2 = min(nearest2, gap2)
            if gap2 < close2 or restless[i] or restless[a] or restless[b] or restless[c]:
                _among(close, k)
            points[k, 2] = step
            if _impulse(x, v, inverse_mass, (i, a, b, c), (1.0, -wa, -wb, -wc), shell, dt):
                some = _struck(v, near.jerks, (i, a, b, c)) or some
        else:
            late = late or _too_fast(meets, gap2, short, least, dt)
            fast2 = max(_apart2(going, i, a), _apart2(going, i, b), _apart2(going, i, c))
            sway = math.sqrt(sway2[i]) + math.sqrt(max(sway2[a], sway2[b], sway2[c]))
            points[k, 2] = step + min(
                MOST_SLEEP, apart_for(math.sqrt(gap2) - shell.thickness, fast2, sway, dt)
            )
    for k in range(counts[2]):
        if crossings[k, 2] > step and not some:
            continue
        e, g = crossings[k, 0], crossings[k, 1]
        a, b, c, d = edges[e, 0], edges[e, 1], edges[g, 0], edges[g, 1]
        if crossings[k, 2] > step and not (jerked[a] or jerked[b] or jerked[c] or jerked[d]):
            continue
        s, t = segment_parameters(at(x, a), at(x, b), at(x, c), at(x, d))
        dx = x[a, 0] + s * (x[b, 0] - x[a, 0]) - x[c, 0] - t * (x[d, 0] - x[c, 0])
        dy = x[a, 1] + s * (x[b, 1] - x[a, 1]) - x[c, 1] - t * (x[d, 1] - x[c, 1])
        dz = x[a, 2] + s * (x[b, 2] - x[a, 2]) - x[c, 2] - t * (x[d, 2] - x[c, 2])
        gap2 = dx * dx + dy * dy + dz * dz
        meets = -(
            dx * (v[a, 0] + s * (v[b, 0] - v[a, 0]) - v[c, 0] - t * (v[d, 0] - v[c, 0]))
            + dy * (v[a, 1] + s * (v[b, 1] - v[a, 1]) - v[c, 1] - t * (v[d, 1] - v[c, 1]))
            + dz * (v[a, 2] + s * (v[b, 2] - v[a, 2]) - v[c, 2] - t * (v[d, 2] - v[c, 2]))
        )
        if gap2 >= reach2:
            late = late or _too_fast(meets, gap2, short, least, dt)
            fast2 = max(
                _apart2(going, a, c), _apart2(going, a, d), _apart2(going, b, c), _apart2(going, b, d)
            )
            sway = math.sqrt(max(sway2[a], sway2[b])) + math.sqrt(max(sway2[c], sway2[d]))
            crossings[k, 2] = step + min(
                MOST_SLEEP, apart_for(math.sqrt(gap2) - shell.thickness, fast2, sway, dt)
            )
            continue
        crossings[k, 2] = step
        # A closest point at an end is a vertex near an edge, which the vertex-face pairs already hold.
        if 0.0 < s < 1.0 and 0.0 < t < 1.0:
            nearest2 = min(nearest2, gap2)
            if gap2 < close2 or restless[a] or restless[b] or restless[c] or restless[d]:
                _among(close, -1 - k)
            if _impulse(x, v, inverse_mass, (a, b, c, d), (1.0 - s, s, t - 1.0, -t), shell, dt):
                some = _struck(v, near.jerks, (a, b, c, d)) or some
    return late, nearest2


@njit(cache=True, error_model="numpy")
def search_for(mesh, thickness, most, way):
    """What a shell's pairs are looked for by, `way` [m] being how far patches are likely to go in a frame.

    Few pairs are cheap to look for, and many to look for seldom: the skin [m], at most `most`, is twice that way.
    """
    edges, length2, side = mesh.edges, mesh.length2, 0.0
    for e in range(len(edges)):
        side += math.sqrt(length2[e]) / len(edges)
    return search_with(thickness, side, min(most, max(LEAST * most, 2.0 * way)))


@njit(cache=True, error_model="numpy")
def search_with(thickness, side, skin):
    """`Search` of a cloth whose edges are `side` [m] long, by so much skin [m]."""
    reach = thickness + skin
    # A V whose sides open by this angle is as wide as it has to be where they are an edge's height from its crease.
    opening = 2.0 * math.asin(min(1.0, (thickness + NEARER * skin) / (math.sqrt(3.0) * side)))
    wide = min(max(math.cos(math.pi - opening), WIDEST), CONE)
    # Where edges are long, what touches at rest shares a vertex, and any other pair within reach is one to keep apart.
    return Search(thickness, reach, 3.5 * side if side < reach else 0.0, side, wide)
