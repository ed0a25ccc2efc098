"""Backward Euler by Newton steps with conjugate gradients, for previews, bad starts and very stiff cloth.

A step of h minimises |x - x_n - h v|^2_M / (2 h^2) + damping + stored energy. The tangent drops compressive tensions
and is then never indefinite; the preconditioner is one scalar matrix for x, y and z, constant while h is, factored
once. Newton's direction is followed as far as the energy falls (Armijo).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy import sparse

from sim_core.cloth.sheet.sheet import Sheet
from sim_core.cloth.step.factor import Factored
from sim_core.cloth.step.frame import Frame, State
from sim_core.cloth.step.kernels.banded import (
    band_air,
    band_bends,
    band_pulls,
    band_strains,
    band_tensions,
)
from sim_core.cloth.step.kernels.bands import Bands
from sim_core.cloth.step.leapfrog import Room
from sim_core.cloth.step.stability import stiffness_times

TOLERANCE = 1e-2  # of the gradient: of one Newton step's linear solve
MOST_ROUNDS = 60  # of conjugate gradients in one Newton step


class Problem(NamedTuple):
    """What one step minimises over the positions it leads to."""

    h: float  # [s]
    damping: float  # of mass [1/s]
    x: np.ndarray  # (3, V) [m] where it begins
    strain: np.ndarray  # (E,) [m2] there
    target: np.ndarray  # (3, V) [m] where it would lead without forces
    force: np.ndarray  # (3, V) [N] of weight, air and pulls


class Implicit:
    """Backward Euler for one sheet in band order; factors are kept for as long as step and pins stay."""

    def __init__(self, sheet: Sheet, bands: Bands, room: Room) -> None:
        self.sheet, self.bands, self.room = sheet, bands, room
        self.beta = float(sheet.material.stiffness_damping)
        self._factors: dict[tuple[float, float, bytes], tuple[Factored, np.ndarray]] = {}
        self._matrix = self._stiffness()

    def _stiffness(self) -> tuple[sparse.csc_array, sparse.csc_array]:
        """Scalar membrane (every edge as a spring of its axial stiffness) and bending, both (V, V) [N/m]."""
        s, count = self.sheet.stencil, len(self.sheet.mass)
        spring = 4.0 * s.own * s.length2
        i, j = s.edges[:, 0], s.edges[:, 1]
        row, column = np.r_[i, j, i, j], np.r_[j, i, i, j]
        membrane = sparse.coo_array((np.r_[-spring, -spring, spring, spring], (row, column)), (count, count))
        own = np.repeat(np.arange(count), np.diff(s.rows))
        bend = sparse.coo_array(
            (np.r_[s.bend, -s.bend], (np.r_[own, own], np.r_[s.neighbour, own])), (count, count)
        )
        return membrane.tocsc(), bend.tocsc()

    def factor(self, h: float, damping: float, inverse: np.ndarray) -> tuple[Factored, np.ndarray]:
        """The factored preconditioner of a step of h [s] with mass damping [1/s], and the free vertices' indices."""
        key = (h, damping, (inverse > 0).tobytes())
        if key not in self._factors:
            if len(self._factors) > 3:
                self._factors.pop(next(iter(self._factors)))
            free = np.flatnonzero(inverse > 0)
            membrane, bend = self._matrix
            inertia = self.sheet.mass / h**2 * (1 + damping * h)
            matrix = sparse.diags_array(inertia).tocsc() + (1 + self.beta / h) * membrane + bend
            part = matrix[free][:, free].tocsc()
            self._factors[key] = (Factored(part), free)
        return self._factors[key]

    def problem(self, frame: Frame, wind: np.ndarray, state: State, h: float) -> Problem:
        """A step of h [s] from a state; the frame's pulled vertices in band order, wind (3,) [m/s]."""
        weight = self.sheet.mass * frame.gravity[:, None]
        return Problem(
            h=h,
            damping=frame.damping,
            x=state.x,
            strain=self._strains(state.x),
            target=state.x + h * state.v,
            force=weight + self._air(frame, wind, state),
        )

    def step(
        self, frame: Frame, wind: np.ndarray, state: State, inverse: np.ndarray, h: float, newtons: int
    ) -> np.ndarray:
        """Positions (3, V) a step of h [s] after a state; what is pinned moves with its velocity."""
        free, problem = inverse > 0, self.problem(frame, wind, state, h)
        now = np.where(free, problem.target + h * h * inverse * problem.force, problem.target)
        if not self.energy(problem, now) < np.inf:
            now = problem.target.copy()
        solver = self.factor(h, frame.damping, inverse)
        for _ in range(newtons):
            gradient = self.gradient(problem, now) * free
            size = float(np.sqrt((gradient**2 * inverse).sum()))
            if not size > 1e-9:
                break
            direction = self._solve(problem, now, gradient, solver, free)
            now, moved = self._search(problem, now, direction, gradient)
            if not moved:
                break
        return now

    def _strains(self, x: np.ndarray) -> np.ndarray:
        b = self.bands
        out = np.zeros_like(self.room.strain)
        band_strains(b.edge_runs, b.length2, tuple(x), out)
        return out

    def _tensions(self, strain: np.ndarray) -> np.ndarray:
        b = self.bands
        band_tensions(b.tension_runs, b.own, b.coupling, strain, self.room.tension)
        return self.room.tension

    def _air(self, frame: Frame, wind: np.ndarray, state: State) -> np.ndarray:
        """Force of air and pulls (3, V) [N] at the begin of the step."""
        out = np.zeros_like(state.x)
        if frame.press > 0:
            at, speed, blow = tuple(state.x), tuple(state.v), (wind[0], wind[1], wind[2])
            faces, press = self.bands.face_runs, frame.press
            band_air(faces, at, speed, 0.0, blow, press, tuple(out), tuple(self.room.face))
        np.add.at(out.T, frame.pulled, frame.pulls)
        return out

    def energy(self, problem: Problem, now: np.ndarray) -> float:
        """What the step minimises [J] at now (3, V); the constants of the height are left out."""
        mass, q, h = self.sheet.mass, np.zeros_like(now), problem.h
        strain = self._strains(now)
        tension = self._tensions(strain)[: len(strain)]
        total = 0.25 * float((tension * strain).sum())
        if self.beta > 0:
            change = strain - problem.strain
            total += 0.25 * self.beta / h * float((self._tensions(change)[: len(strain)] * change).sum())
        band_bends(self.bands.bend_runs, self.bands.bend, 1.0, tuple(now), tuple(q))
        total -= 0.5 * float((now * q).sum())
        total += float((mass * (now - problem.target) ** 2).sum()) / (2 * h * h)
        total += problem.damping * float((mass * (now - problem.x) ** 2).sum()) / (2 * h)
        return total - float((problem.force * now).sum())

    def gradient(self, problem: Problem, now: np.ndarray) -> np.ndarray:
        """Its gradient (3, V); leaves the tensions of the clamped tangent in the room."""
        b, f, mass, h = self.bands, self.room.force, self.sheet.mass, problem.h
        strain = self._strains(now)
        tension = self._tensions(strain + self.beta / h * (strain - problem.strain))
        band_pulls(b.vertex_runs, tension, tuple(now), tuple(f))
        band_bends(b.bend_runs, b.bend, 1.0, tuple(now), tuple(f))
        np.maximum(tension, 0.0, out=tension)
        inertia = mass * ((now - problem.target) / h**2 + problem.damping / h * (now - problem.x))
        return inertia - f - problem.force

    def _solve(
        self,
        problem: Problem,
        now: np.ndarray,
        gradient: np.ndarray,
        solver: tuple[Factored, np.ndarray],
        free: np.ndarray,
    ) -> np.ndarray:
        """Newton's direction by preconditioned conjugate gradients."""
        factor, index = solver
        inertia = self.sheet.mass / problem.h**2 * (1 + problem.damping * problem.h)
        stiffer = 1 + self.beta / problem.h

        def conditioned(r: np.ndarray) -> np.ndarray:
            out = np.zeros_like(r)
            out[:, index] = factor.solve(np.ascontiguousarray(r[:, index].T)).T
            return out

        p_out, way, rest = np.zeros_like(now), np.zeros_like(now), -gradient
        z = conditioned(rest)
        p, rz = z.copy(), float((rest * z).sum())
        first = rz
        for _ in range(MOST_ROUNDS):
            if not rz > TOLERANCE**2 * first:
                break
            stiffness_times(self.bands, self.room, now, p, p_out, stiffer)
            product = (inertia * p - p_out) * free
            bend = float((p * product).sum())
            if not bend > 0:
                break
            length = rz / bend
            way += length * p
            rest -= length * product
            z = conditioned(rest)
            rz, old = float((rest * z).sum()), rz
            p = z + rz / old * p
        return way

    def _search(
        self, problem: Problem, now: np.ndarray, way: np.ndarray, gradient: np.ndarray
    ) -> tuple[np.ndarray, bool]:
        """Along `way` as far as the energy falls by a share of what its slope promises."""
        energy, slope, length = self.energy(problem, now), float((gradient * way).sum()), 1.0
        for _ in range(20):
            there = now + length * way
            if self.energy(problem, there) <= energy + 1e-4 * length * slope + 1e-15 * abs(energy):
                return there, True
            length *= 0.5
        return now, False
