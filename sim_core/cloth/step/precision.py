"""How a run is paced, and the state of one that runs over lanes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim_core.cloth.contact.layers.near_pairs import NearPairs
from sim_core.cloth.contact.layers.pairs import Mesh
from sim_core.cloth.sheet.sheet import Sheet
from sim_core.cloth.step.frame import Frame, State
from sim_core.cloth.step.kernels.bands import Bands
from sim_core.cloth.step.kernels.diagnostics import lane_mode, stored_lanes
from sim_core.cloth.step.kernels.lanes import Lanes, lattice_lanes, plain_lanes
from sim_core.cloth.step.leapfrog import Steps, Touch, advance, room_of
from sim_core.cloth.step.stability import LEAST_ROUNDS, MOST_ROUNDS, SETTLED, first_mode
from sim_core.validation import finite, one_of

PRECISIONS = ("double", "single")
COURANT = 0.7  # share of the stable step that is taken: the tangent may stiffen within a frame
MOST_COURANT = 0.95
SLOW = 2  # substeps between two looks at bending; 3 would resonate with the membrane (see DETAILS.md)
GUARDED_SLOW = 4  # likewise where a little stiffness damping keeps the resonance down
GUARD = (
    6.0  # times the damping at which impulses of bending should feed no mode of the membrane; 3 is too little
)

HASTY_ROUNDS = 4  # of the power iteration in single precision, which is for previews


@dataclass(frozen=True)
class Pace:
    """Precision of the time loop and the share of the stable step that is taken; beyond 0.7 bending is damped a little.

    Raises SimCoreError for another precision and for a share not within 0.01 to 0.95.
    """

    precision: str = "double"
    courant: float = COURANT

    def __post_init__(self) -> None:
        one_of("pace.precision", self.precision, PRECISIONS)
        finite("pace.courant: share of the stable step", self.courant, least=0.01, most=MOST_COURANT)

    @property
    def guarded(self) -> bool:
        """The step is so long that the membrane's fastest modes would resonate with impulses at every second one."""
        return self.courant > COURANT

    @property
    def slow(self) -> int:
        """Substeps between two looks at bending, where it is soft enough."""
        return GUARDED_SLOW if self.guarded else SLOW

    def guard(self, step: float, bend_omega2: float) -> float:
        """Stiffness damping [s] at which impulses of bending, of largest frequency² [1/s²], do not feed the membrane.

        An impulse every T feeds a mode whose half period fits into T at the rate bend² / 2 omega, damping takes
        beta omega² / 2. step [s]: the largest stable one, 2 / omega of the fastest mode, where the need is greatest
        as bend² goes with the fourth power of the wave number and omega³ with the third.
        """
        return GUARD * bend_omega2 * (0.5 * step) ** 3 if self.guarded else 0.0


def lanes_for(sheet: Sheet, bands: Bands, precision: str) -> Lanes | None:
    """The lanes of a sheet in band order; None in double precision where it is no lattice: its bands serve better."""
    if precision == "single":
        return lattice_lanes(sheet, bands, np.float32) or plain_lanes(bands, np.float32)
    return lattice_lanes(sheet, bands)


class Laned:
    """A sheet in band order ready to be moved over its lanes, in their precision."""

    def __init__(self, sheet: Sheet, lanes: Lanes, longest: int) -> None:
        count, real = len(sheet.mass), lanes.bands.own.dtype.type
        self.lanes, self.real = lanes, real
        self.room = room_of(lanes.edges, count, longest, real)
        self._state = State(np.zeros((3, count), real), np.zeros((3, count), real))
        self._ones = np.ones(count, real)
        self._start = 0.2 * first_mode(count)
        self._inverse: dict[int, tuple[np.ndarray, np.ndarray]] = {}

    def _cast(self, inverse: np.ndarray) -> np.ndarray:
        """inverse (V,) [1/kg] as the lanes' numbers, made once; the original is kept so that its id stays its own."""
        if id(inverse) not in self._inverse:
            self._inverse[id(inverse)] = inverse, inverse.astype(self.real)
        return self._inverse[id(inverse)][1]

    def advance(
        self,
        mesh: Mesh,
        touch: Touch,
        frame: Frame,
        steps: Steps,
        state: State,
        near: NearPairs,
    ) -> tuple[NearPairs, bool]:
        """`leapfrog.advance` of a state in float64; single counts free cloth from its middle."""
        x, v, inverse = state.x, state.v, mesh.inverse_mass
        there = len(touch.solid.kind) > 0 or len(touch.holds.low) > 0 or len(touch.holds.slaves) > 0
        absolute = there or self.real is np.float64
        middle = np.zeros((3, 1)) if absolute else x.mean(axis=1, keepdims=True)
        _counted_from(middle.T, near)
        own = self._state
        own.x[:] = x - middle
        own.v[:] = v
        mesh = mesh._replace(inverse_mass=self._cast(inverse))
        near, done = advance(self.lanes, mesh, touch, frame, steps, self.room, own, near)
        _counted_from(-middle.T, near)
        v[:] = own.v
        still = inverse == 0.0
        kept = x[:, still] + v[:, still] * (steps.dt * steps.count)
        x[:] = own.x + middle
        x[:, still] = kept  # what is pinned is exactly where it was, or was led to
        return near, done

    def frequency2(self, inverse: np.ndarray, x: np.ndarray, mode: np.ndarray, *, first: bool) -> float:
        """`stability.highest_frequency2` [1/s2]: x (3, V) float64; mode (3, V) float64 is renewed."""
        here, there = self._state.x, self.room.spare
        here[:] = x - x.mean(axis=1, keepdims=True)
        there[:] = mode if first else mode + self._start
        usual = LEAST_ROUNDS if self.real is np.float64 else HASTY_ROUNDS
        rounds = (MOST_ROUNDS if first else usual, MOST_ROUNDS, SETTLED)
        value = lane_mode(self.lanes, self._cast(inverse), self.room, here, there, *rounds)
        mode[:] = there
        return float(value)

    def stored(self, inverse: np.ndarray, state: State) -> float:
        """`diagnostics.stored_energy` [J]."""
        return float(stored_lanes(self.lanes, inverse, self._ones, self.room, state.x, state.v))

    def forget(self) -> None:
        """Clears what a frame that blew up has left."""
        for part in self.room:
            part[:] = 0


def _counted_from(place: np.ndarray, near: NearPairs) -> None:
    """Where lists were looked for, in place, as seen from there (1, 3) [m]."""
    if len(near.course.begun) and place.any():
        near.course.begun[:] -= place
        near.now.mark[:] -= place
