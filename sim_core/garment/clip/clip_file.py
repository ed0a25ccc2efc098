"""A clip's bytes: a mark, a header's length and checksum, the header, what is the same in all frames, the frames.

    HALLCLIP  uint32 length  uint32 crc32  {"format": 1, "sizes": [still, frame 0, …], …}  still  frame 0  frame 1  …

Numbers are little endian. The still part and each frame are deflated by themselves (zlib, so that damage is found). The
still part holds, in this order, whole numbers as differences down each column, zigzag, four planes of bytes: the code's
order (V,) and sources (V, 3); of each mesh its faces (F, 3) and, of what is drawn of it, the index (P,); of the figure
faces and indices likewise, then heads (21, 3) and rest (B, 3) as float32 and weights (B, 21) as 1/65535 (uint16). A
frame: `frame_code`, then of the figure 21 quaternions and a shift as float32. hall_app/page/look/clip reads the same.
"""

from __future__ import annotations

import json
import struct
import zlib
from dataclasses import dataclass
from typing import Any

import numpy as np

from sim_core.body import JOINTS, LINEAR_JOINTS, PARENTS, SKINS
from sim_core.errors import SimCoreError
from sim_core.garment.clip.drawn import Drawn
from sim_core.garment.clip.frame_code import LEVEL, STEP, FrameCode, inflated, zigzag
from sim_core.garment.clip.skinned import WHOLE, Skinned

__all__ = ["LARGEST", "POSE", "Contents", "MeshEntry", "bones_bytes", "check_size", "read", "written"]

FORMAT = 1
MARK = b"HALLCLIP"
POSE = 4 * (4 * len(JOINTS) + 3)  # [bytes] of a pose
MOST_VERTICES, MOST_FRAMES = 1_000_000, 100_000
LARGEST = 256_000_000  # [bytes] of all frames once unpacked: 100 s of 15 000 vertices
LARGEST_STILL = 64_000_000  # [bytes] likewise of what is the same in all frames
FURTHEST = 1e6  # [m]
REMEDY = "bake it again"


@dataclass(frozen=True)
class MeshEntry:
    """A mesh that goes by its vertices: name, count of vertices, faces (F, 3) int32, what of a model goes with it."""

    name: str
    count: int
    faces: np.ndarray
    drawn: tuple[Drawn, ...] = ()


@dataclass(frozen=True)
class Contents:
    """What a file holds beside its frames; a figure that was read has no poses yet."""

    code: FrameCode
    meshes: tuple[MeshEntry, ...]
    figure: Skinned | None
    rate: float
    loop: bool
    error: float


def written(contents: Contents, frames: list[bytes]) -> bytes:
    """The file's bytes."""
    code, figure = contents.code, contents.figure
    still = zlib.compress(_still(contents), LEVEL)
    header = {
        "format": FORMAT,
        "rate": contents.rate,
        "loop": contents.loop,
        "error": contents.error,
        "origin": code.origin.tolist(),
        "step": code.step,
        "meshes": [_told(mesh.name, mesh.count, mesh.faces, mesh.drawn) for mesh in contents.meshes],
        "figure": figure
        and _told(figure.name, len(figure.rest), figure.faces, figure.drawn)
        | {"skin": figure.skin, "parents": PARENTS, "linear": LINEAR_JOINTS[figure.skin]},
        "sizes": [len(part) for part in (still, *frames)],
    }
    text = json.dumps(header, ensure_ascii=False, separators=(",", ":")).encode()
    return b"".join((MARK, struct.pack("<II", len(text), zlib.crc32(text)), text, still, *frames))


def bones_bytes(figure: Skinned) -> int:
    """What a figure takes by its bones, in all frames; its faces, which any mesh has, left out."""
    still = figure.rest.astype("<f4").tobytes() + np.round(figure.weights * WHOLE).astype("<u2").tobytes()
    return len(zlib.compress(still, LEVEL)) + POSE * figure.frames


def _told(name: str, count: int, faces: np.ndarray, drawn: tuple[Drawn, ...]) -> dict[str, Any]:
    nodes = [{"node": one.node, "vertices": len(one.index)} for one in drawn]
    return {"name": name, "vertices": count, "faces": len(faces), "drawn": nodes}


