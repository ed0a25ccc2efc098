"""Rays through a mesh, by Intel's Embree: the nearest triangle they meet, or whether anything is in their way.

Embree is loaded when a tree is made, so that the hall opens without it. Its robust mode closes the edges between
triangles for a tenth of the speed: no ray slips between neighbours. Calls let go of the interpreter and may run in
threads; what is met does not tell how many.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hall_app.light.model import LightError

__all__ = ["Tree", "blocked", "build_tree", "cast"]

_START = np.float32(1e-5)  # [m] past its origin a ray starts: Embree would meet faces that lie on it

Singles = NDArray[np.float32]


@dataclass(frozen=True, slots=True)
class Tree:
    """What rays meet; `build_tree` makes it."""

    scene: Any  # embreex's, which tells no types


def build_tree(vertices: NDArray[np.floating], faces: NDArray[np.integer]) -> Tree:
    """A tree over vertices (V, 3) [m], faces (F, 3); no ray meets triangles without area.

    Raises LightError where Embree cannot be loaded.
    """
    try:
        from embreex.mesh_construction import TriangleMesh
        from embreex.rtcore_scene import EmbreeScene
    except ImportError as error:
        raise LightError(
            f"light: rays: embreex cannot be loaded ({error}) – `pip install embreex`; where there is none, as for "
            "Linux on ARM, bake on another machine and copy the folder room/"
        ) from error
    scene = EmbreeScene(robust=True)
    TriangleMesh(scene, np.ascontiguousarray(vertices, np.float32), np.ascontiguousarray(faces, np.int32))
    ray = np.ones((1, 3), np.float32)
    scene.run(ray, ray)  # Embree makes the tree with the first ray: here, not in a thread
    return Tree(scene)


def cast(
    tree: Tree, origins: NDArray[np.floating], directions: NDArray[np.floating]
) -> tuple[NDArray[np.int32], Singles, Singles, Singles]:
    """Nearest hits of rays from (N, 3) [m] along unit (N, 3), from 10 µm on: face (N,), −1: none, distance (N,) [m],
    then above 1e36, and the barycentric coordinates (N,) of the triangle's second and third corner, zero for none."""
    way = np.ascontiguousarray(directions, np.float32)
    met = tree.scene.run(_started(origins, way), way, query="INTERSECT", output=True)
    hit = met["primID"] >= 0  # Embree leaves the coordinates of the others as the memory was
    u, v = (np.where(hit, met[name], np.float32(0)) for name in ("u", "v"))
    return met["primID"], met["tfar"] + _START, u, v


def blocked(tree: Tree, origins: Singles, directions: Singles, limit: Singles) -> NDArray[np.bool_]:
    """(N,) whether anything is met from 10 µm on and before `limit` (N,) [m]."""
    return tree.scene.run(_started(origins, directions), directions, limit - _START, query="OCCLUDED") >= 0


def _started(origins: NDArray[np.floating], directions: Singles) -> Singles:
    return np.ascontiguousarray(origins + _START * directions, np.float32)
