"""A panel mesh written: npz, PLY, OBJ, and a picture of its faces coloured by quality."""

from pathlib import Path
from typing import IO

import numpy as np

from sim_core.errors import FileProblem
from sim_core.mesh.measures.triangles import quality
from sim_core.mesh.panel import PanelMesh
from sim_core.validation.files import written_whole

__all__ = ["mesh_picture", "write_mesh", "write_picture"]

POOR, GOOD = np.array([206, 92, 60]), np.array([236, 238, 232])
MARGIN = 24
OVERSAMPLE = 2


def write_mesh(path: Path, mesh: PanelMesh) -> None:
    """Write a mesh as .npz (arrays as they are), .ply or .obj (y turned up, z = 0).

    Raises FileProblem for another kind of file, or one that cannot be written.
    It is written beside `path` and renamed over: an interrupt leaves the old file or the new one.
    """
    writers = {".npz": _write_npz, ".ply": _write_ply, ".obj": _write_obj}
    if path.suffix.lower() not in writers:
        raise FileProblem(f"{path}: unknown kind of file – end the name with .npz, .ply or .obj")
    with written_whole(path) as stream:
        writers[path.suffix.lower()](stream, mesh)


def write_picture(path: Path, picture: np.ndarray) -> None:
    """Write a picture (n, m, 3) uint8 as .png or .jpg, as `write_mesh` writes; raises FileProblem."""
    from PIL import Image

    kind = "jpeg" if path.suffix.lower() == ".jpg" else "png"
    with written_whole(path) as stream:
        Image.fromarray(picture).save(stream, format=kind, quality=88, optimize=True)


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


def mesh_picture(mesh: PanelMesh, *, size: int = 1200) -> np.ndarray:
    """Draw a mesh as (n, m, 3) uint8, its longer side `size` pixels; faces from red (30 degrees) to pale (60)."""
    from PIL import Image, ImageDraw

    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    scale = (size - 2 * MARGIN) * OVERSAMPLE / float((high - low).max())
    width, height = (int(v) for v in np.ceil((high - low) * scale) + 2 * MARGIN * OVERSAMPLE)
    image = Image.new("RGB", (width, height), "white")
    draw = ImageDraw.Draw(image)
    places = (mesh.vertices - low) * scale + MARGIN * OVERSAMPLE
    share = np.clip((quality(mesh.vertices, mesh.faces).min_angle - 30) / 30, 0, 1)[:, None]
    colours = np.rint(POOR + (GOOD - POOR) * share).astype(int)
    for face, colour in zip(mesh.faces, colours, strict=True):
        corners = [tuple(p) for p in places[face]]
        draw.polygon(corners, fill=tuple(colour.tolist()))
        draw.line([*corners, corners[0]], fill=(70, 84, 92), width=1)
    for loop in mesh.boundary:
        draw.line([tuple(p) for p in places[[*loop, loop[0]]]], fill=(20, 30, 40), width=2 * OVERSAMPLE)
    return np.asarray(image.resize((width // OVERSAMPLE, height // OVERSAMPLE), Image.Resampling.LANCZOS))
