"""One frame of one sheet: bands, contact lists and working memory, made once and used by every frame."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sim_core.cloth.contact.collisions import collide_samples, collide_vertices, contact_samples
from sim_core.cloth.contact.constraints import Holds, bound, draw_together, keep_lengths, mirror
from sim_core.cloth.contact.moving_grid import MovingGrid
from sim_core.cloth.contact.packed import Packed
from sim_core.cloth.contact.pairs import finder_of, pairs_of
from sim_core.cloth.contact.repulsion import Shell
from sim_core.cloth.contact.solids import Solid
from sim_core.cloth.contact.untangling import faces_at_edges, no_crossings, untangle
from sim_core.cloth.sheet.sheet import Sheet
from sim_core.cloth.step.air import Air
from sim_core.cloth.step.conditions import Conditions
from sim_core.cloth.step.health import Health
from sim_core.cloth.step.implicit import Implicit, Load
from sim_core.cloth.step.kernels.bands import bands_of, ordered
from sim_core.cloth.step.kernels.diagnostics import longest2, scattered, stored_energy
from sim_core.cloth.step.leapfrog import AIR_EVERY, FREE, Surroundings, advance, room_of
from sim_core.cloth.step.phases import FRAME, Contact
from sim_core.cloth.step.precision import COURANT, Laned, Pace, lanes_for
from sim_core.cloth.step.stability import bending_frequency2, highest_frequency2, stable_step
from sim_core.errors import SimCoreError
from sim_core.validation import within

AIR_SHARE = 0.5  # of the time in which air stops a face, between two looks at it
IMPLICIT_STEPS = 8  # a frame by backward Euler
IMPLICIT_PASSES = 4  # over the contacts after each of them
MOST_PINNED = 16  # sets of pins whose masses are kept
UNTANGLE = 0.1  # of the shell's thickness: one step of taking the cloth out of itself
_NOTHING = Packed(np.zeros(0, np.int64), np.zeros((0, 20)), np.zeros((2, 2, 2), np.float32))


class Engine:
    """A sheet with what it may touch, ready to be moved frame by frame; arrays in the caller's vertex order."""

    def __init__(
        self,
        sheet: Sheet,
        *,
        collider: Solid | MovingGrid | None = None,
        contact: Contact | None = None,
        holds: Holds | None = None,
        pace: Pace | None = None,
    ) -> None:
        self.pace = pace or Pace()
        self.sheet, self.order = ordered(sheet)
        count = len(self.order)
        self.number = np.zeros(count, np.int64)
        self.number[self.order] = np.arange(count)
        self.bands = bands_of(self.sheet)
        self.moving = collider if isinstance(collider, MovingGrid) else None
        self.packed = collider.packed() if isinstance(collider, Solid) else _NOTHING
        self.holds = (holds or Holds.of(count)).renumbered(self.number, self.order)
        self.limited = min(self.holds.limit) < 1.0
        if self.limited and self.pace.precision == "single":
            raise SimCoreError("holds.limit: lengths are kept in double precision only – take Pace()")
        self.contact = c = contact or Contact()
        self.shell = Shell(
            float(c.thickness),
            float(c.skin),
            float(c.spring),
            float(c.self_friction),
            int(c.every),
            float(c.separation),
        )
        vertices, middles = contact_samples(self.sheet.edges, self.sheet.faces, count)
        image = np.zeros(count, bool)
        image[self.holds.slaves[:, 0]] = True
        self.vertices = vertices[~image[vertices[:, 0]]]
        self.middles = middles[~image[middles].any(1)]
        self.third, self.crossed = faces_at_edges(self.sheet.edges, self.sheet.faces), no_crossings()
        longest = int(self.bands.face_runs[:, 1].max())
        samples = (len(self.vertices), len(self.middles))
        self.room = room_of(len(self.sheet.edges), count, longest, samples)
        layers = (count, len(self.sheet.edges), len(self.sheet.faces)) if self.shell.thickness else (0, 0, 0)
        self.finder, self.pairs = finder_of(*layers), (pairs_of(layers[0]), pairs_of(layers[0]))
        lanes = None if self.limited else lanes_for(self.sheet, self.bands, self.pace.precision)
        self.laned = Laned(self.sheet, lanes, longest, samples) if lanes else None
        free = self.sheet.stencil.inverse_mass
        self.lightest = _lightest(self.sheet)
        self.implicit = Implicit(self.sheet, self.bands, self.room)
        self.bend_omega2 = bending_frequency2(self.bands, free, self.room)
        touches = len(self.packed.kind) > 0 or self.moving is not None or self.shell.thickness > 0
        self.health = Health(self.sheet, self.stored, touches=touches)
        self._inverse: dict[tuple[int, ...], np.ndarray] = {(): free}

    def inverse_mass(self, pins: Sequence[int]) -> np.ndarray:
        """1/m (V,) [1/kg] in band order, 0 at the pins; raises SimCoreError for a pin that is no vertex."""
        key = tuple(pins)
        if key not in self._inverse:
            index = np.asarray(key, np.int64)
            within("pins", index, len(self.order))
            inverse = self.sheet.stencil.inverse_mass.copy()
            inverse[self.number[index]] = 0.0
            if len(self._inverse) >= MOST_PINNED:  # a live cloth may be held elsewhere in every frame
                self._inverse = {(): self._inverse[()]}
            self._inverse[key] = inverse
        return self._inverse[key]

    def inward(self, array: np.ndarray) -> np.ndarray:
        """(V, 3) in the caller's order as (3, V) in band order."""
        return np.ascontiguousarray(array[self.order].T)

    def outward(self, array: np.ndarray) -> np.ndarray:
        """(3, V) in band order as (V, 3) in the caller's order."""
        out = np.zeros((len(self.number), 3))
        scattered(array, self.number, out)
        return out

    def step(self, pins: Sequence[int], x: np.ndarray, mode: np.ndarray, *, first: bool) -> float:
        """Largest stable step [s] at x (3, V); mode (3, V) is kept from frame to frame. Raises if there is none."""
        inverse = self.inverse_mass(pins)
        if not inverse.any():
            return FRAME
        if self.laned:
            omega2 = self.laned.frequency2(inverse, x, mode, first=first)
        else:
            omega2 = highest_frequency2(self.bands, inverse, self.room, x, mode, first=first)
        step = stable_step(omega2, self.sheet.material.stiffness_damping)
        if not np.isfinite(step) or step <= 0:
            raise SimCoreError("positions: no stable step – edges of zero length or a non-finite state")
        return step

    def air_step(self, under: Conditions, v: np.ndarray) -> float:
        """Largest step [s] at which the lagging air still brakes and does not throw, at velocities v (3, V)."""
        if under.press == 0.0:
            return np.inf
        blow = 0.0 if under.wind is None else float(np.sqrt((under.wind**2).sum(1).max()))
        speed = blow + float(np.sqrt((v * v).sum(0).max()))
        return AIR_SHARE * self.lightest / (12 * under.press * max(speed, 1e-9)) / AIR_EVERY

    def slow(self, dt: float) -> int:
        """Substeps of dt [s] that bending may be left alone for: fewer, or 1, where it is what limits the step."""
        most = 2 * COURANT / (dt * np.sqrt(max(self.bend_omega2, 1e-12)))  # three faces cannot bend
        return next((n for n in (self.pace.slow, self.pace.slow // 2) if n <= most), 1)

    def advance(
        self,
        under: Conditions,
        pins: Sequence[int],
        x: np.ndarray,
        v: np.ndarray,
        last: float,
        count: int,
        guard: float = 0.0,
        share: float = 1.0,
        usual: float = 0.0,
    ) -> None:
        """Moves x, v (3, V) in place through one frame of `count` substeps; `last` [s] is the step before it.

        guard: least stiffness damping [s]; share: of a frame that `under` lasts for; usual: the step [s] that layers
        are as stiff as at, however short the steps are (0: at the steps').
        """
        material, c, dt = self.sheet.material, self.contact, share * FRAME / count
        shell = self.shell
        if usual > 0.0:
            shell = shell._replace(spring=shell.spring * (dt / usual) ** 2)
        self._lead(under, pins, x, v, share * FRAME)
        packed, body = self.moving.packed(*under.body) if self.moving else (self.packed, (0.0, 0.0))
        around = Surroundings(
            np.asarray(under.gravity, float),
            float(under.damping),
            max(float(material.stiffness_damping), guard),
            float(under.friction),
            float(c.clearance),
            float(c.sample_clearance),
            float(c.cap),
            float(under.speed_limit),
            (float(under.sewing[0]), float(under.sewing[1])),
            (float(body[0]), float(body[1])),
            np.zeros((2, 3)) if under.wind is None else np.ascontiguousarray(under.wind, float),
            float(under.press),
            self.number[under.pulls[0]],
            np.ascontiguousarray(under.pulls[1], float),
            self.slow(dt) if count % self.pace.slow == 0 else 1,
        )
        if self.laned:
            touching = ((self.vertices, self.middles), self.holds, shell)
            searched = (self.finder, self.pairs[0], self.pairs[1])
            inverse = self.inverse_mass(pins)
            self.pairs = self.laned.advance(
                inverse, packed, *touching, around, *searched, x, v, last, dt, count
            )
            return
        s = self.sheet
        fixed = (self.bands, self.inverse_mass(pins), s.edges, s.faces, s.rest, packed)
        touch = (self.vertices, self.middles, self.holds, shell, around, self.room, self.finder)
        self.pairs = advance(*fixed, *touch, *self.pairs, x, v, last, dt, count)

    def _lead(
        self, under: Conditions, pins: Sequence[int], x: np.ndarray, v: np.ndarray, seconds: float = FRAME
    ) -> None:
        """What is pinned rests, or has the speed that brings it where it is led within `seconds`."""
        v[:, self.inverse_mass(pins) == 0.0] = 0.0
        index, there = self.number[under.led[0]], under.led[1]
        v[:, index] = (there.T - x[:, index]) / seconds

    def advance_implicit(
        self,
        under: Conditions,
        pins: Sequence[int],
        x: np.ndarray,
        v: np.ndarray,
        count: int = IMPLICIT_STEPS,
        newtons: int | None = None,
    ) -> None:
        """Moves x, v (3, V) through one frame by `count` steps of backward Euler; layers do not feel each other.

        newtons: Newton steps in each (None: one where the steps are short, three where they are long).
        """
        with np.errstate(all="ignore"):  # what overflows is told by whoever checks the frame
            self._stepped(under, pins, x, v, count, newtons)

    def _stepped(
        self,
        under: Conditions,
        pins: Sequence[int],
        x: np.ndarray,
        v: np.ndarray,
        count: int,
        newtons: int | None,
    ) -> None:
        newtons = newtons or (1 if count >= IMPLICIT_STEPS // 2 else 3)
        material, h, inverse = self.sheet.material, FRAME / count, self.inverse_mass(pins)
        self._lead(under, pins, x, v)
        wind = np.zeros((2, 3)) if under.wind is None else under.wind
        pulled, pull = self.number[under.pulls[0]], under.pulls[1]
        for step in range(count):
            now = wind[0] + (step + 0.5) / count * (wind[1] - wind[0])
            load = Load(
                np.asarray(under.gravity, float),
                float(under.damping),
                float(material.stiffness_damping),
                now,
                float(under.press),
                pulled,
                pull,
            )
            there = self.implicit.step(x, v, inverse, h, load, newtons)
            v[:], x[:] = (there - x) / h, there
            if under.speed_limit < FREE:
                speed = np.sqrt((v * v).sum(0))
                v *= np.minimum(1.0, under.speed_limit / np.maximum(speed, 1e-30))
            self._held(under, inverse, x.T, v.T, (step + 1) / count, h)

    def _held(
        self, under: Conditions, inverse: np.ndarray, x: np.ndarray, v: np.ndarray, part: float, h: float
    ) -> None:
        """Lengths, seams, solids, bounds and images after an implicit step."""
        if self.limited:
            ends, length2 = self.sheet.edges, self.sheet.stencil.length2
            strain = ((x[ends[:, 0]] - x[ends[:, 1]]) ** 2).sum(1) - length2
            keep_lengths(self.holds.limit, inverse, ends, length2, strain, x, v)
        if len(self.holds.pairs):
            early, late = under.sewing
            draw_together(self.holds, inverse, x, v, early + (late - early) * part, (early - late) / FRAME)
        packed, body = self.moving.packed(*under.body) if self.moving else (self.packed, (0.0, 0.0))
        if len(packed.kind):
            if self.moving:
                packed.blend[:] = body[0] + (body[1] - body[0]) * part, (body[1] - body[0]) / FRAME
            c, cap = self.contact, self.contact.clearance
            for _ in range(IMPLICIT_PASSES):
                collide_samples(packed, inverse, x, v, self.middles, c.sample_clearance, cap)
                collide_vertices(packed, inverse, x, v, self.vertices, c.clearance, h, under.friction, cap)
        bound(self.holds, x, v)
        mirror(self.holds, x, v)

    def untangle(self, pins: Sequence[int], x: np.ndarray, v: np.ndarray) -> tuple[int, int]:
        """Takes the cloth x, v (3, V) out of itself in place; pairs of edge and face that crossed before, and after."""
        rounds, step = self.contact.untangle, UNTANGLE * self.contact.thickness
        if not rounds or not step:
            return 0, 0
        there, speed = np.ascontiguousarray(x.T), np.ascontiguousarray(v.T)
        s, inverse = self.sheet, self.inverse_mass(pins)
        sheet = (s.edges, s.faces, self.third, self.holds, self.finder, self.crossed)
        way = {"step": step, "rounds": rounds, "partly": self.contact.partly}
        before, after, self.crossed = untangle(there, speed, inverse, *sheet, **way)
        if before:
            x[:], v[:] = there.T, speed.T
            self.health.forget()
        return before, after

    def forget(self) -> None:
        """Clears the working memory of a frame that blew up: sums go on from what lies there, and so would NaN."""
        for part in self.room:
            part[:] = 0
        if self.laned:
            self.laned.forget()

    def stored(self, x: np.ndarray, v: np.ndarray) -> float:
        """Stored and kinetic energy [J] of x, v (3, V)."""
        free = self.sheet.stencil.inverse_mass
        if self.laned:
            return self.laned.stored(free, x, v)
        return float(stored_energy(self.bands, free, self.room, x, v))

    def stretch(self, x: np.ndarray) -> float:
        """The longest an edge is at x (3, V), as a share of its rest length."""
        return float(np.sqrt(longest2(self.sheet.stencil.edges, self.sheet.stencil.length2, x)))

    def air(self, air: Air | None, seconds: float) -> tuple[np.ndarray | None, float]:
        """Wind (2, 3) [m/s] at the begin and end of the frame that starts at `seconds`, and its press."""
        if air is None:
            return None, 0.0
        return np.stack([air.at(seconds), air.at(seconds + FRAME)]), air.press


def _lightest(sheet: Sheet) -> float:
    """The least mass per area [kg/m2] of any vertex."""
    a, b = sheet.corner[:, 1] - sheet.corner[:, 0], sheet.corner[:, 2] - sheet.corner[:, 0]
    third = np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) / 6
    return float((sheet.mass / np.bincount(sheet.faces.ravel(), np.repeat(third, 3), len(sheet.mass))).min())
