"""A clip as a GLB whose meshes move by morph targets: what other programs play."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sim_core.gltf import GlbFile

__all__ = ["morph_glb"]


def morph_glb(moved: Sequence[tuple[str, np.ndarray, np.ndarray]], rate: float, loop: bool) -> bytes:
    """The GLB of meshes: name, positions (T, V, 3) [m], faces (F, 3); rate [1/s].

    The first frame is the mesh itself, every other one a target of ways from it. Frames are blended one into the next;
    a loop ends with its first frame again.
    """
    glb = GlbFile()
    silk = glb.material(
        {
            "name": "silk",
            "doubleSided": True,
            "pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 0.6},
        }
    )
    count = len(moved[0][1])
    for name, positions, faces in moved:
        glb.mesh(name, positions[0], faces, silk)
        glb.move(len(glb.meshes) - 1, (positions[1:] - positions[0]).astype("<f4"))
    if count > 1:
        keys = np.arange(count + loop)
        weights = np.eye(count, dtype="<f4")[keys % count][:, 1:]
        glb.animate("clip", (keys / rate).astype("<f4"), weights)
    return glb.bytes(moved[0][0], [], "sim_core.garment.clip")
