"""All readings of a cloth, with the bands that the assumptions leave.

Nothing is fitted. What the model does not settle is varied, one assumption at a time, and what that does to a reading
is its band: how much of its crimp finishing set in a yarn (.9, between .86 and .94: no source), how far a crossing yarn
presses (half of the round flanks of its section; a quarter, three), the modulus of the fibre (8 to 13 GPa of 10 in
textbooks) and the thickness of a filament (10 to 13 um of 11).
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any

import numpy as np

from sim_core.weave.instruments.held_filaments import Assumed
from sim_core.weave.instruments.readings import Reading, banded
from sim_core.weave.instruments.specimen import Specimen
from sim_core.weave.model import Weave
from sim_core.weave.yarns.geometry import YarnGeometry

__all__ = ["Laboratory"]

MOST_PULLED = 1_024  # crossings of a repeat that is pulled under every assumption
FINISHES = Assumed(kept=0.86), Assumed(kept=0.94)
VARIED = (
    *FINISHES,
    Assumed(wide=0.25),
    Assumed(wide=0.75),
    Assumed(modulus=0.8),
    Assumed(modulus=1.3),
    Assumed(filament=10 / 11),
    Assumed(filament=13 / 11),
)


class Laboratory:
    """The tests of one cloth.

    weave: simple, without extra wefts.  rest: of stage A.  vary: whether readings get bands.
    """

    def __init__(self, weave: Weave, rest: YarnGeometry, *, vary: bool = True) -> None:
        self.own = Specimen(weave, rest, Assumed())
        self.varied = [Specimen(weave, rest, assumed, self.own) for assumed in (VARIED if vary else ())]

    @cached_property
    def compliance(self) -> tuple[np.ndarray, list[np.ndarray]]:
        """Strain per tension [m/N], (2, 2), and under every assumption that is varied."""
        return self.own.compliance(), [one.compliance() for one in self.varied]

    @cached_property
    def thickness(self) -> dict[str, Reading]:
        """T0, TM and `free` [m]: only what was set changes them."""
        return self._read(Specimen.thickness, self.varied[: len(FINISHES)])

    @cached_property
    def bending(self) -> dict[str, dict[str, Reading]]:
        """B [N m] and 2HB [N] of warp and weft."""
        return self._read(Specimen.bending, self.varied)

    @cached_property
    def shear(self) -> dict[str, Reading]:
        """G [N/m per rad], 2HG, 2HG5 [N/m] and `secant` [N/m per rad]."""
        return self._read(Specimen.shear, self.varied)

    @cached_property
    def tensile(self) -> dict[str, dict[str, Reading]]:
        """EMT, LT, WT [J/m2] and RT of warp and weft; beyond 1,024 crossings, where a pull takes seconds, no bands."""
        return self._read(Specimen.tensile, self.varied if self.own.rest.force.size <= MOST_PULLED else [])

    def _read(self, test: Callable[[Specimen], dict], others: list[Specimen]) -> Any:
        return _banded(test(self.own), [test(one) for one in others])


def _banded(own: dict, others: list[dict]) -> dict:
    return {
        name: _banded(value, [one[name] for one in others])
        if isinstance(value, dict)
        else banded(name, value, [one[name] for one in others])
        for name, value in own.items()
    }
