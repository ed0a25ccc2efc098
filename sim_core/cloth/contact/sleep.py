"""How long what is apart may be left alone: until it could have met, at its speed and what it may gain.

Who is near a solid may gain what thrown cloth gains; layers are woken where one goes otherwise (`layers/jerks.py`).
"""

from __future__ import annotations

import math

from numba import njit

GAINED = 0.2  # [m/s] that a sleeper may gain beside twice its speed
HASTE = 100.0  # [m/s2] at which it may fly off, ten times as fast as cloth falls
SOON = 40  # substeps: who sleeps longer is not asked at the end of a frame either


@njit(error_model="numpy", inline="always")
def asleep(room, fast2, drift, dt):
    """Substeps of dt [s] that `room` [m] lasts at twice the speed, squared fast2 [m2/s2], while a surface comes nearer
    at `drift` [m/s]; 0 where there is none.

    Between two keys a body's distance at a place changes evenly, so what it loses now it loses until the frame's end.
    """
    left, speed = max(room, 0.0), 2.0 * math.sqrt(fast2) + GAINED + drift
    return int((math.sqrt(speed * speed + 2.0 * HASTE * left) - speed) / (HASTE * dt))


@njit(error_model="numpy", inline="always")
def apart_for(room, fast2, sway, dt):
    """Substeps of dt [s], at least one, after which what is `room` [m] apart may have met: at the speed whose square is
    fast2 [m2/s2], while both sides together go otherwise by less than `sway` [m/s]."""
    return max(1, int(max(room, 0.0) / ((math.sqrt(fast2) + sway) * dt)))
