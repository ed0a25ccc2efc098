"""Readers and writers of the mesh room: outlines from JSON and pattern sheets in; npz, PLY, OBJ out."""

import warnings
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import IO, Any, NamedTuple

import numpy as np

from sim_core.errors import FileProblem, OutlineWarning
from sim_core.mesh.model import PanelMesh
from sim_core.mesh.numbers import check_numbers
from sim_core.mesh.sheets.model import Sheet
from sim_core.mesh.sheets.reading import Choice, is_sheet, panel_of, read_sheet
from sim_core.validation.files import read_json, shown

__all__ = ["Drawing", "drawing_of", "read_outline", "write_mesh", "write_picture"]


class Drawing(NamedTuple):
    """What an outline file holds: outline [m], holes and inner lines, as lists of [x, y] or arrays, y down."""

    outline: Any
    holes: list
    constraints: list


def read_outline(path: Path, choice: Choice | None = None, units: str | None = None) -> Drawing:
    """The outline, holes and inner lines of a JSON file or of one piece of a pattern sheet, metres, y down.

    JSON: {"outline": [[x, y], ...], "holes": [...], "constraints": [...]}. Sheets (SVG, DXF, GarmentCode): `choice`
    says which piece along which line, `units` what a drawing unit is; remarks are OutlineWarnings.
    Raises FileProblem (path: what – remedy) for a file that is missing, empty, of another kind or shape.
    """
    choice = choice or Choice()
    if is_sheet(path):
        return drawing_of(path, read_sheet(path, units, choice.layer), choice)
    shape = 'it must hold {"outline": [[x, y], ...], "holes": [...], "constraints": [...]} in metres'
    values = read_json(path, f"an outline file (JSON): {shape}")
    if not isinstance(values, dict) or "outline" not in values:
        raise FileProblem(f"{path}: outline: missing – {shape}")
    unknown = sorted(set(values) - {"outline", "holes", "constraints"})
    if unknown:
        raise FileProblem(f"{path}: {unknown[0][:80]}: unknown key – {shape}")
    for name in ("holes", "constraints"):
        if not isinstance(values.get(name, []), list):
            raise FileProblem(f"{path}: {name}: {shown(values[name])} – give a list of lists of [x, y]")
    check_numbers(path, "outline", values["outline"], "[x, y] in metres")
    for name, kind in (("holes", "hole"), ("constraints", "constraint")):
        for k, rows in enumerate(values.get(name, [])):
            check_numbers(path, f"{kind} {k}", rows, "[x, y] in metres")
    return Drawing(values["outline"], values.get("holes", []), values.get("constraints", []))


def drawing_of(path: Path, sheet: Sheet, choice: Choice) -> Drawing:
    """The piece of a sheet that is chosen; remarks are OutlineWarnings. Raises FileProblem."""
    piece, remark = panel_of(path, sheet, choice)
    for told in (*sheet.remarks, *filter(None, [remark])):
        warnings.warn(told, OutlineWarning, stacklevel=3)
    return Drawing(piece.cut, list(piece.holes), list(piece.lines))


def write_mesh(path: Path, mesh: PanelMesh) -> None:
    """Write a mesh as .npz (arrays as they are), .ply or .obj (y turned up, z = 0).

    Raises FileProblem for another kind of file, or one that cannot be written.
    It is written beside `path` and renamed over: an interrupt leaves the old file or the new one.
    """
    writers = {".npz": _write_npz, ".ply": _write_ply, ".obj": _write_obj}
    if path.suffix.lower() not in writers:
        raise FileProblem(f"{path}: unknown kind of file – end the name with .npz, .ply or .obj")
    _replaced(path, lambda stream: writers[path.suffix.lower()](stream, mesh))


def write_picture(path: Path, picture: np.ndarray) -> None:
    """Write a picture (n, m, 3) uint8 as .png or .jpg, as `write_mesh` writes; raises FileProblem."""
    from PIL import Image

    kind = "jpeg" if path.suffix.lower() == ".jpg" else "png"
    _replaced(
        path, lambda stream: Image.fromarray(picture).save(stream, format=kind, quality=88, optimize=True)
    )


def _replaced(path: Path, write: Callable[[IO[bytes]], None]) -> None:
    """Write beside a path and rename over it; raises FileProblem with the path and a remedy."""
    beside = path.with_name(path.name + ".part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        try:
            with beside.open("wb") as stream:
                write(stream)
            beside.replace(path)
        finally:
            with suppress(
                OSError
            ):  # what could not be made cannot be removed; the first error is the one to tell
                beside.unlink(missing_ok=True)
    except OSError as error:
        reason = error.strerror or error
        raise FileProblem(
            f"{path}: cannot be written ({reason}) – give a file in a folder that can be"
        ) from error


def _write_npz(stream: IO[bytes], mesh: PanelMesh) -> None:
    np.savez_compressed(
        stream,
        vertices=mesh.vertices,
        faces=mesh.faces,
        boundary=np.concatenate(mesh.boundary),
        boundary_start=_starts(mesh.boundary),
        lines=np.concatenate([np.zeros(0, np.int32), *mesh.lines]),
        lines_start=_starts(mesh.lines),
    )


def _starts(chains: tuple[np.ndarray, ...]) -> np.ndarray:
    """Where each chain begins in their concatenation, and its end: (k + 1,) int32."""
    return np.concatenate([[0], np.cumsum([len(chain) for chain in chains])]).astype(np.int32)


def _upright(mesh: PanelMesh) -> np.ndarray:
    return np.column_stack([mesh.vertices[:, 0], -mesh.vertices[:, 1], np.zeros(len(mesh.vertices))])


def _write_ply(stream: IO[bytes], mesh: PanelMesh) -> None:
    head = (
        "ply\nformat binary_little_endian 1.0\n"
        f"element vertex {len(mesh.vertices)}\nproperty double x\nproperty double y\nproperty double z\n"
        f"element face {len(mesh.faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    faces = np.zeros(len(mesh.faces), dtype=[("n", "u1"), ("v", "<i4", 3)])
    faces["n"], faces["v"] = 3, mesh.faces
    stream.write(head.encode() + _upright(mesh).astype("<f8").tobytes() + faces.tobytes())


def _write_obj(stream: IO[bytes], mesh: PanelMesh) -> None:
    lines = [f"v {x:.9g} {y:.9g} 0" for x, y, _ in _upright(mesh)]
    lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in mesh.faces]
    stream.write(("\n".join(lines) + "\n").encode())
