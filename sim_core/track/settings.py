"""What a tracker goes by: the filter, the level of the feature points, and the limits of the local step."""

from __future__ import annotations

from dataclasses import dataclass

from sim_core.track.engine import KALMAN, NONE, ONE_EURO, Rules
from sim_core.validation import finite, integer, one_of

__all__ = ["FILTERS", "MOST_LEVEL", "TrackSettings"]

FILTERS = {"none": NONE, "kalman": KALMAN, "one-euro": ONE_EURO}
"""Filters by name."""
USUAL_NOISE = 0.01  # [m] of a sensor of which nothing is known
LEAST_NOISE = 0.001  # [m] for a gate that lets anything through
MOST_LEVEL = 6  # 25 joints are then 1 537 points


@dataclass(frozen=True)
class TrackSettings:
    """filter: of FILTERS; level: halvings of every bone; noise [m] of a measured joint, an axis, which decides how far
    the trunk's bend and a joint's jump are believed (0: all of it); None: as the calibration found it.

    Kalman: agility [m2/s3], the density of the accelerations that are taken for real; gate [sigma]; patience: rejected
    in a row until a joint is taken up anew; coasting: for so much of the time in which a joint comes back to where it
    mostly is, an unseen one goes on as it moved.
    One-Euro: cutoff [Hz] at rest and its slope [1/m] with speed. Local step: m0 of Eq. 17; floor [m] of the way in
    its denominator; iterations at most. Rotations: prior of the last one against the spread of the points; untwist
    [s] in which a bone's twist wanders back to the shortest way from the trunk. compiled: as machine code where numba
    is there; the same numbers to rounding.
    """

    filter: str = "kalman"
    level: int = 2
    noise: float | None = None
    agility: float = 40.0
    gate: float = 5.0
    patience: int = 3
    coasting: float = 1.0
    cutoff: float = 3.0
    cutoff_slope: float = 10.0
    m0: float = 0.1
    floor: float = 0.004
    iterations: int = 5
    prior: float = 1e-3
    untwist: float = 2.0
    compiled: bool = True

    def __post_init__(self) -> None:
        """Raises SimCoreError naming the setting, its value and its bounds."""
        one_of("filter", self.filter, tuple(FILTERS))
        integer("level", self.level, 0, f"give 0 to {MOST_LEVEL} halvings of a bone", MOST_LEVEL)
        integer("patience", self.patience, 1, "give 1 frame or more", 10_000)
        integer("iterations", self.iterations, 0, "give 0 to 100", 100)
        if self.noise is not None:
            finite("noise", self.noise, least=0.0, most=1.0)
        for name, least, most in (
            ("agility", 1e-6, 1e6),
            ("gate", 0.1, 1e6),
            ("coasting", 1e-3, 1e3),
            ("cutoff", 1e-3, 1e3),
            ("cutoff_slope", 0.0, 1e3),
            ("m0", 0.0, 1e9),
            ("floor", 1e-6, 1.0),
            ("prior", 0.0, 1e3),
            ("untwist", 1e-3, 1e9),
        ):
            finite(name, getattr(self, name), least=least, most=most)

    def rules(self, found: float | None) -> Rules:
        """As the engine takes them; found [m]: the calibration's noise, None where it could not tell."""
        noise = self.noise
        if noise is None:
            noise = found if found is not None else 0.0 if self.filter == "none" else USUAL_NOISE
        if self.filter == "kalman":
            noise = max(noise, LEAST_NOISE)
        return Rules(
            FILTERS[self.filter],
            float(noise),
            float(self.agility),
            float(self.gate),
            int(self.patience),
            float(self.coasting),
            float(self.cutoff),
            float(self.cutoff_slope),
            float(self.m0),
            float(self.floor),
            int(self.iterations),
            float(self.prior),
            float(self.untwist),
        )
