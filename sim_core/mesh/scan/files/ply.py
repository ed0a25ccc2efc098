"""A scan from a PLY: binary or text, colours or texture coordinates by vertex or by corner."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from sim_core.mesh.scan.files.beside import companion
from sim_core.mesh.scan.files.pictures import decoded, plain
from sim_core.mesh.scan.scan import MOST_TRIANGLES, Scan, ScanError

__all__ = ["ply_pictures", "read_ply_scan"]

HEAD = 1 << 16  # [bytes] that a header may have
TYPES = {
    **dict.fromkeys(("char", "int8"), "i1"),
    **dict.fromkeys(("uchar", "uint8"), "u1"),
    **dict.fromkeys(("short", "int16"), "i2"),
    **dict.fromkeys(("ushort", "uint16"), "u2"),
    **dict.fromkeys(("int", "int32"), "i4"),
    **dict.fromkeys(("uint", "uint32"), "u4"),
    **dict.fromkeys(("float", "float32"), "f4"),
    **dict.fromkeys(("double", "float64"), "f8"),
}
ORDERS = {"binary_little_endian": "<", "binary_big_endian": ">", "ascii": "<"}
LISTS = {"vertex_indices": 3, "vertex_index": 3, "texcoord": 6}  # how many numbers a triangle has of each
PAIRS = (("s", "t"), ("texture_u", "texture_v"), ("u", "v"))


@dataclass
class _Element:
    """An element of the header: its name, how many, and its properties (name, type, type of the count or "")."""

    name: str
    count: int
    properties: list[tuple[str, str, str]] = field(default_factory=list)

    def row(self, order: str) -> np.dtype:
        """A row, its lists as long as a triangle's."""
        fields: list[tuple[str, str] | tuple[str, str, tuple[int]]] = []
        for name, kind, counted in self.properties:
            if not counted:
                fields.append((name, order + kind))
                continue
            if name not in LISTS:
                raise ScanError(
                    f"its list {name!r} is not known", "export it with faces and texture coordinates alone"
                )
            fields += [(f"{name} count", order + counted), (name, order + kind, (LISTS[name],))]
        return np.dtype(fields)


@dataclass
class _Header:
    order: str
    text: bool
    begin: int
    elements: list[_Element]
    pictures: list[str]


def ply_pictures(path: Path) -> tuple[str, ...]:
    """Names of the pictures that its header tells of. Raises ScanError, OSError."""
    with path.open("rb") as file:
        return tuple(_header(file.read(HEAD)).pictures)


def read_ply_scan(path: Path, root: Path) -> Scan:
    """The scan in a PLY whose pictures lie beneath `root`. Raises ScanError naming the fault, OSError."""
    try:
        return _read(path, path.read_bytes(), root)
    except ScanError:
        raise
    except (KeyError, IndexError, TypeError, ValueError, OverflowError, ArithmeticError) as error:
        reason = f"{type(error).__name__}: {error}"[:120]
        raise ScanError(f"its header does not fit what it holds ({reason})", "export it again") from error


def _read(path: Path, data: bytes, root: Path) -> Scan:
    header = _header(data[:HEAD])
    tables = _tables(header, data)
    if "vertex" not in tables or "face" not in tables or not len(tables["face"]):
        raise ScanError("it holds no triangles, points alone", "mesh it in the scanning software")
    vertex, face = tables["vertex"], tables["face"]
    names = vertex.dtype.names or ()
    vertices = np.stack([vertex[axis].astype(float) for axis in "xyz"], axis=1)
    key = "vertex_indices" if "vertex_indices" in (face.dtype.names or ()) else "vertex_index"
    faces = face[key].astype(np.int64)
    if not 0 <= faces.min() <= faces.max() < len(vertices):
        raise ScanError("its triangles name vertices that it does not hold", "export it again")
    colours = None
    if {"red", "green", "blue"} <= set(names):
        channels = [vertex[name] for name in ("red", "green", "blue")]
        fractions = channels[0].dtype.kind == "f"
        rgb = np.stack(channels, axis=1).astype(float) * (255 if fractions else 1)
        colours = np.rint(np.clip(rgb, 0, 255)).astype(np.uint8)
    uv = _uv(vertex, face, faces)
    pictures = [
        decoded(companion(path, name, root), name, 1 / len(header.pictures)) for name in header.pictures
    ]
    number = np.full(len(faces), -1, np.int16)
    if pictures and uv is not None:
        told = face["texnumber"] if "texnumber" in (face.dtype.names or ()) else np.zeros(len(faces))
        number[:] = np.clip(told, 0, len(pictures) - 1)
    elif colours is None:
        number[:], pictures = 0, [plain(np.full(3, 0.5))]
    else:
        pictures = []
    return Scan(vertices, faces.astype(np.int32), uv, number, tuple(pictures), colours)