def _still(contents: Contents) -> bytes:
    parts = [_whole_numbers(contents.code.order), _whole_numbers(contents.code.sources)]
    figure = contents.figure
    for mesh in (*contents.meshes, *((figure,) if figure else ())):
        parts += [_whole_numbers(mesh.faces), *(_whole_numbers(one.index) for one in mesh.drawn)]
    if figure is not None:
        parts += [figure.heads.astype("<f4").tobytes(), figure.rest.astype("<f4").tobytes()]
        parts.append(np.round(figure.weights * WHOLE).astype("<u2").tobytes())
    return b"".join(parts)


def _whole_numbers(array: np.ndarray) -> bytes:
    """(N,) or (N, 3) whole numbers as differences down each column, zigzag, in four planes of bytes."""
    rows = array.reshape(len(array), -1).astype(np.int32)
    apart = zigzag(np.diff(rows, axis=0, prepend=np.zeros((1, rows.shape[1]), np.int32)))
    return b"".join(((apart >> shift) & 255).astype(np.uint8).tobytes() for shift in (0, 8, 16, 24))


class _Reader:
    """Takes arrays from the still part, one after the other."""

    def __init__(self, data: bytes) -> None:
        self.data, self.at = data, 0

    def take(self, size: int) -> bytes:
        self.at += size
        return self.data[self.at - size : self.at]

    def whole_numbers(self, rows: int, columns: int, below: int, what: str) -> np.ndarray:
        """(N, columns) int32, each of 0 to below - 1."""
        planes = np.frombuffer(self.take(4 * rows * columns), np.uint8).reshape(4, rows, columns)
        apart = sum(planes[k].astype(np.uint32) << np.uint32(8 * k) for k in range(4))
        apart = np.asarray(apart, np.uint32).astype(np.int64)
        found = np.cumsum((apart >> 1) ^ -(apart & 1), axis=0)
        if found.size and not (found.min() >= 0 and found.max() < below):
            raise SimCoreError(f"clip: {what} names vertices beyond the {below} there are – {REMEDY}")
        return found.astype(np.int32)

    def drawn(self, told: dict[str, Any]) -> tuple[Drawn, ...]:
        """The indices of what is drawn of a mesh."""
        return tuple(
            Drawn(
                str(one["node"]), self.whole_numbers(one["vertices"], 1, told["vertices"], one["node"])[:, 0]
            )
            for one in told["drawn"]
        )


def read(data: bytes) -> tuple[Contents, list[bytes]]:
    """What a file holds, and its frames, packed; raises SimCoreError on what is damaged, cut off or something else."""
    if data[: len(MARK)] != MARK or len(data) < len(MARK) + 8:
        raise SimCoreError("clip: not a clip – give a file that Clip.save wrote")
    begin = len(MARK) + 8
    length, checksum = struct.unpack_from("<II", data, len(MARK))
    if zlib.crc32(data[begin : begin + length]) != checksum:
        raise SimCoreError(f"clip: its header is damaged or cut off – {REMEDY}")
    try:
        header = json.loads(data[begin : begin + length].decode())
        if not isinstance(header, dict) or header.get("format") != FORMAT:
            raise SimCoreError(f"clip: written in another format – {REMEDY}")
        still, frames = _parts(header["sizes"], data, begin + length)
        return _contents(header, still), frames
    except SimCoreError:
        raise
    except (KeyError, IndexError, TypeError, ValueError, OverflowError, RecursionError) as error:
        raise SimCoreError(
            f"clip: its header is damaged ({type(error).__name__}: {error}) – {REMEDY}"
        ) from error


def _parts(sizes: list[int], data: bytes, at: int) -> tuple[bytes, list[bytes]]:
    if not 2 <= len(sizes) <= MOST_FRAMES + 1 or not all(_is_count(size, len(data)) for size in sizes):
        raise SimCoreError(f"clip: its header is damaged (sizes) – {REMEDY}")
    ends = [at, *(int(at + total) for total in np.cumsum(sizes))]
    if ends[-1] != len(data):
        raise SimCoreError(f"clip: {len(data)} bytes of {ends[-1]} – copy it again")
    still, *frames = (data[a:b] for a, b in zip(ends, ends[1:], strict=False))
    return still, frames


def _is_count(value: object, most: int) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and 0 < value <= most


