"""One frame of tracking in arrays, as numpy and as compiled loops."""

from sim_core.track.engine.frames import frame_step
from sim_core.track.engine.rotations import kabsch
from sim_core.track.engine.values import FASTEST, KALMAN, NONE, ONE_EURO, Body, Frame, Rules, State

__all__ = [
    "FASTEST",
    "KALMAN",
    "NONE",
    "ONE_EURO",
    "Body",
    "Frame",
    "Rules",
    "State",
    "compiled_kabsch",
    "compiled_step",
    "frame_step",
    "kabsch",
]


def compiled_step():
    """`frame_step` as machine code; the numpy text itself where numba is not there."""
    try:
        from sim_core.track.engine.kernels import frame_kernel
    except ModuleNotFoundError as error:
        if error.name != "numba":
            raise
        return frame_step
    return frame_kernel


def compiled_kabsch():
    """`kabsch` as machine code; numpy's own where numba is not there."""
    try:
        from sim_core.track.engine.turn_kernels import rotation
    except ModuleNotFoundError as error:
        if error.name != "numba":
            raise
        return kabsch
    return rotation
