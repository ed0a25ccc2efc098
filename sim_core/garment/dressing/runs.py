"""The runs of the cloth engine that a layer goes through on one mesh: sheets, holds, ties and belts in its numbers."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from sim_core.cloth import Contact, Drape, Holds, drape
from sim_core.errors import SimCoreError
from sim_core.garment.dressing.course import Course
from sim_core.garment.dressing.materials import Materials, materials_of
from sim_core.garment.dressing.places import Places, belt_pairs, girth_there
from sim_core.garment.dressing.sewn_sheet import SewnSheet, sewn_sheet
from sim_core.garment.dressing.wearing import Wearing
from sim_core.garment.outfit import Belt, Layer
from sim_core.garment.placement import Flat

__all__ = ["Ran", "Runs", "Spread"]

GAP = 0.004  # [m] from the middle, which the fronts of one half do not pass: there is nothing beyond to touch

Spread = Callable[
    [np.ndarray], np.ndarray
]  # positions (V, 3) of a run to those (P, 3) of the pattern vertices


@dataclass(frozen=True)
class Ran:
    """What runs came to: the last one's sheet, what each came to, the gap [m] of the seams before they were welded."""

    sheet: SewnSheet
    drapes: tuple[Drape, ...]
    gap: float | None

    def worn(self) -> tuple[np.ndarray, np.ndarray]:
        """Positions and velocities (P, 3) of the pattern vertices."""
        last, number = self.drapes[-1], self.sheet.number
        return last.positions[number], last.velocities[number]


