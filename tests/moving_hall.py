"""The hall of plain boxes, whose box moves by a clip; and its check."""

from pathlib import Path

import numpy as np
from plain_hall import write_plain_hall

from sim_core.garment.clip import Clip, Drawn, Moved, drawn_in
from sim_core.gltf import glb_parts

FRAMES, RATE = 50, 25.0


def box_clip(model: bytes, *, drawn: tuple[Drawn, ...] | None = None) -> Clip:
    """The box, swaying once in two seconds."""
    parts = glb_parts(model)
    primitive = parts.document["meshes"][0]["primitives"][0]
    rest = parts.numbers(primitive["attributes"]["POSITION"])
    faces = parts.numbers(primitive["indices"]).reshape(-1, 3).astype(np.int32)
    found = drawn_in(model, {"box": rest})["box"] if drawn is None else drawn
    positions = np.repeat(rest[None], FRAMES, axis=0)
    positions[:, :, 0] += 0.2 * np.sin(2 * np.pi * np.arange(FRAMES) / FRAMES)[:, None] * rest[:, 1]
    return Clip.of([Moved("box", positions, faces, found)], rate=RATE, loop=True)


def write_moving_hall(folder: Path) -> Path:
    """Write the folder and return it."""
    write_plain_hall(folder)
    home = folder / "exhibits" / "box"
    toml = (home / "exhibit.toml").read_text("utf-8")
    toml = toml.replace("models = {", 'motion = "sway.clip"\nmodels = {').replace(', "turn_slowly"', "")
    (home / "exhibit.toml").write_text(toml, "utf-8")
    box_clip((home / "box.glb").read_bytes()).save(home / "sway.clip")
    return folder
