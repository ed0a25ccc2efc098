"""The steps of `frames.py` as loops for numba: the same arithmetic, one frame in tens of microseconds.

Machine code that is kept knows only of the file it was made from: whoever changes `turn_kernels.py` touches this file,
too.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from sim_core.track.engine.turn_kernels import between, carried, rotated, rotation
from sim_core.track.engine.values import FAR, FASTEST, HABIT, HALF, KALMAN, NEAR, ONE_EURO, TINY, Frame

__all__ = ["frame_kernel"]


@njit(cache=True)
def filtered(body, state, rules, joints, measured, step, drift):
    """Moves the filter's state on; accepted (J,), taken up anew (J,), variance (J,)."""
    count = len(joints)
    seen, again, variance = np.zeros(count, np.bool_), np.zeros(count, np.bool_), np.zeros(count)
    place, speed = state.place, state.speed
    noise, q = rules.noise**2, rules.agility
    turn = 2.0 * math.pi * step
    slow = turn / (turn + 1.0)
    for j in range(count):
        if rules.kind == KALMAN:
            spread = state.spread[j]
            both = spread[1] + step * spread[2]
            far = spread[0] + step * (spread[1] + both) + q * step**3 / 3.0
            fast = spread[2] + q * step
            both = both + q * step**2 / 2.0
            need = far + noise
            away = 0.0
            for k in range(3):
                away += (joints[j, k] - (place[j, k] + step * speed[j, k])) ** 2
            if state.misses[j] == 0:
                state.bound[j] = max(need, NEAR**2)
            inside = measured[j] and away <= rules.gate**2 * state.bound[j]
            misses = 0 if inside or not measured[j] else state.misses[j] + 1
            if misses >= rules.patience:
                place[j], speed[j] = joints[j], drift
                spread[0], spread[1], spread[2] = noise, 0.0, FASTEST**2
                state.misses[j] = 0
                seen[j] = again[j] = True
                variance[j] = noise
                continue
            fade = math.exp(-step / (rules.coasting * body.recall[j]))
            gain = far / need if inside else 0.0
            lift = both / need if inside else 0.0
            for k in range(3):
                ahead = place[j, k] + step * speed[j, k]
                reach = joints[j, k] - ahead
                if not inside:
                    speed[j, k] = drift[k] + (speed[j, k] - drift[k]) * fade
                place[j, k] = ahead + gain * reach
                speed[j, k] += lift * reach
            spread[0], spread[1], spread[2] = far * (1.0 - gain), both * (1.0 - gain), fast - lift * both
            state.misses[j] = misses
            seen[j], variance[j] = inside, spread[0]
            continue
        seen[j] = measured[j]
        variance[j] = FAR**2
        if rules.kind == ONE_EURO:
            if measured[j]:
                size = 0.0
                for k in range(3):
                    speed[j, k] += slow * ((joints[j, k] - place[j, k]) / step - speed[j, k])
                    size += speed[j, k] ** 2
                cutoff = rules.cutoff + rules.cutoff_slope * math.sqrt(size)
                share = turn * cutoff / (turn * cutoff + 1.0)
                for k in range(3):
                    place[j, k] += share * (joints[j, k] - place[j, k])
                variance[j] = noise * share
            else:
                for k in range(3):
                    speed[j, k] = drift[k]
                    place[j, k] += step * drift[k]
        else:
            for k in range(3):
                there = joints[j, k] if measured[j] else place[j, k] + step * drift[k]
                speed[j, k] = (there - place[j, k]) / step
                place[j, k] = there
            if measured[j]:
                variance[j] = noise
    return seen, again, variance


