"""A frame under the certifier: accepted, or rolled back and done again in parts whose ways are free."""

from __future__ import annotations

import time

import numpy as np

from sim_core.cloth.run.certificate import Certificate, Tally
from sim_core.cloth.run.certifier import Certifier, Mesh
from sim_core.cloth.step.conditions import Conditions
from sim_core.cloth.step.engine import Engine
from sim_core.cloth.step.phases import FRAME
from sim_core.errors import SimCoreError

PARTS = 8  # of a frame that is done again
FINER = (2, 4)  # how many times more steps it is done with, one try after the other

State = tuple[np.ndarray, np.ndarray]


class Certified:
    """The certifier of one run; positions and velocities (3, V) in the engine's order."""

    def __init__(self, engine: Engine, start: np.ndarray, solid: Mesh | None) -> None:
        """start (V, 3) [m] in the caller's order. Raises SimCoreError for what cannot be certified."""
        if len(engine.holds.pairs) or len(engine.holds.slaves):
            raise SimCoreError("certify: sewing pairs and mirror images touch by design – weld them first")
        if solid is not None and engine.moving is not None:
            raise SimCoreError(
                "certify: the solid's mesh stands still, the collider moves – leave the mesh out"
            )
        self.engine, self.seconds = engine, 0.0
        self.certifier = Certifier(engine.inward(start).T, engine.sheet.faces, solid)

    def certificate(self, tally: Tally, frames: int, positions: np.ndarray) -> Certificate:
        """What came of `frames` frames that end at positions (V, 3) in the caller's order."""
        crossed = self.certifier.intersections(self.engine.inward(positions).T)
        good = frames - tally.uncertified
        return Certificate(good, tally.redone, tally.uncertified, tally.zones, crossed, self.seconds)

    def frame(
        self,
        tally: Tally,
        under: Conditions,
        pins: tuple[int, ...],
        begin: State,
        end: State,
        last: float,
        count: int,
        usual: float,
    ) -> tuple[np.ndarray, np.ndarray, int]:
        """Positions, velocities (3, V) and steps of the frame that went from begin to end in `count` steps.

        last [s]: the step before it; usual [s]: as for `Engine.advance`. A frame that begins with intersections is
        left as it is, to untangle.
        """
        start = time.perf_counter()
        try:
            if tally.uncertified and self.certifier.intersections(begin[0].T):
                tally.uncertified += 1
                return *end, count
            if self.certifier.free(begin[0].T, end[0].T):
                return *end, count
            tally.redone += 1
            return self._again(tally, under, pins, begin, end, last, count, usual)
        finally:
            self.seconds += time.perf_counter() - start

    def _again(
        self,
        tally: Tally,
        under: Conditions,
        pins: tuple[int, ...],
        begin: State,
        end: State,
        last: float,
        count: int,
        usual: float,
    ) -> tuple[np.ndarray, np.ndarray, int]:
        engine, inverse, slow = self.engine, self.engine.inverse_mass(pins), self.engine.pace.slow
        for finer in FINER:
            steps = slow * int(np.ceil(finer * count / (slow * PARTS)))
            x, v, zones = self._in_parts(under, pins, begin, last, steps, usual)
            if zones >= 0 and engine.health.good(under, begin, (x, v)):
                tally.zones += zones
                return x, v, steps * PARTS
            engine.forget()
        there, speed, rounds, free = self.certifier.mended(begin[0].T, end[0].T, end[1].T, inverse)
        tally.zones += rounds
        if not free:
            tally.uncertified += 1
            return *end, count
        return np.ascontiguousarray(there.T), np.ascontiguousarray(speed.T), count

    def _in_parts(
        self, under: Conditions, pins: tuple[int, ...], begin: State, last: float, steps: int, usual: float
    ) -> tuple[np.ndarray, np.ndarray, int]:
        """The frame's end and how often zones were needed, -1 where that did not help."""
        engine, inverse, zones = self.engine, self.engine.inverse_mass(pins), 0
        x, v = begin[0].copy(), begin[1].copy()
        for part in range(PARTS):
            early, late, here = part / PARTS, (part + 1) / PARTS, x.copy()
            now = under.part(early, late, engine.outward(x))
            engine.advance(now, pins, x, v, last, steps, share=1 / PARTS, usual=usual)
            if not np.isfinite(x).all():
                return x, v, -1
            there, speed, rounds, free = self.certifier.mended(here.T, x.T, v.T, inverse)
            if not free:
                return x, v, -1
            if rounds:
                x[:], v[:], zones = there.T, speed.T, zones + rounds
            last = FRAME / (PARTS * steps)
        return x, v, zones
