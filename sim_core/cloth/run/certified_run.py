"""A frame under the certifier: accepted, or rolled back and done again in parts whose ways are free."""

from __future__ import annotations

import time

import numpy as np

from sim_core.cloth.run.certificate import Certificate, Tally
from sim_core.cloth.run.certifier import Certifier, Mesh
from sim_core.cloth.step.engine import Engine, Stride
from sim_core.cloth.step.frame import FRAME, Frame, State
from sim_core.errors import SimCoreError

PARTS = 8  # of a frame that is done again
FINER = (2, 4)  # how many times more steps it is done with, one try after the other


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
        self, tally: Tally, frame: Frame, begin: State, end: State, stride: Stride
    ) -> tuple[State, int]:
        """The end, and the steps, of the frame that went from begin to end (3, V) in that stride.

        A frame that begins with intersections is left as it is, to untangle.
        """
        start = time.perf_counter()
        try:
            if tally.uncertified and self.certifier.intersections(begin.x.T):
                tally.uncertified += 1
                return end, stride.count
            if self.certifier.free(begin.x.T, end.x.T):
                return end, stride.count
            tally.redone += 1
            return self._again(tally, frame, begin, end, stride)
        finally:
            self.seconds += time.perf_counter() - start

    def _again(
        self, tally: Tally, frame: Frame, begin: State, end: State, stride: Stride
    ) -> tuple[State, int]:
        engine, slow = self.engine, self.engine.pace.slow
        for finer in FINER:
            steps = slow * int(np.ceil(finer * stride.count / (slow * PARTS)))
            part = Stride(steps, stride.last, usual=stride.usual, share=1 / PARTS)
            there, zones = self._in_parts(frame, begin, part)
            if zones >= 0 and engine.health.good(frame, begin, there):
                tally.zones += zones
                return there, steps * PARTS
            engine.forget()
        inverse = engine.inverse_mass(frame.pins)
        x, v, rounds, free = self.certifier.mended(begin.x.T, end.x.T, end.v.T, inverse)
        tally.zones += rounds
        if not free:
            tally.uncertified += 1
            return end, stride.count
        return State(np.ascontiguousarray(x.T), np.ascontiguousarray(v.T)), stride.count

    def _in_parts(self, frame: Frame, begin: State, stride: Stride) -> tuple[State, int]:
        """The frame's end and how often zones were needed, -1 where that did not help; stride: of each part."""
        engine, inverse, zones = self.engine, self.engine.inverse_mass(frame.pins), 0
        now = begin.copy()
        for part in range(PARTS):
            here = now.x.copy()
            under = frame.part(part / PARTS, (part + 1) / PARTS, engine.outward(here))
            engine.advance(under, now, stride)
            if not np.isfinite(now.x).all():
                return now, -1
            x, v, rounds, free = self.certifier.mended(here.T, now.x.T, now.v.T, inverse)
            if not free:
                return now, -1
            if rounds:
                now.x[:], now.v[:], zones = x.T, v.T, zones + rounds
            stride = stride._replace(last=FRAME / (PARTS * stride.count))
        return now, zones
