"""`dress`: the only driver. An outfit becomes garments, layer by layer from the skin outwards."""

from __future__ import annotations

import hashlib
import json
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from sim_core.body.pose import Pose
from sim_core.cloth import Checkpoint, Drape, Holds, drape
from sim_core.cloth.run.drape_run import ENGINE_VERSION
from sim_core.errors import SimCoreError
from sim_core.garment.dressing.course import Course, courses, frames
from sim_core.garment.dressing.fitting import check_fits, first_positions
from sim_core.garment.dressing.materials import Materials, materials_of
from sim_core.garment.dressing.places import Places, belt_pairs
from sim_core.garment.dressing.quality import measured, unrest
from sim_core.garment.dressing.records import Clock, Kept, forget, versions
from sim_core.garment.dressing.sewn_sheet import SewnSheet, sewn_sheet
from sim_core.garment.dressing.symmetry import let_go_whole, mirrored
from sim_core.garment.dressing.wearing import Trail, Wearing
from sim_core.garment.garment import Garment
from sim_core.garment.outfit import Belt, Layer, Outfit
from sim_core.garment.placement import Flat
from sim_core.garment.settled import Settled

__all__ = ["Frame", "dress"]

GAP = 0.004  # [m] from the middle, which the fronts of one half do not pass: there is nothing beyond to touch
NEAR_FLOOR = 0.05  # [m] from which on cloth may touch the floor when it has been let go

Progress = Callable[[float, str], None]


@dataclass(frozen=True)
class Frame:
    """One of 25 frames a second: layer (0 next to the skin), positions (P, 3) float32 [m] of all its pattern vertices,
    and the wearer's pose."""

    layer: int
    positions: np.ndarray
    pose: Pose


def dress(
    outfit: Outfit,
    *,
    progress: Progress | None = None,
    on_frame: Callable[[Frame], None] | None = None,
    checkpoint: Path | Checkpoint | None = None,
) -> tuple[Garment, ...]:
    """Dresses the outfit; equal inputs give equal bits on one machine. Returns its garments from the skin outwards.

    A layer is dressed over those before it, which keep where they came to rest, or move with the wearer as they did.
    A mirrored pattern on a wearer that stands like its own mirror image is dressed as one half against its image and
    then let go as a whole until that rests. Any other garment is dressed whole.
    checkpoint: a name beside which states are kept to go on from, until all is done; or a `Checkpoint`, with keep until
    the caller, who has more to do, calls `forget`. An interrupted dressing comes to the same bits.
    Raises SimCoreError, before anything runs, where cloth or ties cannot go where they shall.
    """
    check_fits(outfit)
    place = checkpoint if isinstance(checkpoint, Checkpoint) or checkpoint is None else Checkpoint(checkpoint)
    done: list[Garment] = []
    trails: list[Trail] = []
    weights = np.cumsum([0.0, *(_work(outfit, layer) for layer in outfit.layers)])
    for number, layer in enumerate(outfit.layers):

        def told(share: float, label: str, number: int = number, layer: Layer = layer) -> None:
            assert progress is not None
            low, high = weights[number : number + 2] / weights[-1]
            progress(
                float(low + share * (high - low)),
                f"{layer.name}, {label}" if len(outfit.layers) > 1 else label,
            )

        dressing = _Dressing(outfit, number, tuple(trails), told if progress else None, on_frame, place)
        garment, trail = dressing.result()
        done.append(garment)
        trails.append(trail)
    if place is not None and not place.keep:
        forget(Path(place.path))
    return tuple(done)


def _work(outfit: Outfit, layer: Layer) -> float:
    """What a layer's dressing costs, in about equal units: frames times faces."""
    runs, _ = courses(layer, outfit.pose)
    area = sum(float(np.abs(_area(panel.outline()))) for panel in layer.pattern.panels) or 1.0
    return sum(run.count() for run in runs) * area / layer.edge**2


def _area(outline: np.ndarray) -> float:
    x, y = outline.T
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))


