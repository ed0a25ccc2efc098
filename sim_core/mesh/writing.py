"""Readers and writers of the mesh room: outline JSON in; npz, PLY, OBJ out."""

from pathlib import Path

import numpy as np

from sim_core.errors import FileProblem
from sim_core.mesh.model import PanelMesh
from sim_core.reading import read_json, shown

__all__ = ["read_outline", "write_mesh"]


def read_outline(path: Path) -> tuple[list, list]:
    """The outline and the holes of {"outline": [[x, y], ...], "holes": [...]}, metres, y down.

    Raises FileProblem (path: what – remedy) for a file that is missing, empty, no JSON or of another shape.
    """
    shape = 'it must hold {"outline": [[x, y], ...], "holes": [...]} in metres'
    values = read_json(path, f"an outline file (JSON): {shape}")
    if not isinstance(values, dict) or "outline" not in values:
        raise FileProblem(f"{path}: outline: missing – {shape}")
    unknown = sorted(set(values) - {"outline", "holes"})
    if unknown:
        raise FileProblem(f"{path}: {unknown[0][:80]}: unknown key – {shape}")
    holes = values.get("holes", [])
    if not isinstance(holes, list):
        raise FileProblem(f"{path}: holes: {shown(holes)} – give a list of contours")
    return values["outline"], holes


def write_mesh(path: Path, mesh: PanelMesh) -> None:
    """Write a mesh as .npz (arrays as they are), .ply or .obj (y turned up, z = 0); raises FileProblem otherwise."""
    writers = {".npz": _write_npz, ".ply": _write_ply, ".obj": _write_obj}
    if path.suffix.lower() not in writers:
        raise FileProblem(f"{path}: unknown kind of file – end the name with .npz, .ply or .obj")
    path.parent.mkdir(parents=True, exist_ok=True)
    writers[path.suffix.lower()](path, mesh)


def _write_npz(path: Path, mesh: PanelMesh) -> None:
    loops = {f"boundary_{k}": loop for k, loop in enumerate(mesh.boundary)}
    np.savez_compressed(path, allow_pickle=False, vertices=mesh.vertices, faces=mesh.faces, **loops)


def _upright(mesh: PanelMesh) -> np.ndarray:
    return np.column_stack([mesh.vertices[:, 0], -mesh.vertices[:, 1], np.zeros(len(mesh.vertices))])


def _write_ply(path: Path, mesh: PanelMesh) -> None:
    head = (
        "ply\nformat binary_little_endian 1.0\n"
        f"element vertex {len(mesh.vertices)}\nproperty double x\nproperty double y\nproperty double z\n"
        f"element face {len(mesh.faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    faces = np.zeros(len(mesh.faces), dtype=[("n", "u1"), ("v", "<i4", 3)])
    faces["n"], faces["v"] = 3, mesh.faces
    path.write_bytes(head.encode() + _upright(mesh).astype("<f8").tobytes() + faces.tobytes())


def _write_obj(path: Path, mesh: PanelMesh) -> None:
    lines = [f"v {x:.9g} {y:.9g} 0" for x, y, _ in _upright(mesh)]
    lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in mesh.faces]
    path.write_text("\n".join(lines) + "\n", "utf-8")
