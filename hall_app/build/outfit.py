"""One outfit, from files to what the hall shows: simulated garments, both models, film, stills, record."""

from __future__ import annotations

import shutil
import time
from collections.abc import Callable, Sequence
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hall_app.build.encoding import film_possible
from hall_app.build.film import STUDIO, Film, filming, stills
from hall_app.build.look import AFAR, Wardrobe
from hall_app.build.motion import play, write_motion
from hall_app.build.trails import TrailLostError, Trails
from hall_app.content.bakes.accessories import cloth_area, garment_at
from hall_app.content.bakes.key import dressing_key
from hall_app.content.bakes.record import FILES, publish, seal, text_of
from hall_app.content.bakes.steps import Step, beneath_budget, budget, chosen_steps, hall_budget, study_of
from hall_app.content.bakes.store import RECORD, bake_fault, layer_files, read_record
from hall_app.content.folder import Content, Exhibit
from hall_app.content.models.glb import read_glb

if TYPE_CHECKING:
    from sim_core.garment import Frame, Garment, Outfit

__all__ = ["bake_outfit", "budget", "refuse_disorder"]

Progress = Callable[[float, str], None]

FILM = ("drape.webm", "drape.mp4")
PICTURES = ".jpg"
KEPT = 2.0**-23  # [m] to which a garment is kept; at eight times that stiff cloth measures .3 % otherwise


def bake_outfit(
    content: Content,
    exhibit: Exhibit,
    *,
    key: str,
    target: Path,
    work: Path,
    progress: Progress,
    film: bool = True,
    former: Path | None = None,
) -> dict[str, Any]:
    """Bake the exhibit's outfit into `target` and return the record that is kept beside it.

    work: where an interrupted bake left its state and where this one leaves its own; gone after success.
    film: whether to film how the garment is dressed, and what is worn over it, which needs PyAV.
    former: an earlier bake, whose garments, film and pictures serve again where only how they are shown has changed.
    Raises what reading, meshing, weaving and dressing raise, each naming file and remedy.
    """
    from sim_core.garment import load_outfit
    from sim_core.garment.step_study import study_inputs

    began = time.perf_counter()
    out = work / "out"
    out.mkdir(parents=True, exist_ok=True)
    assert exhibit.file.outfit is not None
    steps = chosen_steps(content, exhibit)
    wardrobe = Wardrobe(_stepped(load_outfit(content.folder / exhibit.file.outfit, content.folder), steps))
    show = exhibit.file.show
    levels: list[Garment] = []
    coarse: list[Garment] = []
    moving: dict[str, float] = {}

    def models(garments: Sequence[Garment]) -> None:
        *beneath, outermost_file = layer_files(len(garments))
        for garment, name in zip(garments, beneath, strict=False):
            garment.save(out / name, beside=(outermost_file, garments[-1]))  # both lie on the figure
        garments[-1].save(out / outermost_file)
        played = play(wardrobe.outfit, garments, lambda share, label: progress(0.6 + 0.07 * share, label))
        outermost = hall_budget(show.nearest, show.hall_error_px, moving=played is not None)
        near, far = wardrobe.write_models(
            garments, out, (beneath_budget(show), outermost), show.nearest, played
        )
        levels.extend(near)
        coarse.extend(far)
        if played is not None:
            told = write_motion(
                wardrobe.outfit,
                garments,
                played,
                out,
                lambda share, label: progress(0.67 + 0.03 * share, label),
            )
            moving.update(told)

    dressing = dressing_key(content, exhibit)
    film = film and film_possible()
    kept = _kept(former, dressing, len(wardrobe.outfit.layers), out, film=film) if former else None
    if kept is None:
        garments, seconds = _dress(wardrobe, work, out, progress, models, film=film)
        seconds["all"] = round(time.perf_counter() - began, 2)
    else:
        garments, seconds, pictured = kept
        garments = _as_kept(wardrobe.outfit, garments)
        progress(0.6, "models")
        clock = time.perf_counter()
        models(garments)
        if not pictured:
            progress(0.95, "pictures")
            stills(wardrobe.still(garments), out)
        took = time.perf_counter() - clock
        seconds["all"] = round(seconds["all"] + took - seconds["models"], 2)
        seconds["models"] = round(took, 2)
    record: dict[str, Any] = {
        **_record(key, garments, levels, seconds),
        "dressing": dressing,
        "studio": STUDIO,
    }
    if steps:
        study = study_of(content, exhibit)
        record["steps"] = [step.model_dump() for step in steps]
        record["study_fits"] = study is not None and study.inputs == study_inputs(wardrobe.outfit)
    record["errors"] |= moving
    hall = read_glb(out / "hall.glb")
    record["errors"]["hall_all_triangles"] = hall.triangles - hall.afar
    if coarse:
        record["afar"] = _afar(coarse, hall.afar, AFAR * show.nearest)
    record[FILES] = seal(out, RECORD)
    (out / RECORD).write_text(text_of(record), "utf-8")
    publish(out, target, RECORD)
    shutil.rmtree(work, ignore_errors=True)
    progress(1.0, "done")
    return record


