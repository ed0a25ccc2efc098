"""One frame of one sheet: bands, contact lists and working memory, made once and used by every frame."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from sim_core.cloth.contact.collisions import (
    Push,
    Watch,
    collide_samples,
    collide_vertices,
    contact_samples,
)
from sim_core.cloth.contact.constraints import Holds, bound, draw_together, keep_lengths, mirror
from sim_core.cloth.contact.layers.crossings import (
    changed_sides,
    faces_at_edges,
    no_crossings,
    none_crosses,
)
from sim_core.cloth.contact.layers.near_pairs import begin_pairs, near_pairs_of
from sim_core.cloth.contact.layers.pairs import Mesh, finder_of
from sim_core.cloth.contact.layers.parting import parted
from sim_core.cloth.contact.layers.patches import patches_of, shapes_of
from sim_core.cloth.contact.layers.repulsion import search_for
from sim_core.cloth.contact.layers.untangling import Memory, Untangling, untangle
from sim_core.cloth.contact.moving_grid import MovingGrid
from sim_core.cloth.contact.packed import Packed
from sim_core.cloth.contact.solids import Solid
from sim_core.cloth.sheet.sheet import Sheet
from sim_core.cloth.step.frame import FRAME, FREE, Contact, Frame, State
from sim_core.cloth.step.haste import passing_step
from sim_core.cloth.step.health import Health
from sim_core.cloth.step.implicit import Implicit
from sim_core.cloth.step.kernels.bands import bands_of, ordered
from sim_core.cloth.step.kernels.diagnostics import longest2, scattered, stored_energy
from sim_core.cloth.step.kernels.leaps import AIR_EVERY
from sim_core.cloth.step.leapfrog import Steps, Touch, advance, room_of
from sim_core.cloth.step.precision import COURANT, Laned, Pace, lanes_for
from sim_core.cloth.step.stability import bending_frequency2, highest_frequency2, stable_step
from sim_core.errors import SimCoreError

AIR_SHARE = 0.5  # of the time in which air stops a face, between two looks at it
IMPLICIT_STEPS = 8  # a frame by backward Euler
IMPLICIT_PASSES = 4  # over the contacts after each of them
MOST_PINNED = 16  # sets of pins whose masses are kept
UNTANGLE = 0.1  # of the shell's thickness: one step of taking the cloth out of itself
_NOTHING = Packed(np.zeros(0, np.int64), np.zeros((0, 20)), np.zeros((2, 2, 2), np.float32))


class Stride(NamedTuple):
    """How the engine goes through a frame: in `count` steps, `last` [s] being the step before it."""

    count: int
    last: float
    guard: float = 0.0  # least stiffness damping [s]
    usual: float = (
        0.0  # the step [s] that layers are as stiff as at, however short the steps are (0: the steps')
    )
    share: float = 1.0  # of a frame that this is
    breaks: bool = False  # off, as soon as layers are too fast for its steps: the frame is done again then


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
        self.contact = contact or Contact()
        self.shell = self.contact.shell()
        s = self.sheet
        self.mesh = Mesh(
            inverse_mass=s.stencil.inverse_mass,
            rest=s.rest,
            edges=s.edges,
            faces=s.faces,
            length2=s.stencil.length2,
            same=self.holds.same,
        )
        layers = (count, len(s.edges), len(s.faces)) if self.shell.thickness else (0, 0, 0)
        layered = len(s.faces) if self.shell.thickness else 0
        patches = patches_of(s.edges, s.faces[:layered], self.holds.same, s.corner[:layered])
        self.near = near_pairs_of(layers[0], layers[1], len(patches.bay))
        self.finder = finder_of(*layers)
        (vertices, middles), stirred = self._samples(), np.zeros(count, bool)
        self.touch = Touch(
            solid=self.packed,
            vertices=Watch(vertices, np.zeros(len(vertices), np.int32), stirred),
            middles=Watch(middles, np.zeros(len(middles), np.int32), stirred),
            shell=self.shell,
            patches=patches,
            shapes=shapes_of(patches),
            holds=self.holds,
        )
        self.third, self.crossed = faces_at_edges(s.edges, s.faces), no_crossings()
        longest = int(self.bands.face_runs[:, 1].max())
        self.room = room_of(len(s.edges), count, longest)
        lanes = None if self.limited else lanes_for(s, self.bands, self.pace.precision)
        self.laned = Laned(s, lanes, longest) if lanes else None
        free = self.sheet.stencil.inverse_mass
        self.lightest = _lightest(self.sheet)
        self.implicit = Implicit(self.sheet, self.bands, self.room)
        self.bend_omega2 = bending_frequency2(self.bands, free, self.room)
        touches = self.solids or self.shell.thickness > 0
        self.health = Health(self.sheet, self.stored, touches=touches)
        self._inverse: dict[bytes, np.ndarray] = {b"": free}

    def _samples(self) -> tuple[np.ndarray, np.ndarray]:
        """Vertices, and midpoints and centroids, that solids are looked for at: not those that mirror others."""
        count = len(self.order)
        vertices, middles = contact_samples(self.sheet.edges, self.sheet.faces, count)
        image = np.zeros(count, bool)
        image[self.holds.slaves[:, 0]] = True
        return vertices[~image[vertices[:, 0]]], middles[~image[middles].any(1)]

    def inverse_mass(self, pins: Sequence[int] | np.ndarray) -> np.ndarray:
        """1/m (V,) [1/kg] in band order, 0 at the pins."""
        index = np.asarray(pins, np.int64)
        key = index.tobytes()
        if key not in self._inverse:
            inverse = self.sheet.stencil.inverse_mass.copy()
            inverse[self.number[index]] = 0.0
            if len(self._inverse) >= MOST_PINNED:  # a live cloth may be held elsewhere in every frame
                self._inverse = {b"": self._inverse[b""]}
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

    def step(
        self, pins: Sequence[int] | np.ndarray, x: np.ndarray, mode: np.ndarray, *, first: bool
    ) -> float:
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

    def air_step(self, frame: Frame, v: np.ndarray) -> float:
        """Largest step [s] at which the lagging air still brakes and does not throw, at velocities v (3, V)."""
        if frame.press == 0.0:
            return np.inf
        blow = float(np.sqrt((frame.wind**2).sum(1).max()))
        speed = blow + float(np.sqrt((v * v).sum(0).max()))
        return AIR_SHARE * self.lightest / (12 * frame.press * max(speed, 1e-9)) / AIR_EVERY

    def slow(self, dt: float) -> int:
        """Substeps of dt [s] that bending may be left alone for: fewer, or 1, where it is what limits the step."""
        most = 2 * COURANT / (dt * np.sqrt(max(self.bend_omega2, 1e-12)))  # three faces cannot bend
        return next((n for n in (self.pace.slow, self.pace.slow // 2) if n <= most), 1)

    def _steps(self, frame: Frame, stride: Stride) -> Steps:
        dt = stride.share * FRAME / stride.count
        return Steps(
            count=stride.count,
            dt=dt,
            last=stride.last,
            beta=max(float(self.sheet.material.stiffness_damping), stride.guard),
            slow=self.slow(dt) if stride.count % self.pace.slow == 0 else 1,
            breaks=stride.breaks,
            whole=not (self.shell.thickness > 0.0 or frame.speed_limit < FREE),
        )

    def _among_solids(self, frame: Frame) -> tuple[Packed, Frame]:
        """The solid packed for a frame, and the frame in the loops' numbers of vertices and between a body's keys."""
        inside = frame._replace(pulled=self.number[frame.pulled])
        if self.moving is None:
            return self.packed, inside._replace(body=(0.0, 0.0))
        packed, body = self.moving.packed(*frame.body)
        return packed, inside._replace(body=body)

    def advance(self, frame: Frame, state: State, stride: Stride) -> bool:
        """Moves a state in place through a frame, or the share of one that the stride tells; False if it broke off."""
        steps, shell = self._steps(frame, stride), self.shell
        if stride.usual > 0.0:
            shell = shell._replace(spring=shell.spring * (steps.dt / stride.usual) ** 2)
        self._lead(frame, state, stride.share * FRAME)
        solid, inside = self._among_solids(frame)
        mesh = self.mesh._replace(inverse_mass=self.inverse_mass(frame.pins))
        touch = self.touch._replace(solid=solid, shell=shell)
        if self.laned:
            self.near, done = self.laned.advance(mesh, touch, inside, steps, state, self.near)
        else:
            self.near, done = advance(self.bands, mesh, touch, inside, steps, self.room, state, self.near)
        return done

    @property
    def took_back(self) -> bool:
        """Whether in the last frame anything was taken back that solids had pushed through a layer."""
        return bool(self.near.jerks.back[0])

    @property
    def pressed(self) -> bool:
        """Whether they pushed it there again, as often as it was taken back, or anything pressed layers to nothing."""
        return bool(self.near.jerks.back[1])

    def swapped(self, begin: State, end: State) -> int:
        """How many pairs of a vertex and a face that are near at a frame's end have changed sides in it."""
        near = self.near.now
        return changed_sides(begin.x.T, end.x.T, near.points[: near.count[1], :2], self.mesh.faces)

    @property
    def solids(self) -> bool:
        """Whether there is anything that is not cloth."""
        return self.moving is not None or len(self.packed.kind) > 0

    def passing_step(self, v: np.ndarray) -> float:
        """Largest step [s] in which no layers can pass each other until they are asked again, at speeds v (3, V)."""
        return float(passing_step(self.shell.thickness, v, self.solids)) / self.shell.every

    def _lead(self, frame: Frame, state: State, seconds: float = FRAME) -> None:
        """What is pinned rests, or has the speed that brings it where it is led within `seconds`."""
        state.v[:, self.inverse_mass(frame.pins) == 0.0] = 0.0
        index = self.number[frame.led]
        state.v[:, index] = (frame.places.T - state.x[:, index]) / seconds

    def advance_implicit(self, frame: Frame, state: State, count: int = IMPLICIT_STEPS) -> None:
        """Moves a state in place through a frame by `count` steps of backward Euler; layers do not feel each other."""
        with np.errstate(all="ignore"):  # what overflows is told by whoever checks the frame
            self._stepped(frame, state, count)

    def _stepped(self, frame: Frame, state: State, count: int) -> None:
        newtons = 1 if count >= IMPLICIT_STEPS // 2 else 3  # in each step: long ones need more
        h, inverse, (x, v) = FRAME / count, self.inverse_mass(frame.pins), state
        self._lead(frame, state)
        solid, inside = self._among_solids(frame)
        for step in range(count):
            wind = frame.wind_at((step + 0.5) / count)
            there = self.implicit.step(inside, wind, state, inverse, h, newtons)
            v[:], x[:] = (there - x) / h, there
            if frame.speed_limit < FREE:
                speed = np.sqrt((v * v).sum(0))
                v *= np.minimum(1.0, frame.speed_limit / np.maximum(speed, 1e-30))
            self._held(inside, solid, inverse, State(x.T, v.T), (step + 1) / count, h)

    def _held(
        self, frame: Frame, solid: Packed, inverse: np.ndarray, state: State, part: float, h: float
    ) -> None:
        """Lengths, seams, solids, bounds and images after an implicit step; state: (V, 3) each."""
        x, v = state
        if self.limited:
            ends, length2 = self.sheet.edges, self.sheet.stencil.length2
            strain = ((x[ends[:, 0]] - x[ends[:, 1]]) ** 2).sum(1) - length2
            keep_lengths(self.holds.limit, inverse, ends, length2, strain, x, v)
        if len(self.holds.pairs):
            early, late = frame.sewing
            draw_together(self.holds, inverse, x, v, early + (late - early) * part, (early - late) / FRAME)
        if len(solid.kind):
            if self.moving:
                early, late = frame.body
                solid.blend[:] = early + (late - early) * part, (late - early) / FRAME
            c, touch = self.contact, self.touch
            near = Push(float(c.sample_clearance), float(c.clearance), 0.0, h)
            push = Push(float(c.clearance), float(c.clearance), frame.friction, h)
            for _ in range(IMPLICIT_PASSES):
                collide_samples(solid, inverse, x, v, touch.middles.samples, near)
                collide_vertices(solid, inverse, x, v, touch.vertices.samples, push)
        bound(self.holds, x, v)
        mirror(self.holds, x, v)

    def parted(self, pins: np.ndarray, x: np.ndarray) -> np.ndarray:
        """x (V, 3) in the caller's order, with layers that lie exactly on each other a little apart."""
        thickness = self.shell.thickness
        if thickness == 0.0:
            return x
        mesh, there = (
            self.mesh._replace(inverse_mass=self.inverse_mass(pins)),
            np.ascontiguousarray(x[self.order]),
        )
        how, touch = search_for(mesh, thickness, 0.0, 0.0), self.touch
        self.near = begin_pairs(there, mesh, touch.patches, touch.shapes, how, self.near)
        self.near.kept[:] = 0.0
        found = parted(there, mesh, self.near.now, thickness)
        return x if found is there else found[self.number]

    def untangle(self, pins: np.ndarray, state: State) -> tuple[int, int]:
        """Takes a cloth out of itself in place; pairs of edge and face that crossed before, and after."""
        c = self.contact
        how = Untangling(UNTANGLE * c.thickness, c.untangle, c.partly)
        if not how.rounds or not how.step:
            return 0, 0
        if none_crosses(state.x.T, self.mesh, self.third, self.near, c.thickness):
            return 0, 0
        there, speed = (np.ascontiguousarray(array.T) for array in state)
        mesh = self.mesh._replace(inverse_mass=self.inverse_mass(pins))
        memory = Memory(
            self.finder, self.crossed, self.touch.patches, self.touch.shapes, self.near.spare.patches
        )
        before, after, self.crossed = untangle(there, speed, mesh, self.third, self.holds, memory, how)
        if before:
            state.x[:], state.v[:] = there.T, speed.T
            self.health.forget()
        return before, after

    def forget(self) -> None:
        """Clears the working memory of a frame that blew up: sums go on from what lies there, and so would NaN."""
        for part in self.room:
            part[:] = 0
        self.near.kept[:] = 0.0
        if self.laned:
            self.laned.forget()

    def stored(self, state: State) -> float:
        """Stored and kinetic energy [J]."""
        free = self.sheet.stencil.inverse_mass
        if self.laned:
            return self.laned.stored(free, state)
        return float(stored_energy(self.bands, free, self.room, state.x, state.v))

    def stretch(self, x: np.ndarray) -> float:
        """The longest an edge is at x (3, V), as a share of its rest length."""
        return float(np.sqrt(longest2(self.sheet.stencil.edges, self.sheet.stencil.length2, x)))


def _lightest(sheet: Sheet) -> float:
    """The least mass per area [kg/m2] of any vertex."""
    a, b = sheet.corner[:, 1] - sheet.corner[:, 0], sheet.corner[:, 2] - sheet.corner[:, 0]
    third = np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) / 6
    return float((sheet.mass / np.bincount(sheet.faces.ravel(), np.repeat(third, 3), len(sheet.mass))).min())
