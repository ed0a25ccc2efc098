"""The room: is its baked picture whole, does it fit the plan, does it stay within what a visitor is asked to load?"""

from __future__ import annotations

import io
from pathlib import Path

from hall_app.content.folder import Content
from hall_app.content.models.glb import GlbInfo, open_glb, read_glb
from hall_app.content.models.pictures import picture_fault
from hall_app.content.problems import Problem
from hall_app.room.bake.key import room_key
from hall_app.room.bake.store import ENVIRONMENT, GLB, RECORD, room_fault, room_here, room_record
from sim_core.gltf import GlbError, GlbParts

MB = 1_000_000
TRIANGLES, BYTES = 40_000, 1.8 * MB
FIX = "run: hall build --room"
LIGHT, MESH = "lightmap", "hall_"  # names of the meshes that bear the light and the room


def room_problems(content: Content) -> list[Problem]:
    """A baked room that is broken, no longer fits the plan, or is too heavy; one that is not baked is drawn even."""
    folder = room_here(content.folder)
    if not folder.is_dir():
        return []
    if fault := room_fault(folder) or _unopened(folder):
        return [Problem(f"room/{fault[0]}", "", fault[1], FIX)]
    record = room_record(folder) or {}
    found = []
    if record.get("key") != room_key(content):
        what = "the baked room is stale: the plan, a title, a place, a model or the engine changed since"
        found.append(Problem("plan.toml", "", what, FIX))
    info = read_glb(folder / GLB)
    if record.get("triangles") != info.triangles - 1:  # the light map's own triangle is not the room's
        what = f"it tells of {record.get('triangles')!r} triangles, {GLB} has {info.triangles - 1}"
        found.append(Problem(f"room/{RECORD}", "triangles", what, FIX))
    return found + _weight(info)


def _weight(info: GlbInfo) -> list[Problem]:
    found, fix = [], "take windows, lattice walls, curtains or hung pictures out"
    if info.triangles > TRIANGLES:
        what = f"the room has {info.triangles} triangles, at most {TRIANGLES}"
        found.append(Problem("plan.toml", "", what, fix))
    if info.size > BYTES:
        what = f"the room has {info.size / MB:.2f} MB, at most {BYTES / MB:g} MB"
        found.append(Problem("plan.toml", "", what, fix))
    return found


def _unopened(folder: Path) -> tuple[str, str] | None:
    """(file name, what is wrong) of the first file of the room that cannot be shown, whatever its record says."""
    try:
        read_glb(folder / GLB)
        parts = open_glb(folder / GLB)
    except (GlbError, OSError) as error:
        return GLB, f"cannot be opened: {error}"
    names = [str(mesh.get("name", "")) for mesh in parts.document["meshes"]]
    if names.count(LIGHT) != 1 or not any(name.startswith(MESH) for name in names):
        return GLB, f"is no baked room: it has no meshes {MESH}… with a {LIGHT}"
    if fault := _texture_fault(parts):
        return GLB, fault
    if fault := picture_fault(folder / ENVIRONMENT):
        return ENVIRONMENT, f"cannot be shown: {fault[0]}"
    return None


def _texture_fault(parts: GlbParts) -> str | None:
    """What is wrong with the first texture that cannot be decoded."""
    from PIL import Image

    for number, data in enumerate(parts.pictures(), 1):
        try:
            with Image.open(io.BytesIO(data)) as picture:
                picture.load()
        except Exception as error:  # a decoder of foreign files may fail in any way
            return f"its texture {number} cannot be shown ({error})"[:200]
    return None