def _stepped(outfit: Outfit, steps: Sequence[Step]) -> Outfit:
    """The outfit meshed at the steps its study gives. Raises SimCoreError where that was made of other layers."""
    from sim_core.errors import SimCoreError

    if not steps:
        return outfit
    if len(steps) != len(outfit.layers):
        raise SimCoreError(
            f"{outfit.source}: study: of {len(steps)} layers, the outfit has {len(outfit.layers)} – write it anew by "
            "`simcore dress --study`"
        )
    layers = (replace(layer, edge=step.edge) for layer, step in zip(outfit.layers, steps, strict=True))
    return replace(outfit, layers=tuple(layers))


def _kept(
    former: Path, dressing: str, layers: int, out: Path, *, film: bool
) -> tuple[tuple[Garment, ...], dict[str, float], bool] | None:
    """Garments and seconds of an earlier bake, whose film is copied to `out`, and whether its pictures are, too: where
    they were taken in this studio. None where it will not do."""
    from sim_core.garment import Garment

    record = read_record(former)
    if record is None or record.get("dressing") != dressing or bake_fault(former) is not None:
        return None
    if film and FILM[0] not in record[FILES]:
        return None
    pictured = record.get("studio") == STUDIO
    as_it_was = (*FILM, PICTURES) if pictured else FILM
    for name in record[FILES]:
        if name.endswith(as_it_was):  # models, and how they move, are made anew
            shutil.copyfile(former / name, out / name)
    garments = tuple(Garment.load(file) for file in map(former.joinpath, layer_files(layers)))
    return garments, dict(record["seconds"]), pictured


def _dress(
    wardrobe: Wardrobe,
    work: Path,
    out: Path,
    progress: Progress,
    models: Callable[[Sequence[Garment]], None],
    *,
    film: bool,
) -> tuple[tuple[Garment, ...], dict[str, float]]:
    """Dress, and film it meanwhile; `models` writes what is to be written while the last pictures are drawn."""
    look = wardrobe.film()  # draws the weaves' maps, too, which takes no time of the dressing
    clock, seconds = time.perf_counter(), {}

    def lap(name: str) -> None:
        nonlocal clock
        now = time.perf_counter()
        seconds[name], clock = round(now - clock, 2), now

    with filming(look, work / "film") if film else nullcontext() as taken:
        garments = _dressed(
            wardrobe, work / "dress", taken, lambda share, label: progress(0.6 * share, label)
        )
        lap("drape")
        refuse_disorder(garments)
        garments = _as_kept(wardrobe.outfit, garments)
        if taken is not None:
            taken.walk_round(_at_rest(wardrobe.outfit, garments))
            taken.stills(wardrobe.still(garments), out)
            taken.encode((out / FILM[0], out / FILM[1]), _sound)
        progress(0.6, "models")
        models(garments)
        lap("models")
        if taken is not None:
            progress(0.7, "film")
            taken.wait(lambda share: progress(0.7 + 0.25 * share, "film"))
            lap("film")
        else:
            progress(0.95, "pictures")
            stills(wardrobe.still(garments), out)
    return garments, seconds


def _as_kept(outfit: Outfit, garments: Sequence[Garment]) -> tuple[Garment, ...]:
    """The garments as files keep them, and what is measured of these: a record tells of what lies beside it."""
    from sim_core.garment import measured

    on_grid = [garment.on_grid(KEPT) for garment in garments]
    return tuple(
        garment.noted(errors={**garment.provenance["errors"], **measured(garment, layer)})
        for garment, layer in zip(on_grid, outfit.layers, strict=True)
    )


def refuse_disorder(garments: Sequence[Garment]) -> None:
    """Raises SimCoreError where cloth lies under what it should lie over: such a garment is not shown."""
    from sim_core.errors import SimCoreError

    for garment in garments:
        wrong = garment.provenance["errors"]["layer_order"]
        if wrong:
            raise SimCoreError(
                f"{garment.name}: {wrong} vertices lie under the front they should lie over – raise the outer one by "
                "[layer.place] lift, or make the steps slower"
            )


