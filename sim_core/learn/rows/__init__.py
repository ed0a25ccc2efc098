"""What is compared: ways from a coarse sheet to a fine one, each a `Row` that follows a sequence frame by frame.

`plain` knows no training, `regression` fits local frames in closed form, `learned` runs a network; `measured` tells
errors and times of any, `followed` its frames, `counting` which of them the reference is good for; `physics` is the
engine itself on fewer vertices.
"""

from sim_core.learn.rows.learned import Ours
from sim_core.learn.rows.measured import (
    Measured,
    coarse_measured,
    counting,
    followed,
    measured,
    reference,
)
from sim_core.learn.rows.physics import led_physics
from sim_core.learn.rows.plain import Biharmonic, Linear
from sim_core.learn.rows.regression import LocalFrames
from sim_core.learn.rows.rivals import RivalRow, row_of
from sim_core.learn.rows.row import Follow, Row

__all__ = [
    "Biharmonic",
    "Follow",
    "Linear",
    "LocalFrames",
    "Measured",
    "Ours",
    "RivalRow",
    "Row",
    "coarse_measured",
    "counting",
    "followed",
    "led_physics",
    "measured",
    "reference",
    "row_of",
]
