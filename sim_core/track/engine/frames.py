"""One frame of tracking, in arrays: filter, global alignment of the trunk, limbs under their bones' lengths, rotations.

This is the numpy text of it; `kernels.py` holds the same steps as compiled loops, which give the same numbers to
rounding, several times as fast.
"""

from __future__ import annotations

import math

import numpy as np

from sim_core.track.engine.rotations import arcs, column, kabsch, product, quaternion_of, square, turned
from sim_core.track.engine.values import (
    FAR,
    FASTEST,
    HABIT,
    HALF,
    KALMAN,
    NEAR,
    ONE_EURO,
    TINY,
    Body,
    Frame,
    Rules,
    State,
)

__all__ = ["frame_step"]


def kalman(body, state, rules, joints, measured, step, drift):
    """Gated constant-velocity Kalman filter, one a joint, its axes alike. Accepted, taken up anew, variance (J,)."""
    noise, q = rules.noise**2, rules.agility
    spread = state.spread
    both = spread[:, 1] + step * spread[:, 2]
    place = spread[:, 0] + step * (spread[:, 1] + both) + q * step**3 / 3.0
    speed = spread[:, 2] + q * step
    both = both + q * step**2 / 2.0
    ahead = state.place + step * state.speed
    reach = joints - ahead
    need = place + noise
    state.bound[:] = np.where(
        state.misses > 0, state.bound, np.maximum(need, NEAR**2)
    )  # doubt does not open the gate to the next outlier
    inside = measured & (square(reach) <= rules.gate**2 * state.bound)
    misses = np.where(inside | ~measured, 0, state.misses + 1)
    again = misses >= rules.patience
    gain, lift = place / need * inside, both / need * inside
    fade = np.exp(-step / (rules.coasting * body.recall))
    kept = drift + (state.speed - drift) * column(fade)
    state.place[:] = ahead + column(gain) * reach
    state.speed[:] = np.where(column(inside), state.speed, kept) + column(lift) * reach
    spread[:, 0] = place * (1.0 - gain)
    spread[:, 1] = both * (1.0 - gain)
    spread[:, 2] = speed - lift * both
    if again.any():
        for joint in np.flatnonzero(again):
            state.place[joint] = joints[joint]
            state.speed[joint] = drift
            spread[joint, 0], spread[joint, 1], spread[joint, 2] = noise, 0.0, FASTEST**2
            misses[joint] = 0
    state.misses[:] = misses
    return inside | again, again, spread[:, 0].copy()


def one_euro(state, rules, joints, measured, step, drift):
    """One-Euro filter (Casiez, Roussel and Vogel 2012): the faster a joint, the less it is smoothed; no gate."""
    turn = 2.0 * math.pi * step
    rate = (joints - state.place) / step
    slow = turn / (turn + 1.0)  # the speed's own cutoff is 1 Hz
    speed = state.speed + slow * (rate - state.speed)
    cutoff = rules.cutoff + rules.cutoff_slope * np.sqrt(square(speed))
    share = turn * cutoff / (turn * cutoff + 1.0) * measured
    state.speed[:] = np.where(column(measured), speed, drift)
    state.place[:] = np.where(
        column(measured), state.place + column(share) * (joints - state.place), state.place + step * drift
    )
    return (
        measured.copy(),
        np.zeros(len(measured), np.bool_),
        np.where(measured, rules.noise**2 * share, FAR**2),
    )


def unfiltered(state, rules, joints, measured, step, drift):
    """No filter: what is measured is taken, what is not goes along with the trunk."""
    ahead = state.place + step * drift
    place = np.where(column(measured), joints, ahead)
    state.speed[:] = (place - state.place) / step
    state.place[:] = place
    return measured.copy(), np.zeros(len(measured), np.bool_), np.where(measured, rules.noise**2, FAR**2)


def guess_unseen(body, state, seen, turn, middle, shift, step):
    """What is not seen turns with the trunk, and comes to where it mostly is about the trunk, as swinging limbs do:
    after a time t the share exp(-t2 / 2 recall2) of its way from there is left, a swing's own correlation."""
    state.habit[seen] += (np.dot(state.place[seen] - shift, turn) - state.habit[seen]) * (
        step / (step + HABIT)
    )
    gone = state.gone
    if seen.all():
        gone[:] = 0.0
        return
    moved = np.dot(turn, state.trunk.T)
    there = middle + np.dot(state.place - middle, moved.T)
    usual = shift + np.dot(state.habit, turn.T)
    left = np.exp(-step * (2.0 * gone + step) / (2.0 * body.recall**2))
    there = usual + column(left) * (there - usual)
    state.place[:] = np.where(column(seen), state.place, there)
    gone[:] = np.where(seen, 0.0, gone + step)


def trunk_step(body, state, rules, seen, variance, step):
    """Global alignment of the torso's points (Eq. 13-14) and the trunk's own bend. Joints (J, 3), variance (J,), R, T.

    A point of the trunk is taken as far from its rigid place as it is loose, against how well it was seen.
    """
    there = state.place[body.torso]
    spread = variance[body.torso]
    trust = 1.0 / (spread + body.looseness + TINY)
    trust = trust / trust.sum()
    middle, centre = trust @ there, trust @ body.template
    shape = body.template - centre
    weighted = shape * column(trust)
    covariance = np.dot(weighted.T, there - middle)
    size = (weighted * shape).sum()
    turn = kabsch(covariance + rules.prior * size * state.trunk.T)
    shift = middle - turn @ centre
    rigid = np.dot(body.template, turn.T) + shift
    share = (body.looseness + TINY) / (body.looseness + TINY + spread)
    guess_unseen(body, state, seen, turn, middle, shift, step)
    joints = state.place.copy()
    joints[body.torso] = rigid + column(share) * (joints[body.torso] - rigid)
    surer = variance.copy()
    surer[body.torso] = spread * np.maximum(share, 1.0 / len(body.torso))
    return joints, surer, turn, shift