@njit(cache=True)
def guess(body, state, seen, turn, middle, shift, step):
    """As `guess_unseen`."""
    moved, there = between(turn, state.trunk), np.zeros(3)
    for j in range(len(seen)):
        place, habit, gone = state.place[j], state.habit[j], state.gone[j]
        if seen[j]:
            for i in range(3):
                own = 0.0
                for k in range(3):
                    own += turn[k, i] * (place[k] - shift[k])
                habit[i] += (own - habit[i]) * (step / (step + HABIT))
            state.gone[j] = 0.0
            continue
        left = math.exp(-step * (2.0 * gone + step) / (2.0 * body.recall[j] ** 2))
        for i in range(3):
            usual, ahead = shift[i], middle[i]
            for k in range(3):
                usual += turn[i, k] * habit[k]
                ahead += moved[i, k] * (place[k] - middle[k])
            there[i] = usual + left * (ahead - usual)
        state.place[j] = there
        state.gone[j] = gone + step


@njit(cache=True)
def aligned(body, state, rules, seen, variance, step):
    """As `trunk_step`."""
    torso, template = body.torso, body.template
    size = len(torso)
    trust = np.zeros(size)
    total = 0.0
    for n in range(size):
        trust[n] = 1.0 / (variance[torso[n]] + body.looseness[n] + TINY)
        total += trust[n]
    middle, centre = np.zeros(3), np.zeros(3)
    for n in range(size):
        trust[n] /= total
        for k in range(3):
            middle[k] += trust[n] * state.place[torso[n], k]
            centre[k] += trust[n] * template[n, k]
    covariance, extent = np.zeros((3, 3)), 0.0
    for n in range(size):
        for i in range(3):
            shape = template[n, i] - centre[i]
            extent += trust[n] * shape**2
            for j in range(3):
                covariance[i, j] += trust[n] * shape * (state.place[torso[n], j] - middle[j])
    for i in range(3):
        for j in range(3):
            covariance[i, j] += rules.prior * extent * state.trunk[j, i]
    turn = rotation(covariance)
    shift = np.zeros(3)
    for i in range(3):
        shift[i] = middle[i] - (turn[i, 0] * centre[0] + turn[i, 1] * centre[1] + turn[i, 2] * centre[2])
    guess(body, state, seen, turn, middle, shift, step)
    joints, surer = state.place.copy(), variance.copy()
    for n in range(size):
        j, loose = torso[n], body.looseness[n] + TINY
        share = loose / (loose + variance[j])
        for i in range(3):
            rigid = shift[i]
            rigid += turn[i, 0] * template[n, 0] + turn[i, 1] * template[n, 1] + turn[i, 2] * template[n, 2]
            joints[j, i] = rigid + share * (joints[j, i] - rigid)
        surer[j] = variance[j] * max(share, 1.0 / size)
    return joints, surer, turn, shift


@njit(cache=True)
def pool(body, joints, variance):
    """As `pooled`, in place."""
    one, count = body.one, len(joints)
    total, mean = np.zeros(count), np.zeros((count, 3))
    for j in range(count):
        trust = 1.0 / (variance[j] + TINY)
        total[one[j]] += trust
        for k in range(3):
            mean[one[j], k] += trust * joints[j, k]
    for j in range(count):
        variance[j] = 1.0 / total[one[j]]
        for k in range(3):
            joints[j, k] = mean[one[j], k] / total[one[j]]


@njit(cache=True)
def solved(system, right):
    """Solves a symmetric, positive definite system in place, by its factors L L'."""
    size = len(right)
    for i in range(size):
        for j in range(i + 1):
            total = system[i, j]
            for k in range(j):
                total -= system[i, k] * system[j, k]
            system[i, j] = math.sqrt(max(total, TINY)) if i == j else total / system[j, j]
    for i in range(size):
        for k in range(i):
            right[i] -= system[i, k] * right[k]
        right[i] /= system[i, i]
    for i in range(size - 1, -1, -1):
        for k in range(i + 1, size):
            right[i] -= system[k, i] * right[k]
        right[i] /= system[i, i]


