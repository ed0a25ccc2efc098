"""A model or a scan as a page turns it: few triangles, with the colours of its pictures at their corners."""

from __future__ import annotations

import os
import struct
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from sim_core.mesh.scan import Scan

__all__ = ["MOST_TURNED", "few", "mesh_of", "shape"]

MOST_TURNED = 60_000  # triangles that are sent
_FINEST = 384  # cells along the longest side, of those that corners are drawn together in
_GREY = 190
_PLACES = np.array([1, 1 << 20, 1 << 40])  # three small whole numbers as one
# What an OBJ or PLY names beside itself, and does not come with it.
_BESIDE = ((b"mtllib", b"#tllib"), (b"comment TextureFile", b"comment textureless"))


def shape(path: Path, ending: str) -> bytes:
    """Little-endian: b"HDSH", how many corners, triangles, and triangles of the file (uint32 each); positions (V, 3)
    float32 in the file's axes, normals (V, 4) int8 and colours (V, 4) uint8 sRGB with a fourth for nothing, triangles
    (F, 3) uint32. ending: of what the file holds, ".glb", ".ply" or ".obj". Raises what foreign files bring about.
    """
    from sim_core.picture import normals

    scan = mesh_of(path, ending)
    vertices, faces, colours = few(scan)
    turned = np.zeros((len(vertices), 4), np.int8)
    turned[:, :3] = np.round(normals(vertices, faces) * 127)
    tinted = np.full((len(vertices), 4), 255, np.uint8)
    tinted[:, :3] = np.round(colours)
    head = struct.pack("<4sIII", b"HDSH", len(vertices), len(faces), len(scan.faces))
    parts = (vertices.astype("<f4"), turned, tinted, faces.astype("<u4"))
    return head + b"".join(part.tobytes() for part in parts)


def mesh_of(path: Path, ending: str) -> Scan:
    """What the file holds; of an OBJ or PLY whose pictures are not there, its form alone. Raises ScanError, OSError."""
    from sim_core.mesh.scan import ScanError, read_scan

    with tempfile.TemporaryDirectory() as folder:
        named = Path(folder) / f"scan{ending}"  # drafts are called by their digests
        os.symlink(path.absolute(), named)
        try:
            return read_scan(named, Path(folder))
        except ScanError:
            data = path.read_bytes()
            plain = data
            for name, other in _BESIDE if ending != ".glb" else ():
                plain = plain.replace(name, other)
            if plain == data:
                raise
            named.unlink()
            named.write_bytes(plain)
            return read_scan(named, Path(folder))


def few(scan: Scan) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Corners (V, 3), triangles (F, 3), MOST_TURNED at most, and the corners' colours (V, 3) sRGB 0..255."""
    return _fewer(scan.vertices, scan.faces, _colours(scan), MOST_TURNED)


def _colours(scan: Scan) -> np.ndarray:
    """(V, 3) sRGB 0..255: each corner's, from the pictures where there are some, the mean of its faces'."""
    if scan.colours is not None:
        return scan.colours.astype(float)
    total, count = np.zeros((len(scan.vertices), 3)), np.zeros(len(scan.vertices))
    for number, picture in enumerate(scan.pictures):
        mine = scan.picture == number
        corners = scan.faces[mine].ravel()
        high, wide = picture.shape[:2]
        if scan.uv is None or high * wide == 1:
            seen = np.broadcast_to(picture.reshape(-1, 3).mean(axis=0), (len(corners), 3))
        else:
            uv = np.nan_to_num(scan.uv[mine].reshape(-1, 2)) % 1.0
            column, row = (uv * (wide, high)).astype(int).T
            seen = picture[np.minimum(row, high - 1), np.minimum(column, wide - 1)].astype(float)
        for channel in range(3):
            total[:, channel] += np.bincount(corners, seen[:, channel], len(total))
        count += np.bincount(corners, minlength=len(count))
    return np.where(count[:, None] > 0, total / np.maximum(count, 1)[:, None], _GREY)


def _fewer(
    vertices: np.ndarray, faces: np.ndarray, colours: np.ndarray, most: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """At most so many triangles: corners that share a cell become one, in cells as fine as that allows."""
    kept = np.asarray(np.isfinite(vertices).all(axis=1))
    faces = faces[np.asarray(kept[faces].all(axis=1))]
    vertices = np.where(kept[:, None], vertices, 0.0)
    used = np.unique(faces)
    low = vertices[used].min(axis=0) if len(used) else np.zeros(3)
    side = float(np.ptp(vertices[used], axis=0).max()) if len(used) else 0.0
    cells, found = float(_FINEST), (vertices, faces, colours)
    while len(found[1]) > most and side > 0 and cells > 2:
        key = np.floor((vertices - low) * (cells / side)).astype(np.int64) @ _PLACES
        if len(np.unique(key)) <= most / 2:  # a closed surface has two triangles a corner
            found = _clustered(vertices, faces, colours, key)
        cells *= 0.8
    return found


def _clustered(
    vertices: np.ndarray, faces: np.ndarray, colours: np.ndarray, key: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """key: (V,) of the cell that each corner lies in."""
    _, first, group = np.unique(key, return_index=True, return_inverse=True)
    number = np.bincount(group)[:, None]

    def mean(values: np.ndarray) -> np.ndarray:
        return np.stack([np.bincount(group, column, len(first)) for column in values.T], axis=1) / number

    merged = group[faces]
    a, b, c = merged.T
    merged = merged[(a != b) & (b != c) & (c != a)]
    _, once = np.unique(np.sort(merged, axis=1) @ _PLACES, return_index=True)
    return mean(vertices), merged[np.sort(once)], mean(colours)