def _dressed(wardrobe: Wardrobe, state: Path, taken: Film | None, progress: Progress) -> tuple[Garment, ...]:
    """Dress the outfit, each frame filmed from `wardrobe.filmed` on; goes on from `state` where that is whole."""
    from sim_core.cloth import Checkpoint
    from sim_core.garment import dress

    outfit = wardrobe.outfit
    state.mkdir(parents=True, exist_ok=True)
    kept = Checkpoint(state / "state.npz", keep=True)  # until models, film and pictures are written, too
    if taken is None:
        return dress(outfit, progress=progress, checkpoint=kept)
    last = len(outfit.layers) - 1

    def shoot(frame: Frame, trails: Trails) -> None:
        if frame.layer < last:
            trails.hear(frame)
        if frame.layer < wardrobe.filmed:
            return
        if not all(map(trails.heard_now, range(wardrobe.filmed, frame.layer))):
            raise TrailLostError("an earlier run filmed its first layer")
        body = [] if outfit.wearer is None else [outfit.wearer.posed(frame.pose)]
        bare = [None] * (last - frame.layer)
        taken.shoot([*bare, frame.positions, *trails.beneath(frame.layer, frame.pose), *body])

    for _ in range(2):
        trails = Trails(state)
        try:
            return dress(
                outfit,
                progress=progress,
                on_frame=lambda frame, trails=trails: shoot(frame, trails),
                checkpoint=kept,
            )
        except TrailLostError:  # interrupted between two layers: what was not seen cannot be filmed
            shutil.rmtree(state)
            state.mkdir()
    raise AssertionError("a dressing that began anew has heard all of its layers")


def _at_rest(outfit: Outfit, garments: Sequence[Garment]) -> list[np.ndarray]:
    """What moves in the film, as it came to rest."""
    body = [] if outfit.wearer is None else [outfit.wearer.posed(outfit.pose)]
    return [*(garment.worn() for garment in reversed(garments)), *body]


def _sound() -> np.ndarray:
    """The film's music, mono at 48 kHz."""
    from hall_app.media.music import falling_gauze

    return falling_gauze().mean(axis=1).astype(np.float32)


def _record(
    key: str, garments: Sequence[Garment], levels: Sequence[Garment], seconds: dict[str, float]
) -> dict[str, Any]:
    """What the hall tells of this bake; every number comes from a measurement."""
    errors: dict[str, float] = {}
    stages: dict[str, float] = {}
    shown = garment_at(
        [
            (cloth_area(garment.pattern, garment.pattern_faces), garment.provenance.get("accessory"))
            for garment in garments
        ]
    )
    for number, (garment, light) in enumerate(zip(garments, levels, strict=True), 1):
        before = "" if number == len(garments) else f"{garment.name}_"
        errors |= {f"{before}{name}": value for name, value in _figures(garment, light).items()}
        for stage, taken in garment.provenance["seconds"].items():
            stages[stage] = round(stages.get(stage, 0.0) + taken, 2)
    return {
        "key": key,
        "digest": garments[-1].digest(),
        "layers": [_layer(garment) for garment in garments],
        "shown": garments[shown].name,
        "errors": errors,
        "seconds": seconds,
        "stages": stages,
        "hall_budget_m": levels[-1].provenance["detail"].get("budget_m"),
        "versions": garments[-1].provenance["versions"],
    }


def _afar(levels: Sequence[Garment], triangles: int, distance: float) -> dict[str, float]:
    """Of the level seen beyond a distance [m]: triangles of all, and by how much its worst layer deviates [m]."""
    apart = [level.provenance["detail"].get("hausdorff", {}).get("p99_m", 0.0) for level in levels]
    return {"from_m": distance, "triangles": triangles, "hausdorff_p99_m": max(apart)}


def _layer(garment: Garment) -> dict[str, Any]:
    """Which garment it is, and how it was dressed."""
    return {"name": garment.name, "digest": garment.digest()} | {
        fact: garment.provenance[fact] for fact in ("way", "whole")
    }


def _figures(garment: Garment, light: Garment) -> dict[str, float]:
    """The measured figures of one garment and of its level in the hall."""
    told = garment.provenance["errors"]
    errors = {name: value for name, value in told.items() if not isinstance(value, list)}
    apart = light.provenance["detail"].get("hausdorff", {})
    errors |= {f"hall_hausdorff_{name.removesuffix('_m')}": value for name, value in apart.items()}
    if (moving := light.provenance["detail"].get("moving_p99_m")) is not None:
        errors["moving_hall_hausdorff_p99"] = moving
    errors["vertices"], errors["triangles"] = len(garment.positions), len(garment.faces)
    errors["hall_triangles"] = len(light.faces)
    return errors
