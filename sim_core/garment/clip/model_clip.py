"""The clip of a model: of fine garments that moved, the vertices that the model has; of their wearer, what it shows."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from sim_core.body import Mannequin, Pose
from sim_core.errors import SimCoreError
from sim_core.garment.clip.clip import Clip, Moved
from sim_core.garment.clip.drawn import NEAR, Drawn, drawn_in, nodes_of
from sim_core.garment.clip.skinned import Skinned

__all__ = ["model_clip"]


def model_clip(
    model: bytes,
    moved: Mapping[str, np.ndarray],
    *,
    figure: tuple[Mannequin, Sequence[Pose]] | None = None,
    lift: float = 0.0,
    near: float = NEAR,
    rate: float = 25.0,
    loop: bool = False,
    begin: int = 0,
) -> Clip:
    """The clip that a GLB plays.

    moved: of each garment vertices (T, V, 3) [m] as it followed, the first frame as it stands in the model; thinned or
    split along seams the model may be. figure: who wears them, and a pose a frame, the first as in the model. begin:
    the frame that the clip begins with; those before it only tell how the model stands. lift [m]: how far the model
    stands above them, on its base. near [m]: how far its vertices may lie from theirs: a thinned layer over others is
    moved out of these.
    Raises SimCoreError where the first frame is not the model's, and as `Clip.of` does.
    """
    up = np.array([0.0, lift, 0.0])
    places = {name: np.asarray(frames, float)[0] + up for name, frames in moved.items()}
    if figure is not None:
        mannequin, poses = figure
        places["figure"] = mannequin.posed(poses[0]) + up
    if figure is not None and "figure" in moved:
        raise SimCoreError("clip: a garment called figure – name it otherwise")
    drawn = drawn_in(model, places, near=near)
    faces = {node: corners for node, _, corners in nodes_of(model)}
    meshes, who = [], None
    for name, nodes in drawn.items():
        used, own, corners = _compact(nodes, faces)
        if name in moved:
            meshes.append(Moved(name, np.asarray(moved[name], float)[begin:, used] + up, corners, own))
        elif figure is not None:
            lifted = [pose.shifted(y=lift) for pose in poses[begin:]]
            who = Skinned.of(mannequin, lifted, part=(used, corners), drawn=own)
    return Clip.of(meshes, figure=who, rate=rate, loop=loop)


def _compact(
    nodes: tuple[Drawn, ...], faces: Mapping[str, np.ndarray]
) -> tuple[np.ndarray, tuple[Drawn, ...], np.ndarray]:
    """Vertices (U,) that the nodes draw, the nodes counting among these, and all their faces (F, 3) likewise."""
    used = np.unique(np.concatenate([node.index for node in nodes]))
    own = tuple(Drawn(node.node, np.searchsorted(used, node.index).astype(np.int32)) for node in nodes)
    return used, own, np.concatenate([one.index[faces[one.node]] for one in own]).astype(np.int32)
