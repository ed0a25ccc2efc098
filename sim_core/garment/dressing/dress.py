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
from sim_core.cloth import Checkpoint, Drape, Holds
from sim_core.cloth.run.drape_run import ENGINE_VERSION
from sim_core.garment.dressing.course import Course, brought_to_rest, courses, frames
from sim_core.garment.dressing.fitting import check_fits, first_positions
from sim_core.garment.dressing.materials import Materials
from sim_core.garment.dressing.quality import measured, unrest
from sim_core.garment.dressing.records import Clock, Kept, forget, versions
from sim_core.garment.dressing.runs import Ran, Runs, Spread
from sim_core.garment.dressing.symmetry import let_go_whole, mirrored
from sim_core.garment.dressing.wearing import Trail, Wearing
from sim_core.garment.garment import Garment
from sim_core.garment.outfit import Layer, Outfit
from sim_core.garment.pattern import Transfer
from sim_core.garment.settled import Settled

__all__ = ["Frame", "dress"]

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
    then let go as a whole until that rests. Any other garment is dressed whole. Fine cloth is sewn and posed
    on a coarser mesh and comes to rest on its own (`Layer.first`).
    checkpoint: a name beside which states are kept to go on from, until all is done; or a `Checkpoint`, with keep until
    the caller, who has more to do, calls `forget`. An interrupted dressing comes to the same bits.
    Raises SimCoreError, before anything runs, where cloth or ties cannot go where they shall.
    """
    check_fits(replace(outfit, layers=tuple(layer.first for layer in outfit.layers)))
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
    count = sum(run.count() for run in runs)
    if layer.first is layer:
        return count * area / layer.edge**2
    return area * (count / layer.first.edge**2 + frames(runs[-1].steps[-1].step) / layer.edge**2)


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
        self.first = self.layer.first
        runs, self.moves = courses(self.layer, outfit.pose)
        self.wearing = Wearing(outfit, self.moves, trails, closing=self.layer.closing)
        self.half = mirrored(outfit, number, self.moves)
        self.carried = brought_to_rest(runs, roughly=self.half) if self.first is not self.layer else ()
        self.runs, self.last = (*runs, *self.carried), runs[-1].steps[-1].step
        self.progress, self.on_frame = progress, on_frame
        self.kept = checkpoint and Kept(checkpoint, number)
        self.trail: list[tuple[float, np.ndarray]] = []

    def result(self) -> tuple[Garment, Trail]:
        """The garment, and how it moved with the wearer; of an earlier, interrupted dressing if that came so far."""
        inputs = self._inputs()
        beneath = self.kept if self._is_beneath() else None
        if beneath and (finished := beneath.finished(inputs)):
            return finished
        clock, busy = Clock(), time.process_time()
        garment, done, gap = self._dressed(clock)
        clock.lap("drape")
        clock.laps["drape_cpu"] = round(time.process_time() - busy, 2)
        if self.progress:
            self.progress(0.97, "checking")
        errors = measured(garment, self.layer) | unrest(done[-1])
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
            simulated=sum(run.frames for run in done) / 25,
            substeps=sum(run.substeps for run in done),
            rollbacks=sum(run.rollbacks for run in done),
            seconds=clock.laps,
            errors=errors,
            **({"stand": self.outfit.stand.to_dict()} if self.outfit.stand else {}),
            **({} if self.layer.accessory is None else {"accessory": self.layer.accessory}),
        )
        trail = self._trail(garment)
        if beneath:
            beneath.finish(garment, trail)
        if self.progress:
            self.progress(1.0, "done")
        return garment, trail

    def _dressed(self, clock: Clock) -> tuple[Garment, tuple[Drape, ...], float | None]:
        """The garment at rest, what its runs came to, the gap [m] of its seams before they were welded."""
        start = self._placed()
        clock.lap("placing")
        runs = self._runs(self.first, self.runs[: len(self.runs) - len(self.carried)])
        materials = runs.materials()
        clock.lap("weave")
        transfer = self._transfer()
        hooks = self._hooked(0, lambda x: x if transfer is None else transfer.of(x))
        ran = runs.through(materials, (start, np.zeros_like(start)), hooks)
        gap, done = ran.gap, ran.drapes
        facts: dict[str, Any] = {}
        if transfer is not None:
            clock.lap("coarse")
            facts["coarse"] = {"edge": self.first.edge, "simulated": sum(run.frames for run in done) / 25}
            runs = self._runs(self.layer, self.carried)
            materials = runs.materials()
            x, v = (transfer.of(each) for each in ran.worn())
            ran = runs.through(materials, (x, v), self._hooked(len(done), lambda x: x))
            done += ran.drapes
        garment = self._garment(materials, runs, ran).noted(**facts)
        if self.half and self.last.still:
            whole = self._hooks(len(self.runs), lambda x: x[garment.weld])
            garment, last = let_go_whole(garment, self.last, whole)
            done = *done, last
        return garment, done, gap

    def _placed(self) -> np.ndarray:
        """Positions (P, 3) [m] of the pattern vertices as they are laid; whether there is a floor is known then.

        The floor costs a little in every step: it is there for cloth that can reach it.
        """
        cloth = self.first.cut if self.half else self.first.cloth
        ground = self.wearing.ground(self.first)
        start = first_positions(self.outfit.key(self.number), self.first, cloth, ground)
        floor = self.outfit.wearer is not None and float(start[:, 1].min()) < NEAR_FLOOR
        self.wearing = replace(self.wearing, floor=floor)
        return start

    def _runs(self, layer: Layer, own: tuple[Course, ...]) -> Runs:
        return Runs(layer, self.number, own, self.wearing, half=self.half)

    def _transfer(self) -> Transfer | None:
        """From the mesh that is sewn and posed to the layer's own; None where it is its own."""
        if self.first is self.layer:
            return None
        if self.half:
            return Transfer.between(self.first.cut, self.layer.cut)
        return Transfer.between(self.first.cloth, self.layer.cloth)

    def _inputs(self) -> str:
        """A hash of all that decides the result: this layer and those beneath."""
        told = self.outfit.to_dict()
        told["layers"] = told["layers"][: self.number + 1]
        text = json.dumps([ENGINE_VERSION, told], sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()[:16]

    def _hooked(self, before: int, spread: Spread) -> Callable[[int, Spread], dict[str, Any]]:
        """Hooks of runs of which so many were before; spread: positions of the layer's own pattern vertices from those
        (P, 3) of the runs'."""
        return lambda number, own: self._hooks(before + number, lambda x: self._both(spread(own(x))))

    def _hooks(self, number: int, spread: Spread) -> dict[str, Any]:
        """What run `number` of the engine reports as a part of the whole, and where its state is kept.

        spread: positions (P, 3) of all pattern vertices from those (V, 3) of the run. The number after the last one is
        the run in which the whole garment comes to rest that was dressed as one half.
        """
        counts = [float(course.count()) for course in self.runs]
        dearer = (self.first.edge / self.layer.edge) ** 3  # a frame on the layer's own mesh
        counts[len(counts) - len(self.carried) :] = [dearer * course.count() for course in self.carried]
        if self.half and self.last.still:
            counts.append(dearer * 2 * frames(self.last))
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

    def _garment(self, materials: Materials, runs: Runs, ran: Ran) -> Garment:
        pattern, layer = self.layer.pattern, self.layer
        both = self.layer.cloth
        positions = np.zeros((int(both.closed.max()) + 1, 3))
        positions[both.closed] = self._both(ran.worn()[0])
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
            settled=self._settled(runs, ran),
            origins=layer.panel_origins() if layer.placed else (),
        )

    def _settled(self, runs: Runs, ran: Ran) -> Settled:
        """What the whole garment came to rest in, in its own numbering."""
        course, sheet = runs.courses[-1], ran.sheet
        weld, own = self.layer.cloth.closed, len(runs.cloth.vertices)
        count = int(weld.max()) + 1
        places = runs.places(sheet)
        last = course.steps[-1].phase(places.vertices, moving=False)
        held = np.isin(sheet.number, last.pins)
        pins = np.unique(weld[np.r_[held, held] if self.half else held])
        last = replace(last, pins=tuple(int(pin) for pin in pins))
        holds = runs.holds(sheet, course, ran.drapes[-1].positions)
        if self.half:
            low, high = np.full(count, -np.inf), np.full(count, np.inf)
            low[weld[:own]], high[weld[:own]] = holds.low[sheet.number], holds.high[sheet.number]
            low[weld[own:]], high[weld[own:]] = -holds.high[sheet.number], -holds.low[sheet.number]
            whole = Holds.of(count, low=low, high=high, limit=holds.limit)
        else:
            whole = holds
        beneath = self.wearing.beneath(len(self.moves.poses) - 1)
        return Settled(runs.contact(course), last, whole, beneath, self.layer.program.even)

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
