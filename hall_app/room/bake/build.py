"""`hall build --room`: raise the room, compute its light, write both and the environment beside the content."""

from __future__ import annotations

import shutil
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from hall_app.content.bakes.record import FILES, publish, seal, text_of
from hall_app.content.folder import Content
from hall_app.room.bake.key import built_key
from hall_app.room.bake.store import BUILT, ENVIRONMENT, GLB, RECORD
from hall_app.room.lighting.charts import surfaces
from hall_app.room.lighting.lamps import spots_of
from hall_app.room.lighting.occluders import exhibit_solids
from hall_app.room.picture.environment import environment_jpeg, seen
from hall_app.room.picture.glb import room_glb
from hall_app.room.raising import raise_room

__all__ = ["bake_room"]

Progress = Callable[[float, str], None]
RAYS = (36, 49, 324)  # direct light and two bounces


def bake_room(
    content: Content,
    *,
    key: str,
    target: Path,
    work: Path,
    data: Path,
    progress: Progress,
    rays: Sequence[int] = RAYS,
) -> dict[str, Any]:
    """Bake the content's room into `target` and return the record kept beside it.

    work: where an interrupted bake left its state and where this one leaves its own; gone after success.
    data: the data folder, where garments' own bakes may lie; rays: per texel and pass of the
    light. Raises MissingFontError where the letters cannot be set.
    """
    began, cpu = time.perf_counter(), time.process_time()
    out = work / "out"
    out.mkdir(parents=True, exist_ok=True)
    progress(0.0, "geometry")
    room = raise_room(content.plan, content.hall.title, content.exhibits, folder=content.folder)
    from hall_app.light import Sampling, bake_light

    walls = surfaces(room.patches, exhibit_solids(content, data))
    light = bake_light(
        walls,
        spots_of(content.plan, content.exhibits),
        Sampling(tuple(rays)),
        progress=lambda share, label: progress(0.02 + 0.93 * share, label),
        checkpoint=work / "light.npz",
    )
    progress(0.96, "files")
    data_glb = room_glb(room, light)
    (out / GLB).write_bytes(data_glb)
    (out / ENVIRONMENT).write_bytes(environment_jpeg(seen(content.plan, walls, light)))
    record = {
        "key": key,
        BUILT: built_key(content.plan),
        "triangles": room.triangles,
        "bytes": len(data_glb),
        "seconds": round(time.perf_counter() - began, 1),
        "cpu_seconds": round(time.process_time() - cpu, 1),
        "light": _plain(light.record),
        FILES: seal(out, RECORD),
    }
    (out / RECORD).write_text(text_of(record), "utf-8")
    publish(out, target, RECORD)
    shutil.rmtree(work, ignore_errors=True)
    progress(1.0, "done")
    return record


def _plain(value: Any) -> Any:
    """The light's record as JSON takes it."""
    if isinstance(value, dict):
        return {str(name): _plain(inner) for name, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(inner) for inner in value]
    return value.item() if isinstance(value, np.generic) else value