def pooled(body, joints, variance):
    """Joints (J, 3) and variances (J,): those that lie in one place are measurements of one, by their variances."""
    trust = 1.0 / (variance + TINY)
    total = np.bincount(body.one, trust, len(trust))[body.one]
    mean = np.zeros(joints.shape)
    for axis in range(3):
        mean[:, axis] = np.bincount(body.one, trust * joints[:, axis], len(trust))[body.one] / total
    return mean, 1.0 / total


def limb_step(body, state, rules, joints, variance):
    """Joints (J, 3) whose bones have their lengths, nearest to the given ones by their variances; iterations.

    While M (Eq. 17) of any bone exceeds M0: one step of Newton's method on d_pro = d_true (Eq. 15-16) of all bones
    together. Then every bone is laid on from the trunk outwards at its exact length.
    """
    child = body.bones[:, 1]
    weight = variance / variance.max() + 1e-6 if variance.max() > TINY else np.ones(len(variance))
    coupling = np.dot(body.incidence.T * weight, body.incidence)
    way = np.maximum(np.sqrt(square(joints - state.tracked))[child], rules.floor)
    rounds = 0
    while True:
        bone = np.dot(body.incidence.T, joints)
        spacing = np.sqrt(square(bone))
        along = bone / column(np.maximum(spacing, TINY))
        excess = spacing - body.lengths
        if rounds >= rules.iterations or (np.abs(excess) / way).max() <= rules.m0:
            break
        system = coupling * np.dot(along, along.T)
        for k in range(len(excess)):
            system[k, k] += 1e-6 * (1.0 + coupling[k, k])
        push = np.linalg.solve(system, excess)
        joints = joints - column(weight) * np.dot(body.incidence, column(push) * along)
        rounds += 1
    return joints, along, spacing, rounds


def turn_step(body, state, rules, along, trunk, step):
    """Rotations (B, 4) of the bones from rest: as before and with the trunk, then the shortest way to where each goes.

    A bone's points are collinear and say nothing of its twist: that is the last one, carried along, and wanders back
    to the twist of the shortest way from the trunk; the less, the nearer that way is to half a turn.
    """
    now = quaternion_of(trunk) + np.zeros((len(along), 4))
    moved = quaternion_of(np.dot(trunk, state.trunk.T))
    before = product(moved, state.turns)
    swing, _ = arcs(turned(before, body.directions), along)
    turns = product(swing, before)
    plain, near = arcs(turned(now, body.directions), along)
    home = product(plain, now)
    same = (home * turns).sum(axis=1)
    share = (1.0 - math.exp(-step / rules.untwist)) * 0.5 * near
    turns = turns + column(share * np.where(same < 0.0, -1.0, 1.0)) * home
    return turns / column(np.sqrt((turns * turns).sum(axis=1)))


def frame_step(
    body: Body, state: State, rules: Rules, joints: np.ndarray, measured: np.ndarray, step: float
) -> Frame:
    """Follows one frame: joints (J, 3) [m], finite everywhere, measured (J,) bool, step [s] since the last; `state`
    goes on."""
    drift = state.speed[body.torso].sum(axis=0) / len(body.torso)
    if rules.kind == KALMAN:
        seen, again, variance = kalman(body, state, rules, joints, measured, step, drift)
    elif rules.kind == ONE_EURO:
        seen, again, variance = one_euro(state, rules, joints, measured, step, drift)
    else:
        seen, again, variance = unfiltered(state, rules, joints, measured, step, drift)
    shaped, surer, trunk, shift = trunk_step(body, state, rules, seen, variance, step)
    if (body.ends != body.bones).any():
        shaped, surer = pooled(body, shaped, surer)
    near, along, spacing, rounds = limb_step(body, state, rules, shaped, surer)
    bent = (spacing <= 1e-9) | (body.lengths <= 0.0)  # both ends in one place: the bone points as it did
    if bent.any():
        along = np.where(column(bent), turned(state.turns, body.directions), along)
    root = body.bones[0, 0]
    tracked = near[root] + np.dot(body.paths, column(body.lengths) * along)
    turns = turn_step(body, state, rules, along, trunk, step)
    said = np.sqrt(square(np.dot(body.incidence.T, state.place)))
    delta = np.abs(body.lengths - said)
    way = np.sqrt(square(tracked - state.tracked))[body.bones[:, 1]]
    m = delta / np.maximum(way, rules.floor)
    flips = (np.abs((turns * state.turns).sum(axis=1)) < HALF).sum()
    flips += 0.5 * ((trunk * state.trunk).sum() - 1.0) < 0.0
    state.tracked[:] = tracked
    state.turns[:] = turns
    state.trunk[:] = trunk
    residual = np.sqrt(square(tracked - state.place))
    return Frame(tracked, seen, again, turns, trunk, shift, m, delta, residual, rounds, flips)