def _header(data: bytes) -> _Header:
    if not data.startswith(b"ply"):
        raise ScanError("it is no PLY file", "export the scan as PLY, or correct its ending")
    mark = data.find(b"end_header")
    end = data.find(b"\n", mark)
    if mark < 0 or end < 0:
        raise ScanError("its header has no end", "copy or export it again")
    found = _Header("<", False, end + 1, [], [])
    for line in data[:mark].decode("utf-8", "replace").splitlines()[1:]:
        words = line.split()
        try:
            _take(found, words, line)
        except (IndexError, KeyError, ValueError) as error:
            raise ScanError(f"its header cannot be read at {line[:60]!r}", "export it again") from error
    for element in found.elements:
        if element.name == "face" and element.count > MOST_TRIANGLES:
            what = f"it has {element.count} triangles, at most {MOST_TRIANGLES}"
            raise ScanError(what, "decimate it in the scanning software")
    return found


def _take(header: _Header, words: list[str], line: str) -> None:
    """One line of a header."""
    if words[:1] == ["format"]:
        header.order, header.text = ORDERS[words[1]], words[1] == "ascii"
    elif words[:2] == ["comment", "TextureFile"]:
        header.pictures.append(line.split("TextureFile", 1)[1].strip())
    elif words[:1] == ["element"]:
        header.elements.append(_Element(words[1], int(words[2])))
    elif words[:2] == ["property", "list"]:
        header.elements[-1].properties.append((words[4], TYPES[words[3]], TYPES[words[2]]))
    elif words[:1] == ["property"]:
        header.elements[-1].properties.append((words[2], TYPES[words[1]], ""))


def _tables(header: _Header, data: bytes) -> dict[str, np.ndarray]:
    """Element -> its rows. Raises ScanError where the file ends before them, or faces are no triangles."""
    at, numbers, found = header.begin, np.zeros(0), {}
    if header.text:
        numbers, at = _numbers(data[header.begin :]), 0
    for element in header.elements:
        row = element.row(header.order)
        width = sum(int(np.prod(row[name].shape, initial=1.0)) for name in row.names or ())
        size = element.count * (width if header.text else row.itemsize)
        if at + size > (len(numbers) if header.text else len(data)):
            _whole(
                element, numbers[at:] if header.text else np.frombuffer(data, np.uint8)[at:], row, header.text
            )
            what = (
                f"it is cut off: its header tells of {element.count} of {element.name!r}, and it ends before"
            )
            raise ScanError(what, "copy or export it again")
        if header.text:
            table = _from_numbers(numbers[at : at + size].reshape(-1, width), row)
        else:
            table = np.frombuffer(data, row, element.count, at)
        at += size
        if element.name == "face":
            _triangles(table)
        found[element.name] = table
        if element.name == "face":
            break  # what follows, edges or cameras, is not looked at
    return found


def _whole(element: _Element, rest: np.ndarray, row: np.dtype, text: bool) -> None:
    """Tells a file of other polygons from one that is cut off, by its first face."""
    if (
        element.name == "face"
        and row.names
        and row.names[0].endswith(" count")
        and len(rest)
        and int(rest[0]) != 3
    ):
        raise ScanError(
            f"its faces are no triangles (the first has {int(rest[0])} corners)", "triangulate it"
        )


def _triangles(face: np.ndarray) -> None:
    for name in face.dtype.names or ():
        if name.endswith(" count"):
            wrong = face[name] != LISTS[name.removesuffix(" count")]
            if wrong.any():
                raise ScanError(
                    "its faces are not all triangles, or it is cut off", "triangulate and export it again"
                )


def _numbers(body: bytes) -> np.ndarray:
    with warnings.catch_warnings():
        warnings.simplefilter("error", DeprecationWarning)
        try:
            return np.fromstring(body.decode("ascii"), sep=" ")
        except (DeprecationWarning, ValueError) as error:
            raise ScanError("it holds something that is no number", "export it again") from error


def _from_numbers(rows: np.ndarray, row: np.dtype) -> np.ndarray:
    table, column = np.zeros(len(rows), row), 0
    for name in row.names or ():
        shape = row[name].shape
        if shape:
            table[name], column = rows[:, column : column + shape[0]], column + shape[0]
        else:
            table[name], column = rows[:, column], column + 1
    return table


def _uv(vertex: np.ndarray, face: np.ndarray, faces: np.ndarray) -> np.ndarray | None:
    """(F, 3, 2) texture coordinates, v downwards."""
    if "texcoord" in (face.dtype.names or ()):
        corners = face["texcoord"].astype(np.float32).reshape(-1, 3, 2)
    else:
        pair = next((pair for pair in PAIRS if set(pair) <= set(vertex.dtype.names or ())), None)
        if pair is None:
            return None
        corners = np.stack([vertex[name].astype(np.float32) for name in pair], axis=1)[faces]
    return np.stack([corners[..., 0], 1 - corners[..., 1]], axis=-1)