class _Dressing:
    """One layer: placed, run by run, measured."""

    def __init__(
        self,
        outfit: Outfit,
        number: int,
        trails: tuple[Trail, ...],
        progress: Progress | None,
        on_frame: Callable[[Frame], None] | None,
        checkpoint: Checkpoint | None,
    ) -> None:
        self.outfit, self.number, self.layer = outfit, number, outfit.layers[number]
        self.runs, self.moves = courses(self.layer, outfit.pose)
        self.wearing = Wearing(outfit, self.moves, trails)
        self.half = mirrored(outfit, number, self.moves)
        self.progress, self.on_frame = progress, on_frame
        self.kept = checkpoint and Kept(checkpoint, number)
        self.cut = self.layer.cut
        self.cloth = self.cut if self.half else self.layer.cloth
        self.trail: list[tuple[float, np.ndarray]] = []
        self.belts: dict[Belt, tuple[np.ndarray, np.ndarray]] = {}

    def result(self) -> tuple[Garment, Trail]:
        """The garment, and how it moved with the wearer; of an earlier, interrupted dressing if that came so far."""
        inputs = self._inputs()
        beneath = self.kept if self._is_beneath() else None
        if beneath and (finished := beneath.finished(inputs)):
            return finished
        clock, busy = Clock(), time.process_time()
        materials = materials_of(self.layer, self.cloth, self.layer.place.hanging(self.cloth))
        clock.lap("weave")
        ground = self.wearing.ground(self.layer)
        # The floor costs a little in every step: it is there for cloth that can reach it.
        start = first_positions(self.outfit.key(self.number), self.layer, self.cloth, ground)
        floor = self.outfit.wearer is not None and float(start[:, 1].min()) < NEAR_FLOOR
        self.wearing = replace(self.wearing, floor=floor)
        clock.lap("placing")
        sheet, runs, gap = self._run(materials, start)
        garment = self._garment(materials, sheet, runs)
        end = self.runs[-1].steps[-1].step
        if self.half and end.still:
            hooks = self._hooks(len(self.runs), lambda x: x[garment.weld])
            garment, last = let_go_whole(garment, end, hooks)
            runs = [*runs, last]
        clock.lap("drape")
        clock.laps["drape_cpu"] = round(time.process_time() - busy, 2)
        if self.progress:
            self.progress(0.97, "checking")
        errors = measured(garment, self.layer) | unrest(runs[-1])
        if gap is not None:
            errors["seam_gap_sewn_m"] = gap
        clock.lap("check")
        garment = garment.noted(
            outfit=self.outfit.name,
            layer=self.layer.name,
            way=type(self.layer.place).__name__.lower(),
            whole=not self.half,
            versions=versions(),
            inputs=inputs,
            seed=self.layer.seed,
            edge=self.layer.edge,
            pose=self.outfit.pose.table(),
            simulated=sum(run.frames for run in runs) / 25,
            substeps=sum(run.substeps for run in runs),
            rollbacks=sum(run.rollbacks for run in runs),
            seconds=clock.laps,
            errors=errors,
            **({"stand": asdict(self.outfit.stand)} if self.outfit.stand else {}),
        )
        trail = self._trail(garment)
        if beneath:
            beneath.finish(garment, trail)
        if self.progress:
            self.progress(1.0, "done")
        return garment, trail

    def _inputs(self) -> str:
        """A hash of all that decides the result: this layer and those beneath."""
        told = self.outfit.to_dict()
        told["layers"] = told["layers"][: self.number + 1]
        text = json.dumps([ENGINE_VERSION, told], sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()[:16]

    def _run(self, materials: Materials, start: np.ndarray) -> tuple[SewnSheet, list[Drape], float | None]:
        """All runs of the engine: the last sheet, what each came to, the gap of the seams before they were welded."""
        panels = self.layer.pattern.panels
        apart = np.array([k if panel.along else 0 for k, panel in enumerate(panels)] or [0])
        kind, apart = materials.of_faces(self.cloth), apart[self.cloth.panel % len(apart)]
        solid, gap = self.wearing.solid(half=self.half), None
        x, v, even = start, np.zeros_like(start), self.layer.program.even
        sheet, done = None, list[Drape]()
        for number, course in enumerate(self.runs):
            if sheet is None or course.closed != self.runs[number - 1].closed:
                weld = self.cloth.closed if course.closed else self.cloth.joined
                if sheet is not None:
                    x, v = x[sheet.number], v[sheet.number]
                    gap = self._gap(x)
                sheet = sewn_sheet(self.cloth, weld, materials.kinds, kind, apart, even=even)
                x, v = sheet.gathered(x), sheet.gathered(v)
                v[sheet.middle, 0] = 0.0
            places = Places(self.layer, self.cut, self.cloth, sheet)
            self._lay_belts(course, sheet, x)
            moving = self.outfit.wearer is not None
            phases = [timed.phase(places.vertices, moving=moving) for timed in course.steps]
            done.append(
                drape(
                    sheet.sheet,
                    x,
                    phases,
                    velocities=v if done else None,
                    collider=solid,
                    contact=self._contact(course),
                    holds=self._holds(sheet, course, places, x),
                    **self._hooks(number, lambda x, sheet=sheet: self._both(x[sheet.number])),
                )
            )
            x, v = done[-1].positions, done[-1].velocities
        assert sheet is not None
        return sheet, done, gap

    def _contact(self, course: Course) -> Any:
        """How it touches; over a round bar further off, so that the chords of the mesh keep clear of it, too."""
        if self.outfit.stand is None:
            return course.contact
        # Centroids lie lower than midpoints: L^2 / 6R against L^2 / 8R, and a chord across the bar by R at most.
        radius = self.outfit.stand.bar_radius
        sagitta = min(self.layer.edge**2 / (6 * radius), radius)
        return replace(course.contact, clearance=course.contact.clearance + sagitta)

    def _holds(self, sheet: SewnSheet, course: Course, places: Places, x: np.ndarray) -> Holds:
        count = len(sheet.sheet.rest)
        low, high = np.full(count, -np.inf), np.full(count, np.inf)
        if self.half and isinstance(self.layer.place, Flat):
            low[sheet.number[self.cloth.vertices[:, 1] > 0]] = GAP
        low[sheet.middle] = high[sheet.middle] = 0.0
        bounds = {"low": low, "high": high} if self.half else {}
        pairs, ends = places.pairs(course)
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

    def _lay_belts(self, course: Course, sheet: SewnSheet, x: np.ndarray) -> None:
        """Belts that join in this run go round the cloth as it lies at x (V, 3) [m]; they stay where they are then."""
        figure = self.wearing.figure
        for belt in course.belts:
            if belt in self.belts or figure is None:
                continue
            pose = self.moves.poses[course.steps[0].keys[0]]
            centre = figure.mannequin.landmarks(pose)[belt.mark] + [0.0, belt.rise, 0.0]
            centre[[0, 2]] = figure.middle(pose, float(centre[1]))
            try:
                self.belts[belt] = belt_pairs(x, sheet.sheet.faces, centre, belt.length, self.layer.edge)
            except SimCoreError as error:
                raise SimCoreError(f"{self.outfit.key(self.number)}.step: belt: {error}") from error

    def _gap(self, x: np.ndarray) -> float:
        """Largest distance [m] of two pattern vertices at x (P, 3) that are one point of the closed garment."""
        low, high = (np.full((self.cloth.closed.max() + 1, 3), fill) for fill in (np.inf, -np.inf))
        np.minimum.at(low, self.cloth.closed, x)
        np.maximum.at(high, self.cloth.closed, x)
        return float(np.linalg.norm(high - low, axis=1).max())

    def _hooks(self, number: int, spread: Callable[[np.ndarray], np.ndarray]) -> dict[str, Any]:
        """What run `number` of the engine reports as a part of the whole, and where its state is kept.

        spread: positions (P, 3) of all pattern vertices from those (V, 3) of the run. The number after the last one is
        the run in which the whole garment comes to rest that was dressed as one half.
        """
        counts, last = [course.count() for course in self.runs], self.runs[-1].steps[-1].step
        if self.half and last.still:
            counts.append(2 * frames(last))
        before, own, whole = sum(counts[:number]), counts[number], sum(counts)
        steps = self.runs[number].steps if number < len(self.runs) else ()
        keys = [key for timed in steps for key in _keys(timed.keys, timed.step.seconds)]
        keys = keys or [len(self.moves.poses) - 1]
        sewn = number == len(self.runs) or self.runs[number].closed
        welded = sewn or not any(course.closed for course in self.runs)

        def told(share: float, label: str) -> None:
            assert self.progress is not None
            self.progress(0.97 * (before + share * own) / whole, label)

        def heard(index: int, x: np.ndarray) -> None:
            key = keys[min(index, len(keys) - 1)]
            positions = spread(x)
            if welded:
                self._follow(key, positions)
            if self.on_frame is not None:
                self.on_frame(Frame(self.number, positions, self.moves.poses[key]))

        listens = self.on_frame is not None or self._is_beneath()
        return {
            "progress": told if self.progress else None,
            "on_frame": heard if listens else None,
            "checkpoint": self.kept and self.kept.state(number),
        }

    def _both(self, x: np.ndarray) -> np.ndarray:
        """Positions of all pattern vertices from those of the cloth that is simulated."""
        if not self.half:
            return x
        return np.concatenate([x, x * np.array([-1.0, 1.0, 1.0], x.dtype)])

    def _garment(self, materials: Materials, sheet: SewnSheet, runs: list[Drape]) -> Garment:
        pattern, layer = self.layer.pattern, self.layer
        both = self.layer.cloth
        positions = np.zeros((int(both.closed.max()) + 1, 3))
        positions[both.closed] = self._both(runs[-1].positions[sheet.number])
        names = [panel.name for panel in pattern.panels] or ["cloth"]
        twice = 2 if pattern.mirror else 1
        dyes = tuple(panel.dye for panel in pattern.panels) or (None,)
        return Garment(
            name=layer.name,
            pattern=both.vertices,
            pattern_faces=both.faces,
            weld=both.closed,
            panel=both.panel,
            positions=positions,
            panels=both.names,
            dyes=dyes * twice,
            cut=pattern.to_dict(),
            weave=layer.weave.to_dict(),
            weaves={name: weave.to_dict() for name, weave in layer.weaves.items()},
            material={
                "kinds": {
                    name: asdict(kind) for name, kind in zip(materials.names, materials.kinds, strict=True)
                },
                "panels": {
                    name: materials.names[k] for name, k in zip(names, materials.of_panel, strict=True)
                },
                "choices": materials.choices,
                "provenance": materials.provenance,
            },
            dye=pattern.dye,
            settled=self._settled(sheet, runs),
        )

    def _settled(self, sheet: SewnSheet, runs: list[Drape]) -> Settled:
        """What the whole garment came to rest in, in its own numbering."""
        course = self.runs[-1]
        both = self.layer.cloth
        weld, own = both.closed, len(self.cloth.vertices)
        count = int(weld.max()) + 1
        places = Places(self.layer, self.cut, self.cloth, sheet)
        last = course.steps[-1].phase(places.vertices, moving=False)
        held = np.isin(sheet.number, last.pins)
        pins = np.unique(weld[np.r_[held, held] if self.half else held])
        last = replace(last, pins=tuple(int(pin) for pin in pins))
        holds = self._holds(sheet, course, places, runs[-1].positions)
        if self.half:
            low, high = np.full(count, -np.inf), np.full(count, np.inf)
            low[weld[:own]], high[weld[:own]] = holds.low[sheet.number], holds.high[sheet.number]
            low[weld[own:]], high[weld[own:]] = -holds.high[sheet.number], -holds.low[sheet.number]
            whole = Holds.of(count, low=low, high=high, limit=holds.limit)
        else:
            whole = holds
        beneath = self.wearing.beneath(len(self.moves.poses) - 1)
        return Settled(self._contact(course), last, whole, beneath, self.layer.program.even)

    def _is_beneath(self) -> bool:
        """Whether another layer will be dressed over this one."""
        return self.number < len(self.outfit.layers) - 1

    def _follow(self, key: int, positions: np.ndarray) -> None:
        """Remembers where the garment was when the wearer was on its way."""
        if not self._is_beneath() or self.moves.still:
            return
        share = self.moves.shares[key]
        if self.trail and self.trail[-1][0] == share:
            if share < 1.0:
                self.trail[-1] = share, positions
            return
        self.trail.append((share, positions))

    def _trail(self, garment: Garment) -> Trail:
        """How the welded garment moved, its rest at last."""
        first = np.unique(garment.weld, return_index=True)[1]
        shares = np.array([share for share, _ in self.trail] + [1.0])
        frames = [np.asarray(x[first], float) for _, x in self.trail]
        return Trail(garment.faces, shares, np.stack([*frames, garment.positions]))


def _keys(ends: tuple[int, int], seconds: float) -> list[int]:
    """The key at the end of every frame of a step."""
    count = max(1, round(seconds * 25))
    return [round(ends[0] + (ends[1] - ends[0]) * (k + 1) / count) for k in range(count)]
