"""Walking: the pure function step(pose, keys, dt, floor) -> pose. README.md has the mathematics."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

from hall_app.walk.body import BODY, Body, Contact, World, world_of
from hall_app.walk.solids import Floor

SPEED = 1.6  # [m/s] a calm walk
MAX_DT = 5.0  # [s] longer silences are cut: nobody walks 8 m between two frames
TOUCH = 1e-4  # [m] above the skin that still counts as contact
SLIDE = 0.025  # [m] of wished path per step along a contact: one frame at 60 Hz, so slow frames walk the same
STEEP = 1e-4  # sin² between the wish and the surface's normal below which the visitor rests (0.6°)
_TINY = 1e-6  # [m]
_TRIES = 5

Point = tuple[float, float]  # x, z [m]


@dataclass(frozen=True)
class Pose:
    """Where the visitor stands: x, z [m], yaw [rad] (0 looks to -z, positive to the left), eye height [m]."""

    x: float
    z: float
    yaw: float = 0.0
    eye: float = 1.6


@dataclass(frozen=True)
class Keys:
    """Held keys: forward (W, up: +1; S, down: -1) and right (D, right: +1; A, left: -1), each in -1..1."""

    forward: float = 0.0
    right: float = 0.0


def step(pose: Pose, keys: Keys, dt: float, floor: Floor, *, body: Body = BODY, speed: float = SPEED) -> Pose:
    """The pose after dt [s] of walking: slides along what is in the way, never enters it.

    A body that already overlaps a solid stays where it is (Grid.nearest_free finds it a place).
    Raises ValueError for non-finite pose, keys or dt, and for dt < 0.
    """
    wx, wz, strength = direction(keys, pose.yaw)
    if not (math.isfinite(pose.x + pose.z + wx + wz + dt) and dt >= 0):
        raise ValueError(f"step: pose {pose}, keys {keys}, dt {dt} – give finite numbers, dt >= 0")
    if strength == 0 or dt == 0:
        return pose
    world = world_of(floor, body)
    x, z = _travel(world, (pose.x, pose.z), (wx, wz), strength * speed * min(dt, MAX_DT))
    return replace(pose, x=x, z=z)


def direction(keys: Keys, yaw: float) -> tuple[float, float, float]:
    """(wx, wz, strength): horizontal unit direction of the keys at this yaw, and 0..1 of the full speed."""
    length = math.hypot(keys.forward, keys.right)
    if length == 0:
        return 0.0, 0.0, 0.0
    f, r = keys.forward / length, keys.right / length
    sin, cos = math.sin(yaw), math.cos(yaw)
    return -f * sin + r * cos, -f * cos - r * sin, min(length, 1.0)


class _Slid(NamedTuple):
    """One step along a contact: where it leads, how much of the path it used [m], the contact there."""

    at: Point
    used: float
    contact: Contact


def _travel(world: World, start: Point, wish: Point, left: float) -> Point:
    """Walk `left` [m] towards the unit vector `wish`; returns the last safe place."""
    (x, z), (wx, wz), skin = start, wish, world.body.skin
    contact = world.contact(x, z)
    if contact[0] < 0:
        return start
    for _ in range(16 + int(left / 0.01)):
        if left <= _TINY:
            break
        free = contact[0] - skin
        if 0.9 * free >= left:  # a translation below the clearance cannot collide
            x, z = x + left * wx, z + left * wz
            break
        if free > TOUCH:
            h, contact = _approach(world, (x, z), wish, left, contact)
            x, z, left = x + h * wx, z + h * wz, left - h
            continue
        moved = _slide(world, (x, z), wish, left, contact)
        if moved is None:
            break
        (x, z), used, contact = moved
        left -= used
    return start if world.collides(x, z) else (x, z)


def _approach(world: World, at: Point, wish: Point, left: float, contact: Contact) -> tuple[float, Contact]:
    """Longest tried straight step whose end is clear by the skin: (h [m], contact there)."""
    (x, z), (wx, wz), (c, *_), skin = at, wish, contact, world.body.skin
    safe = 0.9 * (c - skin)
    h = max(safe, min(left, world.body.leap))
    for _ in range(_TRIES):
        there = world.contact(x + h * wx, z + h * wz)
        c2, nx2, nz2 = there
        if c2 >= skin and (nx2 or nz2):
            return h, there
        # Secant to the place where the clearance equals the skin, a little short of it (half of TOUCH).
        h *= (c - skin - TOUCH / 2) / (c - min(c2, skin - _TINY))
        if h <= safe:
            break
    return safe, world.contact(x + safe * wx, z + safe * wz)


def _slide(world: World, at: Point, wish: Point, left: float, contact: Contact) -> _Slid | None:
    """One step along the contact, None where the visitor rests."""
    (x, z), (wx, wz), (c, nx, nz), skin = at, wish, contact, world.body.skin
    into = min(0.0, wx * nx + wz * nz)
    tx, tz = wx - into * nx, wz - into * nz
    share = math.hypot(tx, tz)
    if share * share <= STEEP:
        return None
    tx, tz = tx / share, tz / share
    least = min(c, skin) - 1e-9
    h = min(left, SLIDE) * share
    for _ in range(_TRIES):
        x2, z2 = x + h * tx, z + h * tz
        there = world.contact(x2, z2)
        c2, nx2, nz2 = there
        gap = skin - c2
        # Back to the skin: out of what is hit next, or round a convex curve while still pressing against it.
        if (nx2 or nz2) and (gap > 0 or wx * nx2 + wz * nz2 < 0) and abs(gap) < h:
            x2, z2 = x2 + gap * nx2, z2 + gap * nz2
            there = world.contact(x2, z2)
            c2, nx2, nz2 = there
        if c2 >= least and (nx2 or nz2):
            # Towards the wish, not counting the return from where p itself was off the skin: none in a wedge.
            progress = (x2 - x) * wx + (z2 - z) * wz - (skin - c) * (nx * wx + nz * wz)
            return _Slid((x2, z2), h / share, there) if progress > 1e-3 * h else None
        h /= 2
    return None
