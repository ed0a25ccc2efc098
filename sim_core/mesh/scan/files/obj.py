"""A scan from an OBJ, with the material files and pictures that lie beside it."""

from __future__ import annotations

import mmap
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sim_core.mesh.scan.files.beside import companion
from sim_core.mesh.scan.files.pictures import decoded, plain
from sim_core.mesh.scan.scan import MOST_TRIANGLES, Scan, ScanError

__all__ = ["obj_libraries", "obj_pictures", "read_obj_scan"]

LIBRARY = re.compile(rb"(?m)^[ \t]*mtllib[ \t]+([^\r\n]+)")
USE = re.compile(rb"(?m)^[ \t]*usemtl[ \t]+([^\r\n]+)")
# Options of map_Kd that a scan's picture may have ahead of its name, and how many words each takes.
OPTIONS = {"-o": 3, "-s": 3, "-t": 3, "-mm": 2, "-bm": 1, "-blendu": 1, "-blendv": 1, "-cc": 1, "-clamp": 1}


@dataclass
class _Material:
    """Its colour (3,), linear, and the picture it names."""

    colour: np.ndarray
    picture: str = ""


def obj_libraries(path: Path) -> tuple[str, ...]:
    """Names of the material files that an OBJ tells of. Raises OSError."""
    with path.open("rb") as file:
        if path.stat().st_size == 0:
            return ()
        with mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as text:
            if text.find(b"mtllib") < 0:
                return ()
            return tuple(
                dict.fromkeys(found[1].decode("utf-8", "replace").strip() for found in LIBRARY.finditer(text))
            )


def obj_pictures(library: Path) -> tuple[str, ...]:
    """Names of the pictures that a material file tells of. Raises OSError."""
    return tuple(
        dict.fromkeys(one.picture for one in _materials(library.read_bytes()).values() if one.picture)
    )


def read_obj_scan(path: Path, root: Path) -> Scan:
    """The scan in an OBJ whose companions lie beneath `root`. Raises ScanError naming the fault, OSError."""
    from sim_core.mesh.scan.files.obj_lines import counted, filled  # compiled

    text = np.fromfile(path, np.uint8)
    many, places, triangles = (int(number) for number in counted(text))
    if triangles == 0:
        raise ScanError("it holds no triangles", "mesh it in the scanning software, and export its faces")
    if triangles > MOST_TRIANGLES:
        what = f"it has {triangles} triangles, at most {MOST_TRIANGLES}"
        raise ScanError(what, "decimate it in the scanning software")
    vertices, pairs = np.zeros((many, 6)), np.zeros((places, 2))
    faces, corners = np.zeros((triangles, 3), np.int32), np.zeros((triangles, 3), np.int32)
    start = np.zeros(triangles, np.int64)
    wrong = int(filled(text, vertices, pairs, faces, corners, start))
    if wrong >= 0:
        line = int(np.count_nonzero(text[:wrong] == 10)) + 1
        shown = text[wrong : wrong + 40].tobytes().decode("utf-8", "replace").splitlines()[0]
        raise ScanError(f"it is cut off or damaged in line {line}, {shown!r}", "copy or export it again")
    colours = None
    if np.isfinite(vertices[:, 3:]).all() and len(vertices):
        colours = np.rint(255 * np.clip(vertices[:, 3:], 0, 1)).astype(np.uint8)
    number, pictures = _looks(path, root, text, start, colours is not None)
    uv = None
    if places:
        inside = np.maximum(corners, 0)
        uv = np.stack([pairs[inside, 0], 1 - pairs[inside, 1]], axis=-1).astype(np.float32)
    return Scan(vertices[:, :3].copy(), faces, uv, number, pictures, colours)


def _looks(
    path: Path, root: Path, text: np.ndarray, start: np.ndarray, painted: bool
) -> tuple[np.ndarray, tuple[np.ndarray, ...]]:
    """Which picture each face has, and the pictures; painted: whether vertices have colours."""
    known: dict[str, _Material] = {}
    for name in obj_libraries(path):
        known |= _materials(companion(path, name, root))
    uses = list(_uses(text))
    names = ["", *(name for _, name in uses)]
    which = np.searchsorted([at for at, _ in uses], start)
    used = [names[number] for number in np.unique(which)]
    textured = sum(1 for name in dict.fromkeys(used) if name in known and known[name].picture)
    pictures: list[np.ndarray] = []
    place: dict[str, int] = {}
    for name in dict.fromkeys(used):
        material = known.get(name)
        if material is not None and material.picture:
            data = companion(path, material.picture, root)
            place[name] = len(pictures)
            pictures.append(decoded(data, material.picture, 1 / textured))
        elif not painted:
            place[name] = len(pictures)
            pictures.append(plain(np.full(3, 0.5) if material is None else material.colour))
    of_name = np.array([place.get(name, -1) for name in names], np.int16)
    return of_name[which], tuple(pictures)


def _uses(text: np.ndarray) -> Iterator[tuple[int, str]]:
    """(byte, material) of every usemtl."""
    for found in USE.finditer(text.data):
        yield found.start(), found[1].decode("utf-8", "replace").strip()


def _materials(data: bytes) -> dict[str, _Material]:
    found: dict[str, _Material] = {}
    for line in data.decode("utf-8-sig", "replace").splitlines():
        words = line.split(None, 1)  # by spaces or tabs
        key, rest = (words[0], words[1]) if len(words) == 2 else ("", "")
        if key == "newmtl":
            found[rest.strip()] = _Material(np.full(3, 0.5))
        elif key == "Kd" and found:
            try:
                found[next(reversed(found))].colour = np.array([float(word) for word in rest.split()[:3]])
            except ValueError:
                continue  # a spectral curve: the grey stays
        elif key == "map_Kd" and found:
            found[next(reversed(found))].picture = _picture_name(rest)
    return found


def _picture_name(rest: str) -> str:
    words = rest.split()
    while words and words[0] in OPTIONS:
        words = words[1 + OPTIONS[words[0]] :]
    return rest.strip() if words == rest.split() else " ".join(words)
