"""How long what is apart may be left alone: until it could have met, at the speed it has and faster ones it may gain."""

from __future__ import annotations

import math

from numba import njit

GAINED = 0.2  # [m/s] that a sleeper may gain beside twice its speed
HASTE = 100.0  # [m/s2] at which it may fly off on the spot, ten times as fast as cloth falls
SOON = 40  # substeps: who sleeps longer is not asked at the end of a frame either


@njit(cache=True, error_model="numpy")
def asleep(room, fast2, drift, dt):
    """Substeps of dt [s] that `room` [m] lasts at twice the speed, squared fast2 [m2/s2], and at that of a surface
    beside, drift [m/s]; 0 where there is none.
    """
    if not room > 0.0:
        return 0
    at_speed = room / (2.0 * math.sqrt(fast2) + GAINED + drift)
    return int(min(at_speed, math.sqrt(2.0 * room / HASTE)) / dt)
