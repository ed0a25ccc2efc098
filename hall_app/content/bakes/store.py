"""Where bakes lie: beside the exhibit (made by `hall build`) or in the data folder (made by `hall serve`)."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from hall_app.content.bakes.key import KEY_DIGITS, bake_key
from hall_app.content.bakes.record import Fault, seal_fault
from hall_app.content.folder import Content, Exhibit

__all__ = [
    "MODELS",
    "NEEDED",
    "RECORD",
    "SCAN",
    "bake_fault",
    "bake_folder",
    "bake_work",
    "baked_here",
    "data_bake",
    "key_now",
    "layer_files",
    "needed",
    "read_record",
]

RECORD = "bake.json"
GARMENT = "garment.npz"  # the outermost layer
MODELS = ("hall.glb", "close.glb")
NEEDED = (GARMENT, *MODELS)  # of an outfit; of a scan the models alone
SCAN = "scan"  # the key of a record that tells of a scan


def layer_files(count: int) -> tuple[str, ...]:
    """File names of the garments of `count` layers, from the skin outwards."""
    return (*(f"beneath-{number}.npz" for number in range(1, count)), GARMENT)


def read_record(folder: Path) -> dict[str, Any] | None:
    """The bake's record, None where there is no complete bake."""
    try:
        record = json.loads((folder / RECORD).read_text("utf-8"))
    except (OSError, ValueError):
        return None
    if not isinstance(record, dict) or not all((folder / name).is_file() for name in needed(record)):
        return None
    return record


def needed(record: dict[str, Any]) -> tuple[str, ...]:
    """The files without which it is no bake."""
    return MODELS if SCAN in record else NEEDED


def bake_fault(folder: Path) -> Fault | None:
    """(file name, what is wrong with it) of a bake whose files are not those that were baked."""
    try:
        told = json.loads((folder / RECORD).read_text("utf-8"))
    except (OSError, ValueError, RecursionError):
        told = {}  # which the seal says
    return seal_fault(folder, RECORD, needed(told if isinstance(told, dict) else {}))


def baked_here(exhibit: Exhibit) -> Path:
    """The exhibit's own bake folder."""
    return exhibit.folder / "baked"


def data_bake(data: Path, exhibit: str, key: str) -> Path:
    """The folder in which the server keeps a bake of its own."""
    return data / "bakes" / f"{exhibit}-{key}"


def bake_work(data: Path, exhibit: str, key: str) -> Path:
    """The folder in which a bake that is under way keeps its state; gone once it has succeeded."""
    return data / "bake-work" / f"{exhibit}-{key}"


def key_now(content: Content, exhibit: Exhibit) -> str | None:
    """The key of a bake of the exhibit's inputs as they are now, None while one of them cannot be read."""
    try:
        return bake_key(content, exhibit)
    except (OSError, ValueError, RecursionError):  # it went away, or was spoilt, after the content was read
        return None


def bake_folder(content: Content, exhibit: Exhibit, data: Path | None, *, stale: bool = True) -> Path | None:
    """The folder of the exhibit's bake: of its present inputs if there is one, else (`stale`) its last one.

    data: the data folder, None to look beside the exhibit alone.
    """
    here, key = baked_here(exhibit), key_now(content, exhibit)
    if key is not None:
        for folder in (here, data_bake(data, exhibit.id, key)) if data is not None else (here,):
            record = read_record(folder)
            if record is not None and record.get("key") == key:
                return folder
    if not stale:
        return None
    last = [folder for folder in (here, *_own_bakes(exhibit, data)) if read_record(folder) is not None]
    return max(last, key=_made, default=None)


def _own_bakes(exhibit: Exhibit, data: Path | None) -> list[Path]:
    """What the server has baked for the exhibit, of whatever inputs."""
    pattern = f"{exhibit.id}-{'[0-9a-f]' * KEY_DIGITS}"
    return [] if data is None else sorted(data_bake(data, "", "").parent.glob(pattern))


def _made(folder: Path) -> int:
    """When the bake's record, its last file, was written [ns]."""
    try:
        return (folder / RECORD).stat().st_mtime_ns
    except OSError:
        return 0