class Runs:
    """number: of the layer; courses: those it goes through on this mesh; half: as one half against its image."""

    def __init__(
        self, layer: Layer, number: int, courses: tuple[Course, ...], wearing: Wearing, *, half: bool
    ) -> None:
        self.layer, self.number, self.courses = layer, number, courses
        self.wearing, self.half = wearing, half
        self.cut = layer.cut
        self.cloth = self.cut if half else layer.cloth
        self.belts: dict[Belt, tuple[np.ndarray, np.ndarray]] = {}

    def materials(self) -> Materials:
        """What the layer is made of, as far as its mesh resolves it."""
        return materials_of(self.layer, self.cloth, self.layer.place.hanging(self.cloth))

    def through(
        self,
        materials: Materials,
        start: tuple[np.ndarray, np.ndarray],
        hooks: Callable[[int, Spread], dict[str, Any]],
    ) -> Ran:
        """All of them from positions and velocities (P, 3) of the pattern vertices; hooks: of `drape`, for each run."""
        self._check_belts()
        panels = self.layer.pattern.panels
        apart = np.array([k if panel.along else 0 for k, panel in enumerate(panels)] or [0])
        kind, apart = materials.of_faces(self.cloth), apart[self.cloth.panel % len(apart)]
        solid, gap = self.wearing.solid(half=self.half), None
        (x, v), even = start, self.layer.program.even
        sheet, done = None, list[Drape]()
        for number, course in enumerate(self.courses):
            if sheet is None or course.closed != self.courses[number - 1].closed:
                weld = self.cloth.closed if course.closed else self.cloth.joined
                if sheet is not None:
                    x, v = x[sheet.number], v[sheet.number]
                    gap = self._gap(x)
                sheet = sewn_sheet(
                    self.cloth, weld, materials.kinds, kind, apart, even=even, creases=self.cloth.creases
                )
                x, v = sheet.gathered(x), sheet.gathered(v)
                v[sheet.middle, 0] = 0.0
            self._lay_belts(course, sheet, x)
            places = self.places(sheet)
            worn = self.wearing.outfit.wearer is not None
            phases = [timed.phase(places.vertices, moving=worn) for timed in course.steps]
            done.append(
                drape(
                    sheet.sheet,
                    x,
                    phases,
                    velocities=v,
                    collider=solid,
                    contact=self.contact(course),
                    holds=self.holds(sheet, course, x),
                    **hooks(number, lambda x, sheet=sheet: x[sheet.number]),
                )
            )
            x, v = done[-1].positions, done[-1].velocities
        assert sheet is not None
        return Ran(sheet, tuple(done), gap)

    def places(self, sheet: SewnSheet) -> Places:
        """Which vertices of a sheet are meant."""
        belted = {int(k) for pairs, _ in self.belts.values() for k in pairs.ravel()}
        return Places(self.layer, self.cut, self.cloth, sheet, tuple(sorted(belted)))

    def contact(self, course: Course) -> Contact:
        """How it touches; over a round bar further off, so that the chords of the mesh keep clear of it, too."""
        stand = self.wearing.outfit.stand
        if stand is None:
            return course.contact
        # Centroids lie lower than midpoints: L^2 / 6R against L^2 / 8R, and a chord across the bar by R at most.
        sagitta = min(self.layer.edge**2 / (6 * stand.bar_radius), stand.bar_radius)
        return replace(course.contact, clearance=course.contact.clearance + sagitta)

    def holds(self, sheet: SewnSheet, course: Course, x: np.ndarray) -> Holds:
        """What holds a sheet at x (V, 3) [m] in a run."""
        count = len(sheet.sheet.rest)
        low, high = np.full(count, -np.inf), np.full(count, np.inf)
        if self.half and isinstance(self.layer.place, Flat):
            low[sheet.number[self.cloth.vertices[:, 1] > 0]] = GAP
        low[sheet.middle] = high[sheet.middle] = 0.0
        bounds = {"low": low, "high": high} if self.half else {}
        pairs, ends = self.places(sheet).pairs(course)
        for belt in course.belts:
            pairs = np.concatenate([pairs, self.belts[belt][0]])
            ends = np.concatenate([ends, self.belts[belt][1]])
        return Holds.of(
            count,
            pairs=pairs,
            positions=x,
            ends=ends,
            slaves=sheet.slaves,
            limit=self.layer.program.limit,
            **bounds,
        )

    def _belts(self, course: Course) -> Iterator[tuple[Belt, int, np.ndarray]]:
        """Each belt of a course, the key of the pose it begins in, and the middle (3,) [m] that it goes round there."""
        figure, key = self.wearing.figure, course.steps[0].keys[0]
        if figure is None:
            return
        for belt in course.belts:
            pose = self.wearing.moves.poses[key]
            centre = figure.mannequin.landmarks(pose)[belt.mark] + [0.0, belt.rise, 0.0]
            centre[[0, 2]] = figure.middle(pose, float(centre[1]))
            yield belt, key, centre

    def _check_belts(self) -> None:
        """What is worn beneath does not give way: by a tighter belt cloth would be pressed through it and itself."""
        for course in self.courses:
            off = 2 * np.pi * self.contact(course).clearance  # that much longer is what lies so far outside
            for belt, key, centre in self._belts(course):
                for layer, worn in zip(self.wearing.outfit.layers, self.wearing.garments(key), strict=False):
                    girth = girth_there(*worn, centre) + off
                    if belt.length < girth:
                        raise SimCoreError(
                            f"{self._belt(belt)}.length: {100 * belt.length:.1f} cm, round {layer.name!r} beneath it "
                            f"is {100 * girth:.1f} cm there – draw that in by a belt of its own, which it wears when "
                            "this one is drawn, or make this one longer"
                        )

    def _lay_belts(self, course: Course, sheet: SewnSheet, x: np.ndarray) -> None:
        """Belts that join in this run go round the cloth as it lies at x (V, 3) [m]; they stay where they are then."""
        for belt, _, centre in self._belts(course):
            if belt in self.belts:
                continue
            try:
                self.belts[belt] = belt_pairs(x, sheet.sheet.faces, centre, belt.length, self.layer.edge)
            except SimCoreError as error:
                raise SimCoreError(f"{self._belt(belt)}: {error}") from error

    def _belt(self, belt: Belt) -> str:
        """How errors name a belt."""
        steps = enumerate(self.layer.program.steps, 1)
        step = next(step.named(number) for number, step in steps if step.belt == belt)
        return f"{self.wearing.outfit.key(self.number)}.{step}.belt"

    def _gap(self, x: np.ndarray) -> float:
        """Largest distance [m] of two pattern vertices at x (P, 3) that are one point of the closed garment."""
        low, high = (np.full((self.cloth.closed.max() + 1, 3), fill) for fill in (np.inf, -np.inf))
        np.minimum.at(low, self.cloth.closed, x)
        np.maximum.at(high, self.cloth.closed, x)
        return float(np.linalg.norm(high - low, axis=1).max())
