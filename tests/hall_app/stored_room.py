"""A small room stored as `hall build --room` stores one, for tests that need no light of their own."""

from __future__ import annotations

import json
from pathlib import Path

from lit_room import lit_room
from PIL import Image

from hall_app.content.bakes import FILES, seal
from hall_app.content.models import read_glb


def store_room(folder: Path, key: str, **record: object) -> Path:
    """Write GLB, environment and record of that key into `folder`, which is returned."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "room.glb").write_bytes(lit_room())
    Image.new("RGB", (16, 8), "#b0a898").save(folder / "environment.jpg")
    triangles = read_glb(folder / "room.glb").triangles - 1
    facts = {"key": key, "triangles": triangles, **record, FILES: seal(folder, "room.json")}
    (folder / "room.json").write_text(json.dumps(facts), "utf-8")
    return folder
