"""A cloth that is stepped frame by frame while someone changes the wind, moves its pins and pulls at it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Unpack

import numpy as np

from sim_core.cloth.run.adaptive_run import Options, Run, Setup, checked_state
from sim_core.cloth.run.causes import check_hands
from sim_core.cloth.run.certificate import Certificate
from sim_core.cloth.sheet.sheet import Sheet
from sim_core.cloth.step.air import Air
from sim_core.cloth.step.frame import FRAME, Phase
from sim_core.errors import SimCoreError
from sim_core.validation import excerpt, finite, instance_of, points, vector3, vertex_indices


class Live:
    """The state of a running cloth; `step` moves it on by one frame of 1/25 s.

    sheet, positions (V, 3) [m] and options as for `drape`; gravity (3,) [m/s2]; damping [1/s] (None: the material's),
    which may be set anew between two frames. The same calls give the same bits on one machine. Raises SimCoreError on
    bad input.
    """

    def __init__(
        self,
        sheet: Sheet,
        positions: np.ndarray,
        *,
        gravity: Sequence[float] = (0.0, -9.81, 0.0),
        damping: float | None = None,
        **options: Unpack[Options],
    ) -> None:
        x, v = checked_state(sheet, positions, None)
        self._gravity = np.array(vector3("gravity", gravity, "in m/s2"))
        self.damping = sheet.material.mass_damping if damping is None else finite("damping", damping, least=0)
        setup = Setup(sheet, [Phase(FRAME)], **options)
        self._run = Run(setup)
        self._state = self._run.begun(x, v)
        self.pins, self.air, self.body = tuple(setup.pins), setup.air, 0.0

    @property
    def positions(self) -> np.ndarray:
        """(V, 3) [m] after the last step; a copy."""
        return self._state.positions.copy()

    @property
    def velocities(self) -> np.ndarray:
        """(V, 3) [m/s], half a substep before the positions; a copy."""
        return self._state.velocities.copy()

    @property
    def frame(self) -> int:
        """Frames stepped so far."""
        return self._state.frame

    @property
    def fallbacks(self) -> int:
        """Frames that the implicit scheme had to take over."""
        return self._state.fallbacks

    @property
    def smoothed(self) -> float:
        """The length [m] over which a hopeless start was smoothed; 0: it began where it was put."""
        return self._state.smoothed

    @property
    def substeps(self) -> int:
        """Steps of the last frame."""
        return round(FRAME / self._state.last_step) if self._state.last_step else 0

    @property
    def certificate(self) -> Certificate | None:
        """What the certifier saw so far, if there is one."""
        looked, state = self._run.certified, self._state
        return looked and looked.certificate(state.tally, state.frame, state.positions)

    def step(
        self,
        *,
        wind: Sequence[float] | None = None,
        pins: Sequence[int] | None = None,
        targets: np.ndarray | None = None,
        pulls: tuple[np.ndarray, np.ndarray] | None = None,
        body: float | None = None,
    ) -> np.ndarray:
        """Moves on by a frame; returns positions (V, 3) [m].

        wind (x, y, z) [m/s] from now on, reached within the frame; pins: the vertices held from now on; targets
        (len(pins), 3) [m]: where they are led within the frame (None: they stay); pulls: vertices (P,) and forces
        (P, 3) [N] of this frame; body: the key a moving collider reaches at the end of the frame. Raises SimCoreError
        on bad input; then, and where it is interrupted, all is as it was.
        """
        count, held, air = len(self._state.positions), self.pins, self.air
        held = vertex_indices("pins", held if pins is None else pins, count)
        if air is not None:
            instance_of("air", air, Air, "an Air is meant")
        before = np.zeros(3) if air is None else air.at(self._state.frame * FRAME)
        if wind is not None:
            air = (air or Air()).blowing(wind)
        after = before if air is None else air.at((self._state.frame + 1) * FRAME)
        early, late = (
            finite("body", key, least=0) for key in (self.body, self.body if body is None else body)
        )
        if self._run.engine.moving is not None:
            self._run.engine.moving.between(early, late)
        led, places = _checked_targets(targets, held)
        pulled, forces = _checked_pulls(pulls, count)
        frame = self._run.usual._replace(
            gravity=self._gravity,
            damping=finite("damping", self.damping, least=0),
            body=(early, late),
            wind=np.stack([before, after]),
            press=0.0 if air is None else air.press,
            pins=np.array(sorted(set(held)), np.int64),
            led=led,
            places=places,
            pulled=pulled,
            pulls=forces,
        )
        check_hands(self._run.engine, frame, self._state.positions)
        self._run.frame_under(self._state, frame)
        self.pins, self.air, self.body = held, air, late
        self._state.trace, self._state.seconds = self._state.trace[-1:], self._state.seconds[-1:]
        return self.positions


def _checked_targets(targets: np.ndarray | None, held: tuple[int, ...]) -> tuple[np.ndarray, np.ndarray]:
    """The vertices (L,) that are led, and where to (L, 3) [m]."""
    if targets is None:
        return np.zeros(0, np.int64), np.zeros((0, 3))
    places = points("targets", targets)
    if len(places) != len(held):
        raise SimCoreError(f"targets: shape {places.shape} – one finite place for each of {len(held)} pins")
    if len(set(held)) < len(held):
        raise SimCoreError("pins: one of them is there twice – lead each to one place")
    return np.array(held, np.int64), places


def _checked_pulls(pulls: tuple[np.ndarray, np.ndarray] | None, count: int) -> tuple[np.ndarray, np.ndarray]:
    """The vertices (P,) that are pulled, of `count`, and their forces (P, 3) [N]."""
    if pulls is None:
        return np.zeros(0, np.int64), np.zeros((0, 3))
    if not isinstance(pulls, tuple | list) or len(pulls) != 2:
        raise SimCoreError(f"pulls: {excerpt(pulls)} – give vertices (P,) and their forces (P, 3) [N]")
    index, force = vertex_indices("pulls: vertices", pulls[0], count), points("pulls: forces", pulls[1])
    if len(force) != len(index):
        raise SimCoreError(
            f"pulls: {len(index)} vertices and forces {force.shape} – one finite force for each"
        )
    return np.array(index, np.int64), force
