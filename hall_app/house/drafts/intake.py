"""What is brought from outside: known by what it holds and never by its name, limited, pictures drawn anew.

Drawings are written anew (`drawing`). Film and sound are decoded, and kept without their metadata (`recording`).
"""

from __future__ import annotations

import contextlib
import math
import re
import tempfile
import threading
import unicodedata
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import BinaryIO, TypeVar

from hall_app.content.models.glb import GlbError, read_glb
from hall_app.content.models.pictures import picture_size
from hall_app.house.beside import beside
from hall_app.house.drawing import drawn_anew, redrawn, redrawn_or_refused
from hall_app.house.people import PeopleError
from hall_app.house.recording import Refused, keep

__all__ = ["LARGEST", "USES", "Taken", "take_in"]

T = TypeVar("T")
MB = 1_000_000
LARGEST: Mapping[str, int] = {
    "picture": 40 * MB,
    "drawing": 4 * MB,  # as SVG, which every visitor's browser draws
    "model": 15 * MB,
    "scan": 200 * MB,
    "film": 10 * MB,
    "sound": 10 * MB,
}

# What a file may be used for, and the kinds that serve.
USES: Mapping[str, tuple[str, ...]] = {
    "picture": ("picture",),
    "hall": ("model",),
    "close": ("model",),
    "scan": ("model", "scan"),
    "film": ("film",),
    "sound": ("sound", "film"),
}
_WITHIN = 90.0  # [s] that film or sound may take to be read, and encoded where it has to be
_AT_ONCE = 200_000  # [bytes] of a drawing that is written anew within a second
_PIXELS_AT_ONCE = 2_000_000  # of all pictures in it
_DRAWN_WITHIN = 60.0  # [s] that a larger one may take
_READING = threading.BoundedSemaphore(2)  # who waits keeps a thread, and there are few
_ARCHIVES = (
    b"PK\x03\x04",
    b"PK\x05\x06",
    b"\x1f\x8b",
    b"7z\xbc\xaf",
    b"Rar!",
    b"BZh",
    b"\xfd7zXZ",
    b"\x28\xb5\x2f\xfd",
)
_DRAWING = re.compile(rb"<(?:[\w-]+:)?svg|^\W*<(?:\?xml|!--)", re.IGNORECASE)
_OBJ = re.compile(rb"(#.*|(v|vt|vn|vp|f|l|p|o|g|s|mtllib|usemtl)( .*)?|)\r?")


@dataclass(frozen=True)
class Taken:
    """kind: of USES' values; name: safe, with the ending of what it holds; told: what is known of it, for the page."""

    kind: str
    name: str
    data: bytes
    told: str


def take_in(name: str, file: BinaryIO, size: int, use: str) -> Taken:
    """Read what was brought for one of USES. name: as it was called, for messages and the stem. Raises PeopleError."""
    shown = "".join(c for c in name if c.isprintable())[-80:] or "?"
    file.seek(0)
    kind, ending = _kind(shown, file.read(4096), use)
    if kind not in USES.get(use, ()):
        raise PeopleError("file-use", name=shown, kind=kind)
    kind = use if use in ("scan", "sound") else kind
    limited = "drawing" if ending == ".svg" else kind
    _check_size(shown, limited, size)
    file.seek(0)
    data = file.read(LARGEST[limited] + 1)
    told = ""
    if ending == ".svg":
        data, told = _drawing(shown, data)
    elif kind == "picture":
        data, ending, told = drawn_anew(shown, data)
    elif ending == ".glb":
        told = _model(shown, data)
    elif kind in ("film", "sound"):
        data, ending, told = _recording(shown, data, ending, kind)
    return Taken(kind, _safe(name, kind) + ending, data, told)


