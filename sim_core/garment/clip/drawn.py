"""Which vertices of a drawn model go with which of a clip: a GLB has twins along seams, and may be thinned."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from sim_core.errors import SimCoreError
from sim_core.gltf import GlbError, glb_parts

__all__ = ["NEAR", "Drawn", "drawn_in", "nodes_of"]

NEAR = 1e-4  # [m] that a model's vertex may lie from the clip's


@dataclass(frozen=True)
class Drawn:
    """A drawn mesh that goes with one of a clip. node: its name in the model; index (P,) int32: the clip mesh's vertex
    of each of its vertices."""

    node: str
    index: np.ndarray


def drawn_in(
    model: bytes, places: Mapping[str, np.ndarray], *, near: float = NEAR
) -> dict[str, tuple[Drawn, ...]]:
    """What of a GLB goes with the meshes of a clip, by their names.

    places: of each mesh its vertices (V, 3) [m] as they lie in the model. A node of which every vertex lies on one of
    a mesh (within `near` [m]) goes with it, or with the nearest; others, such as a base, stand still.
    Raises SimCoreError for what is no GLB, and where none of its nodes goes with a mesh.
    """
    from scipy.spatial import KDTree

    trees = {name: KDTree(np.asarray(vertices, float)) for name, vertices in places.items()}
    found: dict[str, list[Drawn]] = {name: [] for name in places}
    for node, points, _ in nodes_of(model):
        nearest = {name: tree.query(points) for name, tree in trees.items()}
        name = min(nearest, key=lambda one: nearest[one][0].max(initial=0.0))
        away, index = nearest[name]
        if away.max(initial=0.0) <= near:
            found[name].append(Drawn(node, np.asarray(index, np.int32)))
    if missing := [name for name, drawn in found.items() if not drawn]:
        raise SimCoreError(
            f"clip: no node of the model lies on mesh {missing[0]!r} – give its vertices as the model has them"
        )
    return {name: tuple(drawn) for name, drawn in found.items()}


def nodes_of(model: bytes) -> list[tuple[str, np.ndarray, np.ndarray]]:
    """Names, vertices (P, 3) [m] and faces (F, 3) of a GLB's nodes with a mesh of one part; raises SimCoreError."""
    try:
        parts = glb_parts(model)
        nodes = [node for node in parts.document["nodes"] if "mesh" in node]
        meshes = [parts.document["meshes"][node["mesh"]]["primitives"] for node in nodes]
        return [
            (
                str(node["name"]),
                parts.numbers(only["attributes"]["POSITION"]),
                parts.numbers(only["indices"]).reshape(-1, 3).astype(np.int32),
            )
            for node, (only, *more) in zip(nodes, meshes, strict=True)
            if not more
        ]
    except GlbError as error:
        raise SimCoreError(f"clip: model: {error} – {error.fix}") from error
    except (KeyError, IndexError, TypeError, ValueError) as error:
        raise SimCoreError(f"clip: model: its nodes cannot be read ({error}) – export it again") from error
