"""The `Mannequin` value: a smooth headless figure in T-pose, its joints, and its arms posed by linear blending."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sim_core.errors import FileProblem, SimCoreError
from sim_core.validation.files import read_npz

BONES = ("trunk", "upper_arm_l", "forearm_l", "hand_l", "upper_arm_r", "forearm_r", "hand_r")
PARENTS = (-1, 0, 1, 2, 0, 4, 5)
FORMAT = 1
MARKS = ("tip_l", "tip_r", "hip", "waist")  # what posing and laying ask for
TALLEST = 5.0  # [m]
REMEDY = "make it by `simcore mannequin`"
_FIELDS = ("vertices", "faces", "heads", "weights", "marks")


@dataclass(frozen=True)
class Mannequin:
    """A closed figure in T-pose, y up, +z its front, soles at y = 0, its left side at +x.

    vertices (V, 3) float64 [m]; faces (F, 3) int32; heads (7, 3) [m], the joints at which BONES begin (of the
    trunk: the root); weights (V, 7), rows sum to 1; marks: named heights and points (3,) [m] of the T-pose.
    """

    name: str
    vertices: np.ndarray
    faces: np.ndarray
    heads: np.ndarray
    weights: np.ndarray
    marks: dict[str, np.ndarray]

    @property
    def bones(self) -> tuple[str, ...]:
        """Names of the bones, in the order of heads, parents and weights."""
        return BONES

    @property
    def parents(self) -> tuple[int, ...]:
        """Index of each bone's parent, -1 for the trunk."""
        return PARENTS

    def posed(self, arm: float = 0.0, elbow: float = 0.0) -> np.ndarray:
        """Vertices (V, 3) [m] with the upper arms `arm` degrees below horizontal, forearms bent `elbow` forward.

        Raises SimCoreError for arms outside -10..80 and elbows outside 0..110 degrees.
        """
        out = np.zeros_like(self.vertices)
        for bone, (turn, shift) in enumerate(self._moves(arm, elbow)):
            out += self.weights[:, bone, None] * (self.vertices @ turn.T + shift)
        return out

    def landmarks(self, arm: float = 0.0, elbow: float = 0.0) -> dict[str, np.ndarray]:
        """Points (3,) [m] of the posed figure: the joints, the tips of the hands, and the marks of the trunk."""
        moves = self._moves(arm, elbow)
        points = dict(self.marks)
        for side, first in (("l", 1), ("r", 4)):
            names = (f"shoulder_{side}", f"elbow_{side}", f"wrist_{side}")
            for name, bone in zip(names, range(first, first + 3), strict=True):
                turn, shift = moves[bone]
                points[name] = turn @ self.heads[bone] + shift
            turn, shift = moves[first + 2]
            points[f"tip_{side}"] = turn @ self.marks[f"tip_{side}"] + shift
        return points

    def _moves(self, arm: float, elbow: float) -> list[tuple[np.ndarray, np.ndarray]]:
        """Rotation (3, 3) and shift (3,) of every bone."""
        if not -10 <= arm <= 80:
            raise SimCoreError(f"mannequin.posed: arm {arm} – give -10 to 80 degrees below horizontal")
        if not 0 <= elbow <= 110:
            raise SimCoreError(f"mannequin.posed: elbow {elbow} – give 0 to 110 degrees forward")
        moves = [(np.eye(3), np.zeros(3))]
        for first, side in ((1, 1.0), (4, -1.0)):
            down, fore = np.radians(arm), np.radians(elbow)
            upper = np.array([side * np.cos(down), -np.sin(down), 0.0])
            lower = np.cos(fore) * upper + np.array([0.0, 0.0, np.sin(fore)])
            shoulder, joint, wrist = self.heads[first : first + 3]
            raised = turn_between(joint - shoulder, upper)
            bent = turn_between(raised @ (wrist - joint), lower) @ raised
            shift = shoulder - raised @ shoulder
            moves.append((raised, shift))
            below = raised @ joint + shift - bent @ joint
            moves += [(bent, below), (bent, below)]  # the hand goes with the forearm
        return moves

    def save(self, path: Path) -> None:
        """Writes one .npz: coordinates to a hundredth of a millimetre, weights to 1/65535."""
        path = Path(path)
        path.parent.mkdir(parents=True, exist_ok=True)
        steps = np.round(self.vertices * 1e5).astype(np.int32)
        beside = path.with_name(path.name + ".part")
        with beside.open("wb") as stream:
            np.savez_compressed(
                stream,
                format=np.array(FORMAT),
                name=np.array(self.name),
                vertices=steps,
                faces=self.faces.astype(np.int32 if len(self.vertices) > 65535 else np.uint16),
                heads=self.heads,
                weights=np.round(self.weights * 65535).astype(np.uint16),
                mark_names=np.array(list(self.marks)),
                marks=np.stack(list(self.marks.values())),
            )
        beside.replace(path)

    @staticmethod
    def load(path: Path) -> Mannequin:
        """Reads what `save` wrote; raises FileProblem on a missing, damaged or foreign file."""
        path = Path(path)
        form = read_npz(path, ("format",), "a mannequin", REMEDY)["format"]
        if form.size != 1 or form.astype(str).ravel()[0] != str(FORMAT):
            raise FileProblem(f"{path}: written in another format – {REMEDY}")
        data = read_npz(path, ("name", *_FIELDS, "mark_names"), "a mannequin", REMEDY)
        try:
            return _checked(data)
        except (TypeError, ValueError, OverflowError) as error:
            raise FileProblem(f"{path}: damaged mannequin ({error}) – {REMEDY}") from error


