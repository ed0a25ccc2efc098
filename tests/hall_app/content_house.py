"""A small, good content folder for tests, and ways to spoil it."""

from __future__ import annotations

import json
import struct
import zlib
from collections.abc import Callable
from pathlib import Path

import trimesh
from PIL import Image

HALL = """
title = { zh = "厅", en = "Hall" }
subtitle = { zh = "试", en = "For tests" }
licence = "CC0-1.0"
[start]
x = 0.0
z = 3.0
"""
PLAN = """
outline = [[-5, -5], [5, -5], [5, 5], [-5, 5]]
[[wall]]
from = [-5, -3]
to = [1, -3]
[[solid]]
id = "booth"
kind = "booth"
size = [2, 1]
at = [-3, 0]
facing = 90
height = 0.2
[[solid]]
id = "post"
kind = "column"
round = { x = 3, z = 0, radius = 0.3 }
height = 3
[[bay]]
id = "all"
name = { zh = "全", en = "All" }
polygon = [[-5, -5], [5, -5], [5, 5], [-5, 5]]
"""
EXHIBIT = """
title = { zh = "箱", en = "Chest" }
behaviours = ["open_on_click", "glow_when_near"]
licence = "CC0-1.0"
[place]
x = 0.0
z = -1.0
[models]
hall = "media/chest.glb"
[body]
shape = "round"
radius = 0.4
[[media]]
kind = "picture"
file = "media/front.jpg"
alt = { zh = "正面", en = "The front" }
"""

OUTFIT = """
title = { zh = "帔", en = "Scarf" }
[stand]
[[layer]]
pattern = "patterns/pibo.toml"
weave = "weaves/gauze.toml"
seed = 1
"""
ASSETS = Path(__file__).parents[2] / "assets"


def make_house(folder: Path) -> Path:
    """Write a content folder without a problem: one hall, one plan, one exhibit "chest"."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "hall.toml").write_text(HALL, "utf-8")
    (folder / "plan.toml").write_text(PLAN, "utf-8")
    add_exhibit(folder, "chest")
    return folder


def add_exhibit(folder: Path, identity: str, toml: str = EXHIBIT) -> Path:
    """Add an exhibit with a box for a model; returns its folder."""
    home = folder / "exhibits" / identity
    (home / "media").mkdir(parents=True)
    (home / "exhibit.toml").write_text(toml, "utf-8")
    (home / "text.zh.md").write_text("一只箱子。", "utf-8")
    (home / "text.en.md").write_text("A chest.", "utf-8")
    write_box(home / "media/chest.glb")
    Image.new("RGB", (8, 8), "#7a4b2e").save(home / "media/front.jpg")
    return home


def write_outfit(folder: Path, *, more: str = "") -> Path:
    """Write outfits/scarf.toml, a scarf over a stand, and the files it names; more: further keys of its layer."""
    for name in ("patterns/pibo.toml", "weaves/gauze.toml"):
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_bytes((ASSETS / name).read_bytes())
    path = folder / "outfits/scarf.toml"
    path.parent.mkdir(exist_ok=True)
    path.write_text(OUTFIT + more, "utf-8")
    return path


def dressed(house: Path, identity: str = "chest") -> Path:
    """Give an exhibit an outfit that is not baked in place of its model; returns the outfit's file."""
    toml = house / "exhibits" / identity / "exhibit.toml"
    edit(toml, '[models]\nhall = "media/chest.glb"\n', "")
    edit(toml, "behaviours", 'outfit = "outfits/scarf.toml"\nbehaviours')
    (house / "exhibits" / identity / "media/chest.glb").unlink()
    return write_outfit(house)


def write_box(path: Path, *, height: float = 0.8, scale: float = 1.0, foot: float = 0.0) -> None:
    """A box 0.5 x height x 0.5 m with its foot at y = `foot`, all times `scale`."""
    box = trimesh.creation.box((0.5 * scale, height * scale, 0.5 * scale))
    box.apply_translation([0, (foot + height / 2) * scale, 0])
    data = trimesh.Scene(box).export(file_type="glb")
    assert isinstance(data, bytes)
    path.write_bytes(data)


def edit(path: Path, old: str, new: str) -> None:
    """Replace `old`, which must be there, in a text file."""
    text = path.read_text("utf-8")
    assert old in text, f"{old!r} is not in {path.name}"
    path.write_text(text.replace(old, new), "utf-8")


def rewritten(house: Path, change: Callable[[dict], object], more: bytes = b"") -> Path:
    """Rewrite the chest's GLB with a changed JSON part, `more` behind its binary part; returns its path."""
    path = house / "exhibits/chest/media/chest.glb"
    data = path.read_bytes()
    size = struct.unpack_from("<I", data, 12)[0]
    document = json.loads(data[20 : 20 + size])
    change(document)
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    binary = data[28 + size :] + more
    binary += bytes(-len(binary) % 4)
    rest = struct.pack("<II", len(binary), 0x004E4942) + binary
    head = struct.pack("<IIIII", 0x46546C67, 2, 20 + len(text) + len(rest), len(text), 0x4E4F534A)
    path.write_bytes(head + text + rest)
    return path


def with_texture(house: Path, picture: bytes) -> Path:
    """Give the chest's GLB an image that no material shows."""

    def add(document: dict) -> None:
        views = document["bufferViews"]
        start = max(view.get("byteOffset", 0) + view["byteLength"] for view in views)
        views.append({"buffer": 0, "byteOffset": start, "byteLength": len(picture)})
        document["images"] = [{"bufferView": len(views) - 1, "mimeType": "image/png"}]

    return rewritten(house, add, picture)


def png_of(width: int, height: int, rows: int = 0) -> bytes:
    """A black and white PNG that says it has so many pixels, and holds the first `rows` of them."""
    head = b"IHDR" + struct.pack(">IIBBBBB", width, height, 1, 0, 0, 0, 0)
    body = b"IDAT" + zlib.compress(bytes(rows * (1 + -(-width // 8))))
    chunks = [
        struct.pack(">I", len(c) - 4) + c + struct.pack(">I", zlib.crc32(c)) for c in (head, body, b"IEND")
    ]
    return b"\x89PNG\r\n\x1a\n" + b"".join(chunks)