def _contents(header: dict[str, Any], still: bytes) -> Contents:
    """Raises what an inconsistent header brings about, or SimCoreError."""
    meshes, figure = header["meshes"], header["figure"]
    told = [*meshes, *([figure] if figure else [])]
    for mesh in told:
        counts = [mesh["vertices"], mesh["faces"], *(one["vertices"] for one in mesh["drawn"])]
        if not all(_is_count(count, 4 * MOST_VERTICES) for count in counts):
            raise SimCoreError(f"clip: its header is damaged (counts of {mesh['name']!r}) – {REMEDY}")
    if len({mesh["name"] for mesh in told}) != len(told) or not meshes:
        raise SimCoreError(f"clip: its header is damaged (meshes) – {REMEDY}")
    count, beside = sum(mesh["vertices"] for mesh in meshes), POSE if figure else 0
    check_size(count, len(header["sizes"]) - 1, beside)
    whole = 16 * count + sum(
        4 * (3 * mesh["faces"] + sum(one["vertices"] for one in mesh["drawn"])) for mesh in told
    )
    joints = len(JOINTS)
    whole += 4 * 3 * joints + figure["vertices"] * (12 + 2 * joints) if figure else 0
    if whole > LARGEST_STILL:
        told = f"{whole / 1e6:.0f} MB beside its frames, at most {LARGEST_STILL / 1e6:.0f}"
        raise SimCoreError(f"clip: its header claims {told} – {REMEDY}")
    reader = _Reader(inflated(still, whole, "its still part"))
    code = _code(header, reader, count)
    entries = tuple(
        MeshEntry(str(mesh["name"]), mesh["vertices"], _faces(reader, mesh), reader.drawn(mesh))
        for mesh in meshes
    )
    rate, error = float(header["rate"]), float(header["error"])
    if not (0.0 < rate < 1e4 and 0.0 <= error < 1.0):
        raise SimCoreError(f"clip: its header is damaged (rate {rate:g}, error {error:g}) – {REMEDY}")
    who = _figure(figure, reader) if figure else None
    return Contents(code, entries, who, rate, header["loop"] is True, error)


def check_size(count: int, frames: int, beside: int) -> None:
    """Raises SimCoreError where so many vertices in so many frames, and so many bytes beside each, are too many."""
    size = (6 * count + beside) * frames
    if count > MOST_VERTICES or frames > MOST_FRAMES or size > LARGEST:
        most = f"at most {MOST_VERTICES}, {MOST_FRAMES} and {LARGEST / 1e6:.0f} MB; make several clips"
        raise SimCoreError(f"clip: {count} vertices in {frames} frames, {size / 1e6:.0f} MB – {most}")


def _faces(reader: _Reader, told: dict[str, Any]) -> np.ndarray:
    return reader.whole_numbers(told["faces"], 3, told["vertices"], f"mesh {told['name']!r}")


def _code(header: dict[str, Any], reader: _Reader, count: int) -> FrameCode:
    origin, step = np.array(header["origin"], float), float(header["step"])
    if origin.shape != (3,) or not (np.abs(origin) < FURTHEST).all() or not 0.0 < step <= STEP:
        raise SimCoreError(f"clip: its header is damaged (origin, step) – {REMEDY}")
    order = reader.whole_numbers(count, 1, count, "its order")[:, 0]
    sources = reader.whole_numbers(count, 3, count, "its order")
    place = np.zeros(count, np.int64)
    place[order] = np.arange(count)
    own = sources == order[:, None]
    early = place[sources] < np.arange(count)[:, None]
    if len(np.unique(order)) != count or not (early.all(1) | own.all(1)).all():
        raise SimCoreError(f"clip: its order is damaged – {REMEDY}")
    return FrameCode(origin, step, order, sources)


def _figure(told: dict[str, Any], reader: _Reader) -> Skinned:
    faces, drawn = _faces(reader, told), reader.drawn(told)
    joints, count = len(JOINTS), told["vertices"]
    heads = np.frombuffer(reader.take(12 * joints), "<f4").reshape(joints, 3).astype(float)
    rest = np.frombuffer(reader.take(12 * count), "<f4").reshape(count, 3).astype(float)
    shares = np.frombuffer(reader.take(2 * joints * count), "<u2").reshape(count, joints).astype(float)
    if not (np.isfinite(heads).all() and np.isfinite(rest).all() and shares.sum(1).all()):
        raise SimCoreError(f"clip: its figure is damaged – {REMEDY}")
    skin = told["skin"]
    known = skin in SKINS and told["parents"] == list(PARENTS) and told["linear"] == list(LINEAR_JOINTS[skin])
    if not known:
        raise SimCoreError(f"clip: its figure goes in a way that is not known ({told['skin']!r}) – {REMEDY}")
    none = np.zeros((0, joints, 4), np.float32), np.zeros((0, 3), np.float32)
    weights = shares / shares.sum(1, keepdims=True)
    return Skinned(str(told["name"]), faces, rest, weights, heads, told["skin"], *none, drawn)