@njit(cache=True)
def lengthened(body, state, rules, joints, variance):
    """As `limb_step`; `joints` are moved in place."""
    bones, lengths = body.ends, body.lengths
    count = len(bones)
    along, spacing, excess = np.zeros((count, 3)), np.zeros(count), np.zeros(count)
    weight = np.ones(len(joints))
    top = variance.max()
    if top > TINY:
        for j in range(len(joints)):
            weight[j] = variance[j] / top + 1e-6
    way = np.zeros(count)
    for b in range(count):
        child, total = body.bones[b, 1], 0.0
        for k in range(3):
            total += (joints[child, k] - state.tracked[child, k]) ** 2
        way[b] = max(math.sqrt(total), rules.floor)
    system = np.zeros((count, count))
    rounds = 0
    while True:
        worst = 0.0
        for b in range(count):
            parent, child = bones[b]
            total = 0.0
            for k in range(3):
                along[b, k] = joints[child, k] - joints[parent, k]
                total += along[b, k] ** 2
            spacing[b] = math.sqrt(total)
            for k in range(3):
                along[b, k] /= max(spacing[b], TINY)
            excess[b] = spacing[b] - lengths[b]
            worst = max(worst, abs(excess[b]) / way[b])
        if rounds >= rules.iterations or worst <= rules.m0:
            break
        for a in range(count):
            for b in range(a + 1):
                shared = 0.0
                for x in range(2):
                    for y in range(2):
                        if bones[a, x] == bones[b, y]:
                            shared += weight[bones[a, x]] if x == y else -weight[bones[a, x]]
                if shared != 0.0:
                    dot = 0.0
                    for k in range(3):
                        dot += along[a, k] * along[b, k]
                    system[a, b] = shared * dot
                else:
                    system[a, b] = 0.0
                if a == b:
                    system[a, a] += 1e-6 * (1.0 + shared)
        solved(system, excess)
        for b in range(count):
            parent, child = bones[b]
            for k in range(3):
                joints[parent, k] += weight[parent] * excess[b] * along[b, k]
                joints[child, k] -= weight[child] * excess[b] * along[b, k]
        rounds += 1
    return along, spacing, rounds


@njit(cache=True)
def frame_kernel(body, state, rules, joints, measured, step):
    """As `frame_step`."""
    count, bones = len(joints), len(body.bones)
    drift = np.zeros(3)
    for j in body.torso:
        for k in range(3):
            drift[k] += state.speed[j, k] / len(body.torso)
    seen, again, variance = filtered(body, state, rules, joints, measured, step, drift)
    near, surer, trunk, shift = aligned(body, state, rules, seen, variance, step)
    apart = True
    for b in range(bones):
        apart &= body.ends[b, 0] == body.bones[b, 0] and body.ends[b, 1] == body.bones[b, 1]
    if not apart:
        pool(body, near, surer)
    along, spacing, rounds = lengthened(body, state, rules, near, surer)
    m, delta, residual = np.zeros(bones), np.zeros(bones), np.zeros(count)
    tracked = np.zeros((count, 3))
    root = body.bones[0, 0]
    tracked[root] = near[root]
    for b in range(bones):
        parent, child = body.bones[b]
        if spacing[b] <= 1e-9 or body.lengths[b] <= 0.0:
            carried(state.turns[b], body.directions[b], along[b])
        way, said = 0.0, 0.0
        for k in range(3):
            tracked[child, k] = tracked[parent, k] + body.lengths[b] * along[b, k]
            way += (tracked[child, k] - state.tracked[child, k]) ** 2
            said += (state.place[body.ends[b, 1], k] - state.place[body.ends[b, 0], k]) ** 2
        delta[b] = abs(body.lengths[b] - math.sqrt(said))
        m[b] = delta[b] / max(math.sqrt(way), rules.floor)
    turns = rotated(body, state, rules, along, trunk, step)
    flips, trace = 0, -1.0
    for b in range(bones):
        same = 0.0
        for k in range(4):
            same += turns[b, k] * state.turns[b, k]
        flips += abs(same) < HALF
    for i in range(3):
        for k in range(3):
            trace += trunk[i, k] * state.trunk[i, k]
    flips += trace < 0.0
    for j in range(count):
        total = 0.0
        for k in range(3):
            total += (tracked[j, k] - state.place[j, k]) ** 2
        residual[j] = math.sqrt(total)
    state.tracked[:] = tracked
    state.turns[:] = turns
    state.trunk[:] = trunk
    return Frame(tracked, seen, again, turns, trunk, shift, m, delta, residual, rounds, flips)
