"""The face that all ways from coarse to fine have."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np

from sim_core.learn.data import Pair

__all__ = ["Follow", "Row"]

# The frames of one sequence in order: coarse (C, 3) -> fine (V, 3) [m]; may remember what it said before.
Follow = Callable[[np.ndarray], np.ndarray]


class Row(Protocol):
    """A row of the table. name: in the table and in JSON."""

    @property
    def name(self) -> str: ...

    def follow(self, pair: Pair) -> Follow:
        """One that follows a sequence of these sheets from its first kept frame on."""
        ...
