"""Looking into a GLB: is it plain, how much does it hold, how large is it? No drawing."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from hall_app.content.models.accessors import see_that_it_is_held, whole
from hall_app.content.models.pictures import PictureError, picture_size
from sim_core.gltf import GlbError, GlbParts, glb_parts, node_matrix

# The page has no decoder for these: it would look for one on the network, and the hall works without.
REFUSED = ("KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_texture_basisu")
TRIANGLES, STRIP, FAN = 4, 5, 6
Corner = tuple[float, float, float]


@dataclass(frozen=True)
class GlbInfo:
    """What a GLB holds.

    size: bytes; triangles: as drawn; textures: (width, height) [pixels] of each image; low, high: lowest and highest
    corner [m] of the whole model with its nodes' transforms; afar: triangles that are drawn for far eyes alone.
    """

    size: int
    triangles: int
    textures: tuple[tuple[int, int], ...]
    extensions: tuple[str, ...]
    low: Corner
    high: Corner
    afar: int = 0


def read_glb(path: Path) -> GlbInfo:
    """Read header and JSON of the GLB at `path`. Raises GlbError naming the fault, OSError if unreadable."""
    parts = open_glb(path)
    document = parts.document
    try:
        extensions = _plain_extensions(document)
        _no_outside_files(document)
        see_that_it_is_held(parts)
        triangles, afar = _triangles(document)
        with np.errstate(all="ignore"):  # what is not finite is refused by name
            low, high = _bounds(document)
        return GlbInfo(len(parts.data), triangles, _textures(parts), extensions, low, high, afar)
    except GlbError:
        raise
    except (KeyError, IndexError, TypeError, AttributeError, ValueError, ArithmeticError) as error:
        raise GlbError(
            f"its glTF part is inconsistent ({_short(error)})", "export the model again"
        ) from error


def _short(error: Exception) -> str:
    return f"{type(error).__name__}: {error}"[:120]


def _plain_extensions(document: dict[str, Any]) -> tuple[str, ...]:
    """All extensions named; refuses those the page cannot draw."""
    extensions = (*document.get("extensionsUsed", ()), *document.get("extensionsRequired", ()))
    refused = sorted(set(extensions) & set(REFUSED))
    if refused:
        raise GlbError(
            f"uses {', '.join(refused)}, which the hall cannot draw offline",
            "export it again without compression",
        )
    return tuple(dict.fromkeys(extensions))


def open_glb(path: Path) -> GlbParts:
    """The parts of the GLB at `path`. Raises GlbError if it is none, OSError if unreadable."""
    return glb_parts(path.read_bytes())


def _no_outside_files(document: dict[str, Any]) -> None:
    for entry in [*document.get("buffers", ()), *document.get("images", ())]:
        if not entry.get("uri", "data:").startswith("data:"):
            raise GlbError(f"refers to another file {entry['uri']!r}", "export with everything embedded")


def _triangles(document: dict[str, Any]) -> tuple[int, int]:
    """Triangles drawn, each mesh counted as often as nodes show it, and how many of them are drawn from afar alone."""
    per_mesh = [sum(_drawn(document, p) for p in mesh["primitives"]) for mesh in document.get("meshes", ())]
    shown = [node for node in document.get("nodes", ()) if "mesh" in node]
    if not shown or not sum(per_mesh):
        raise GlbError("holds no triangles", "export the model with its meshes")
    afar = [node for node in shown if is_afar(node)]
    count, far = (sum(per_mesh[node["mesh"]] for node in nodes) for nodes in (shown, afar))
    return count, far


def is_afar(node: dict[str, Any]) -> bool:
    """Whether a node is of the level that is seen from afar alone (`GlbFile.levels`)."""
    extras = node.get("extras")
    return isinstance(extras, dict) and "from" in extras


def _drawn(document: dict[str, Any], primitive: dict[str, Any]) -> int:
    index = primitive.get("indices", primitive["attributes"]["POSITION"])
    count = whole(document["accessors"][index]["count"])
    mode = primitive.get("mode", TRIANGLES)
    return count // 3 if mode == TRIANGLES else max(0, count - 2) if mode in (STRIP, FAN) else 0


def _bounds(document: dict[str, Any]) -> tuple[Corner, Corner]:
    """Box round all shown meshes: the corners of each accessor's box, moved by the nodes above it."""
    nodes = document["nodes"]
    scene = document.get("scenes", [{}])[document.get("scene", 0)]
    children = {child for node in nodes for child in node.get("children", ())}
    roots = scene.get("nodes", [index for index in range(len(nodes)) if index not in children])
    corners: list[np.ndarray] = []
    todo, met = [(index, np.eye(4)) for index in roots], set()
    while todo:
        index, above = todo.pop()
        if index in met:
            raise GlbError(f"node {index} has two parents or is in a loop", "export the model again")
        met.add(index)
        matrix = above @ node_matrix(nodes[index])
        todo += [(child, matrix) for child in nodes[index].get("children", ())]
        if "mesh" in nodes[index] and not is_afar(nodes[index]):
            for primitive in document["meshes"][nodes[index]["mesh"]]["primitives"]:
                accessor = document["accessors"][primitive["attributes"]["POSITION"]]
                (x0, y0, z0), (x1, y1, z1) = accessor["min"], accessor["max"]
                box = np.array(np.meshgrid((x0, x1), (y0, y1), (z0, z1)), dtype=float)
                corners.append(box.reshape(3, -1).T @ matrix[:3, :3].T + matrix[:3, 3])
    points = np.concatenate(corners)
    if not np.isfinite(points).all():
        raise GlbError("has no finite size", "export the model again")
    low, high = points.min(axis=0).tolist(), points.max(axis=0).tolist()
    return (low[0], low[1], low[2]), (high[0], high[1], high[2])


def _textures(parts: GlbParts) -> tuple[tuple[int, int], ...]:
    try:
        return tuple(picture_size(picture) for picture in parts.pictures())
    except PictureError as error:
        raise GlbError(
            f"one of its textures cannot be read: {error}", "embed textures as PNG or JPEG"
        ) from error