def _check_size(shown: str, kind: str, size: int) -> None:
    """kind: of LARGEST's. Raises PeopleError."""
    if size > LARGEST[kind]:
        raise PeopleError("file-size", name=shown, kind=kind, most=LARGEST[kind] // MB)


def _kind(shown: str, head: bytes, use: str) -> tuple[str, str]:
    """(kind, ending) by the first bytes. Raises PeopleError."""
    if head.startswith(b"glTF"):
        return "model", ".glb"
    if head.startswith((b"\xff\xd8\xff", b"\x89PNG\r\n\x1a\n", b"II*\0", b"MM\0*")):
        return "picture", ""
    if head.startswith(b"RIFF"):
        if head[8:12] == b"WEBP":
            return "picture", ""
        if head[8:12] == b"WAVE":
            return "sound", ".wav"
    if head.startswith(b"\x1a\x45\xdf\xa3"):
        return "film", ".webm"
    if head[4:8] == b"ftyp":
        return ("sound", ".m4a") if head[8:11] == b"M4A" else ("film", ".mp4")
    if head.startswith(b"OggS"):
        return "sound", ".ogg"
    if head.startswith(b"ID3") or (len(head) > 1 and head[0] == 0xFF and head[1] & 0xE6 == 0xE2):
        return "sound", ".mp3"
    if head.startswith((b"ply\n", b"ply\r")):
        return "scan", ".ply"
    if head.startswith(_ARCHIVES):
        raise PeopleError("file-archive", name=shown)
    # A picture by what follows the XML's head, which may be long; sixteen bits a character count as eight.
    if _DRAWING.search(head.replace(b"\0", b"")):
        return "picture", ".svg"
    lines = head.split(b"\n")[:-1] if len(head) == 4096 else head.split(b"\n")
    if use == "scan" and any(line.startswith(b"v ") for line in lines) and all(map(_OBJ.fullmatch, lines)):
        return "scan", ".obj"
    raise PeopleError("file-kind", name=shown)


def _model(shown: str, data: bytes) -> str:
    """Raises PeopleError for a GLB that the hall cannot draw, or that holds more than it says."""
    if int.from_bytes(data[8:12], "little") != len(data):
        raise PeopleError("file-broken", name=shown, why="its length is not what its head says")
    with tempfile.NamedTemporaryFile(suffix=".glb") as file:
        file.write(data)
        file.flush()
        try:
            info = read_glb(Path(file.name))
        except GlbError as error:
            raise PeopleError("file-broken", name=shown, why=str(error)) from None
    size = " × ".join(f"{high - low:.2f}" for low, high in zip(info.low, info.high, strict=True))
    return f"{info.triangles} △ · {size} m · {len(data) / MB:.2f} MB"


class _LargerError(Exception):
    """Few bytes, but pictures of many pixels."""


def _drawing(shown: str, data: bytes) -> tuple[bytes, str]:
    """Written anew; a large one where it holds nobody up. Raises PeopleError."""
    left = _PIXELS_AT_ONCE

    def small(name: str, given: bytes) -> tuple[bytes, str, str]:
        nonlocal left
        left -= math.prod(picture_size(given))
        if left < 0:
            raise _LargerError
        return drawn_anew(name, given)

    if len(data) <= _AT_ONCE:
        with contextlib.suppress(_LargerError):
            return redrawn(shown, data, small, LARGEST["drawing"])
    late = PeopleError("file-svg-drawn", name=shown)
    return _read_beside(shown, late, _DRAWN_WITHIN, redrawn_or_refused, shown, data, LARGEST["drawing"])


def _recording(shown: str, data: bytes, ending: str, kind: str) -> tuple[bytes, str, str]:
    """What is kept of a film or sound. Raises PeopleError."""
    late = PeopleError("file-slow", name=shown, seconds=int(_WITHIN))
    with tempfile.TemporaryDirectory(prefix="hall-") as folder:
        source, target = Path(folder, f"source{ending}"), Path(folder, "target")
        source.write_bytes(data)
        found = _read_beside(shown, late, _WITHIN, keep, str(source), str(target), ending, kind)
        _check_size(shown, kind, target.stat().st_size)
        return target.read_bytes(), found.ending, found.told


def _read_beside(
    shown: str, late: PeopleError, within: float, act: Callable[..., T | Refused], *given: object
) -> T:
    """What act gives in a process of its own, of which there are few. late: the refusal where it takes longer than
    within [s]. Raises PeopleError."""
    if not _READING.acquire(blocking=False):
        raise PeopleError("too-often", seconds=10)
    try:
        found = beside(act, *given, within=within)
    finally:
        _READING.release()
    if found is None:
        raise late
    if isinstance(found, Refused):
        raise PeopleError(found.key, **{"name": shown, **found.facts})
    return found


def _safe(name: str, kind: str) -> str:
    """A stem of a-z, 0-9 and hyphens."""
    stem = PurePosixPath(name.replace("\\", "/").replace("\0", "")).name.partition(".")[0]
    plain = unicodedata.normalize("NFKD", stem).encode("ascii", "ignore").decode().lower()
    return re.sub("[^a-z0-9]+", "-", plain).strip("-")[:40].strip("-") or kind