def _checked(data: dict[str, np.ndarray]) -> Mannequin:
    """The figure of a file's arrays; raises ValueError or TypeError saying what cannot be one."""
    names = [str(name) for name in data["mark_names"].ravel()]
    for name in _FIELDS:
        if data[name].dtype.kind not in "iuf" or not np.isfinite(data[name]).all():
            raise ValueError(f"{name}: {data[name].dtype}, not all finite numbers")
    vertices, weights = data["vertices"] / 1e5, data["weights"].astype(float)
    heads, marks = data["heads"].astype(float), data["marks"].astype(float)
    faces = data["faces"]
    shapes = (vertices.shape[1:], faces.shape[1:], heads.shape, weights.shape, marks.shape)
    wanted = ((3,), (3,), (len(BONES), 3), (len(vertices), len(BONES)), (len(names), 3))
    if shapes != wanted or faces.dtype.kind not in "iu":
        raise ValueError(f"shapes {shapes}, faces {faces.dtype}")
    if len(faces) == 0 or faces.min() < 0 or faces.max() >= len(vertices):
        raise ValueError(f"faces name vertices beyond the {len(vertices)} there are, or none")
    if max(np.abs(values).max() for values in (vertices, heads, marks)) > TALLEST:
        raise ValueError(f"coordinates beyond {TALLEST} m")
    if weights.min() < 0 or weights.sum(1).min() <= 0:
        raise ValueError("weights below 0, or a vertex without any")
    if missing := [mark for mark in MARKS if mark not in names]:
        raise ValueError(f"no mark {missing[0]!r}")
    weights /= weights.sum(1, keepdims=True)
    points = dict(zip(names, marks, strict=True))
    return Mannequin(str(data["name"]), vertices, faces.astype(np.int32), heads, weights, points)


def turn_between(start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """The smallest rotation (3, 3) that takes the direction of `start` to that of `end`."""
    a, b = start / np.linalg.norm(start), end / np.linalg.norm(end)
    v, c = np.cross(a, b), float(a @ b)
    k = np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])
    return np.eye(3) + k + k @ k / max(1.0 + c, 1e-12)
