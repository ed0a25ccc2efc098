"""From surfaces to the light map: passes of gathering, each looking up what the last one found."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hall_app.light.atlas.filters import fill, frame_charts, smooth
from hall_app.light.atlas.packing import Atlas, atlas_of
from hall_app.light.atlas.texels import Places, places_of
from hall_app.light.checkpoint import State, key_of, load, save
from hall_app.light.encode import show
from hall_app.light.gather import Scene, gather
from hall_app.light.lamps import lamps_of, spot_rows
from hall_app.light.model import LightError, LightMap, Sampling, Spot, Surfaces
from hall_app.light.rays.embree import build_tree
from hall_app.light.spots import gather_spots

__all__ = ["bake_light", "scene_of"]

_INSIDE = 0.4  # points more of whose rays than this meet backs of faces lie inside a body
_SAMPLING = Sampling()

Singles = NDArray[np.float32]
Progress = Callable[[float, str], None]


def scene_of(surfaces: Surfaces, atlas: Atlas) -> Scene:
    """What rays meet, with the slots the light of each face is kept in."""
    bare = np.full(len(surfaces.faces), -1, np.int32)
    open_faces = np.flatnonzero(surfaces.chart < 0)
    bare[open_faces] = atlas.width * atlas.height + 2 * np.arange(len(open_faces))
    charted = np.maximum(surfaces.chart, 0)
    shape = (len(surfaces.faces), 2)
    empty = len(surfaces.density) == 0
    low = np.zeros(shape, np.int32) if empty else atlas.corner[charted]
    high = low if empty else low + atlas.size[charted] - 1
    return Scene(
        albedo=np.ascontiguousarray(surfaces.albedo, np.float32),
        emission=np.ascontiguousarray(surfaces.emission, np.float32),
        place=atlas.place.astype(np.float32),
        low=np.ascontiguousarray(low, np.int32),
        high=np.ascontiguousarray(high, np.int32),
        bare=bare,
        sheet=(surfaces.chart < 0) if empty else (surfaces.chart < 0) | surfaces.two_sided[charted],
        width=atlas.width,
    )


def bake_light(
    surfaces: Surfaces,
    spots: Sequence[Spot] = (),
    sampling: Sampling = _SAMPLING,
    *,
    fill_light: float = 0.05,
    filtered: bool = True,
    progress: Progress | None = None,
    checkpoint: Path | None = None,
) -> LightMap:
    """The light on every chart, on one machine the same bits for the same input and seed on any number of cores.

    fill_light: added everywhere, for the bounces left out; filtered: smooth noise; progress: called with the share done
    and a word; checkpoint: file the state is kept in after every pass and gone on from when surfaces, spots and
    settings are the same. Raises LightError.
    """
    if len(surfaces.density) == 0:
        raise LightError("light: charts: none – give at least one chart")
    rays = sampling.rays
    began, cpu = time.perf_counter(), time.process_time()
    told = progress or (lambda share, label: None)
    told(0.0, "charts")
    atlas = atlas_of(surfaces)
    chart = atlas.chart_image()
    places = places_of(surfaces, atlas)
    scene, lamps, rows = scene_of(surfaces, atlas), lamps_of(surfaces), spot_rows(spots)
    tree = build_tree(surfaces.vertices, surfaces.faces)
    key = key_of(surfaces, rows, sampling, (fill_light, float(filtered)))
    state = load(checkpoint, key) or State(
        0, _dark(atlas, surfaces), np.zeros((*chart.shape, 3), np.float32), np.zeros(len(places.point), bool),
        np.zeros(4, np.int64), 0.0, 0.0,
    )  # fmt: skip
    direct = gather_spots(tree, rows, places, seed=sampling.seed)
    total = float(sum(rays))
    for step in range(state.done, len(rays)):
        label, before = f"pass {step + 1} of {len(rays)}", float(sum(rays[:step]))
        seen = places.without(state.inside)
        if 0 < step == len(rays) - 1:
            seen = _charted(seen, atlas)
        halves, backs, tally = gather(
            tree, scene, lamps, seen, state.light, sampling, step=step,
            told=lambda share, before=before, step=step, label=label: told(
                0.03 + 0.92 * (before + share * rays[step]) / total, label
            ),
        )  # fmt: skip
        if step == 0:
            state.inside = _inside(places, backs, rays[0])
        found = halves.mean(1) + direct[: len(halves)]
        state.light, state.error = _settle(
            found,
            ((halves[:, 0] - halves[:, 1]) / 2).astype(np.float32),
            places,
            state.inside,
            atlas,
            chart,
            state.light,
            filtered,
        )
        state.done, state.tally = step + 1, state.tally + tally
        state.seconds += time.perf_counter() - began
        state.cpu += time.process_time() - cpu
        began, cpu = time.perf_counter(), time.process_time()
        save(checkpoint, key, state)
    told(0.96, "light map")
    result = _light_map(surfaces, atlas, chart, places, state, fill_light)
    result.record["seconds"] = round(state.seconds + time.perf_counter() - began, 2)
    result.record["cpu_seconds"] = round(state.cpu + time.process_time() - cpu, 2)
    told(1.0, "light map")
    return result


def _dark(atlas: Atlas, surfaces: Surfaces) -> Singles:
    return np.zeros((atlas.width * atlas.height + 2 * int((surfaces.chart < 0).sum()), 3), np.float32)


def _charted(places: Places, atlas: Atlas) -> Places:
    """Without the faces that have no chart: nobody looks up what the last pass finds there."""
    count = int((places.slot < atlas.width * atlas.height).sum())
    last = places.first[count]
    return Places(
        places.slot[:count], places.first[: count + 1], places.both[:count],
        places.point[:last], places.normal[:last], places.plane[:last],
    )  # fmt: skip


def _inside(places: Places, backs: NDArray[np.int32], rays: int) -> NDArray[np.bool_]:
    """(M,) points inside bodies: too many of their share of the rays met backs."""
    count = np.diff(places.first)
    thing = np.repeat(np.arange(len(count)), count)
    rank = np.arange(len(backs)) - places.first[:-1][thing]
    cast = (rays - rank + count[thing] - 1) // count[thing]
    return backs > _INSIDE * np.maximum(cast, 1)


def _settle(
    found: Singles, error: Singles, places: Places, inside: NDArray[np.bool_], atlas: Atlas,
    chart: NDArray[np.int32], last: Singles, filtered: bool,
) -> tuple[Singles, Singles]:  # fmt: skip
    """Gathered light (N, 3) as light by slot and error (H, W, 3): gaps filled, noise smoothed."""
    size = atlas.width * atlas.height
    outside = np.add.reduceat(~inside, places.first[:-1])[: len(found)] > 0
    light = last.copy()
    light[places.slot[: len(found)]] = found
    known = np.zeros(len(light), bool)
    known[places.slot[: len(found)]] = outside
    noise = np.zeros((len(light), 3), np.float32)
    noise[places.slot[: len(found)]] = error
    shape = (atlas.height, atlas.width, 3)
    both = np.concatenate([light[:size].reshape(shape), noise[:size].reshape(shape)], axis=2)
    fill(both, known[:size].reshape(shape[:2]), chart)
    picture, error = np.ascontiguousarray(both[..., :3]), np.ascontiguousarray(both[..., 3:])
    if filtered:
        picture, error = smooth(picture, error, atlas, chart)
    light[:size] = picture.reshape(-1, 3)
    return light, error


def _light_map(
    surfaces: Surfaces, atlas: Atlas, chart: NDArray[np.int32], places: Places, state: State, fill_light: float
) -> LightMap:  # fmt: skip
    size = atlas.width * atlas.height
    gathered = state.light[:size].reshape(atlas.height, atlas.width, 3) + np.float32(fill_light)
    rims = frame_charts(np.dstack([gathered, state.error]), chart)
    image = np.ascontiguousarray(rims[..., :3])
    covered = chart >= 0
    mean = max(float(image[covered].mean()), 1e-12)
    uv = atlas.place / [atlas.width, atlas.height]
    rays, missed, backs, drawn = (int(value) for value in state.tally)
    texels = int(covered.sum())
    record: dict[str, Any] = {
        "texels": texels,
        "size": [atlas.width, atlas.height],
        "charts": len(atlas.size),
        "triangles": len(surfaces.faces),
        "rays": rays + drawn,
        "missed": missed / max(rays, 1),
        "inside": backs / max(rays, 1),
        "noise": float(np.sqrt((state.error[covered] ** 2).mean())) / mean,
        "mean": mean,
    }
    drawn_as = show(surfaces, atlas, image)
    record |= {"gain": drawn_as.gain, "rolled_off": drawn_as.rolled, "dimmed": drawn_as.dimmed}
    return LightMap(drawn_as.glow, drawn_as.shown, uv.astype(np.float32), covered, drawn_as.gain, record)
