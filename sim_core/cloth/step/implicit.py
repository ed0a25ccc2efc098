"""Backward Euler by Newton steps with conjugate gradients, for previews, bad starts and very stiff cloth.

A step of h minimises |x - x_n - h v|^2_M / (2 h^2) + damping + stored energy. The tangent drops compressive tensions
and is then never indefinite; the preconditioner is one scalar matrix for x, y and z, constant while h is, factored
once. Newton's direction is followed as far as the energy falls (Armijo).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse

from sim_core.cloth.sheet.sheet import Sheet
from sim_core.cloth.step.factor import Factored
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


@dataclass(frozen=True)
class Load:
    """What one step is under: acceleration (3,) [m/s2], mass damping [1/s], stiffness damping [s], wind, pulls."""

    acceleration: np.ndarray
    damping: float
    beta: float
    wind: np.ndarray
    press: float
    pulled: np.ndarray
    pull: np.ndarray


class Implicit:
    """Backward Euler for one sheet in band order; factors are kept for as long as step and pins stay."""

    def __init__(self, sheet: Sheet, bands: Bands, room: Room) -> None:
        self.sheet, self.bands, self.room = sheet, bands, room
        self._factors: dict[tuple[float, bytes], tuple[Factored, np.ndarray]] = {}
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

    def factor(self, h: float, load: Load, inverse: np.ndarray) -> tuple[Factored, np.ndarray]:
        """The factored preconditioner of a step of h [s] and the indices of the free vertices."""
        key = (h * 1e6 + load.damping + 1e3 * load.beta, (inverse > 0).tobytes())
        if key not in self._factors:
            if len(self._factors) > 3:
                self._factors.pop(next(iter(self._factors)))
            free = np.flatnonzero(inverse > 0)
            membrane, bend = self._matrix
            inertia = self.sheet.mass / h**2 * (1 + load.damping * h)
            matrix = sparse.diags_array(inertia).tocsc() + (1 + load.beta / h) * membrane + bend
            part = matrix[free][:, free].tocsc()
            self._factors[key] = (Factored(part), free)
        return self._factors[key]

    def step(
        self, x: np.ndarray, v: np.ndarray, inverse: np.ndarray, h: float, load: Load, newtons: int
    ) -> np.ndarray:
        """Positions (3, V) a step of h [s] after x with velocities v; what is pinned moves with its velocity."""
        free = inverse > 0
        before = self._strains(x)
        air = self._air(x, v, load)
        target = x + h * v
        force = self.sheet.mass * load.acceleration[:, None] + air
        now = np.where(free, target + h * h * inverse * force, target)
        if not self._energy(now, x, target, before, force, h, load) < np.inf:
            now = target.copy()
        solver = self.factor(h, load, inverse)
        for _ in range(newtons):
            gradient = self._gradient(now, x, target, before, force, h, load) * free
            size = float(np.sqrt((gradient**2 * inverse).sum()))
            if not size > 1e-9:
                break
            direction = self._solve(now, gradient, h, load, solver, free)
            now, moved = self._search(now, direction, gradient, (x, target, before, force, h, load))
            if not moved:
                break
        return now

    def _strains(self, x: np.ndarray) -> np.ndarray:
        b = self.bands
        out = np.zeros_like(self.room.strain)
        band_strains(b.edge_runs, b.length2, x[0], x[1], x[2], out)
        return out

    def _tensions(self, strain: np.ndarray) -> np.ndarray:
        b, c = self.bands, self.bands.coupling
        band_tensions(b.tension_runs, b.own, c[0], c[1], c[2], c[3], strain, self.room.tension)
        return self.room.tension

    def _air(self, x: np.ndarray, v: np.ndarray, load: Load) -> np.ndarray:
        """Force of air and pulls (3, V) [N] at the begin of the step."""
        out = np.zeros_like(x)
        if load.press > 0:
            band_air(self.bands.face_runs, *x, *v, 0.0, *load.wind, load.press, *out, *self.room.face)
        np.add.at(out.T, load.pulled, load.pull)
        return out

    def _energy(self, now, x, target, before, force, h: float, load: Load) -> float:
        """What the step minimises [J]; the constants of the height are left out."""
        mass, q = self.sheet.mass, np.zeros_like(now)
        strain = self._strains(now)
        tension = self._tensions(strain)[: len(strain)]
        total = 0.25 * float((tension * strain).sum())
        if load.beta > 0:
            change = strain - before
            total += 0.25 * load.beta / h * float((self._tensions(change)[: len(strain)] * change).sum())
        band_bends(self.bands.bend_runs, self.bands.bend, 1.0, *now, *q)
        total -= 0.5 * float((now * q).sum())
        total += float((mass * (now - target) ** 2).sum()) / (2 * h * h)
        total += load.damping * float((mass * (now - x) ** 2).sum()) / (2 * h)
        return total - float((force * now).sum())

    def _gradient(self, now, x, target, before, force, h: float, load: Load) -> np.ndarray:
        """Its gradient (3, V); leaves the tensions of the clamped tangent in the room."""
        b, f, mass = self.bands, self.room.force, self.sheet.mass
        strain = self._strains(now)
        tension = self._tensions(strain + load.beta / h * (strain - before))
        band_pulls(b.vertex_runs, tension, *now, *f)
        band_bends(b.bend_runs, b.bend, 1.0, *now, *f)
        np.maximum(tension, 0.0, out=tension)
        inertia = mass * ((now - target) / h**2 + load.damping / h * (now - x))
        return inertia - f - force

    def _solve(self, now, gradient, h: float, load: Load, solver, free: np.ndarray) -> np.ndarray:
        """Newton's direction by preconditioned conjugate gradients."""
        factor, index = solver
        inertia = self.sheet.mass / h**2 * (1 + load.damping * h)
        stiffer = 1 + load.beta / h

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

    def _search(self, now, way, gradient, around) -> tuple[np.ndarray, bool]:
        """Along `way` as far as the energy falls by a share of what its slope promises."""
        energy, slope, length = self._energy(now, *around), float((gradient * way).sum()), 1.0
        for _ in range(20):
            there = now + length * way
            if self._energy(there, *around) <= energy + 1e-4 * length * slope + 1e-15 * abs(energy):
                return there, True
            length *= 0.5
        return now, False
