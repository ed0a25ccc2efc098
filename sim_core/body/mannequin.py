"""The `Mannequin` value: a smooth headless figure in T-pose, its 21 joints, and its surface in a pose."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from sim_core.body.joints import JOINTS
from sim_core.body.pose import T_POSE, Pose
from sim_core.body.skeleton import Skeleton
from sim_core.body.skinning import SKINS
from sim_core.errors import FileProblem
from sim_core.validation.files import read_npz, written_whole

__all__ = ["Colour", "Mannequin", "Piece"]

FORMAT = 2
# What posing and laying ask for, and the joint that each mark of the surface goes with.
MARKS = {
    "neck": "neck",
    "nape": "neck",
    "top": "neck",
    "bust": "spine_3",
    "waist": "spine_2",
    "hip": "pelvis",
    "crotch": "pelvis",
    "tip_l": "wrist_l",
    "tip_r": "wrist_r",
}
TALLEST = 5.0  # [m]
Colour = tuple[float, float, float]
SHOES: Colour = (0.145, 0.15, 0.20)  # sRGB, dark silk
SHOE = 0.012  # [m] above the ankle's joint that a low shoe ends
REMEDY = "make it by `simcore figure`"
_FIELDS = ("vertices", "faces", "heads", "weights", "marks")


@dataclass(frozen=True)
class Piece:
    """What a figure wears on its skin: its name, its colour (sRGB, 0 to 1), and the vertices (V,) bool it covers."""

    name: str
    dye: Colour
    vertices: np.ndarray

    def faces(self, faces: np.ndarray) -> np.ndarray:
        """Which of some faces (F, 3) are covered, (F,) bool."""
        return np.asarray(self.vertices[faces].all(1))


@dataclass(frozen=True)
class Mannequin:
    """A closed figure in T-pose, y up, +z its front, soles at y = 0, its left side at +x.

    vertices (V, 3) float64 [m]; faces (F, 3) int32; heads (21, 3) [m], the joints at rest in the order of JOINTS;
    weights (V, 21), rows sum to 1; marks: named heights and points (3,) [m] of the T-pose; skin: how the surface goes
    with its joints, one of SKINS; pieces: of its cover, and folded: vertices (V, 3) [m] where its petticoat is folded
    (None: it has none), no part of a file.
    """

    name: str
    vertices: np.ndarray
    faces: np.ndarray
    heads: np.ndarray
    weights: np.ndarray
    marks: dict[str, np.ndarray]
    skin: str = "dual"
    pieces: tuple[Piece, ...] = ()
    folded: np.ndarray | None = None

    @property
    def skeleton(self) -> Skeleton:
        """The joints, which a pose moves."""
        return Skeleton(self.heads)

    def posed(self, pose: Pose = T_POSE) -> np.ndarray:
        """Vertices (V, 3) [m] in a pose; raises SimCoreError where a joint is turned beyond its limit."""
        pose.check()
        x = self.vertices
        if self.folded is not None and pose.spread != 1.0:
            x = (1.0 - pose.spread) * self.folded + pose.spread * x
        return SKINS[self.skin](x, self.weights, self.skeleton, pose)

    def worn(self) -> tuple[Piece, ...]:
        """What it wears by itself: low cloth shoes (履) on what goes with ankle and toes, up to the ankle's height, and
        its cover."""
        joints = [JOINTS.index(name) for name in ("ankle_l", "toe_l", "ankle_r", "toe_r")]
        low = self.vertices[:, 1] < self.heads[joints[0], 1] + SHOE
        return Piece("shoes", SHOES, low & (self.weights[:, joints].sum(1) > 0.5)), *self.pieces

    def bare(self) -> np.ndarray:
        """Which faces (F,) nothing that it wears by itself covers."""
        return ~np.any([piece.faces(self.faces) for piece in self.worn()], axis=0)

    def trunk(self) -> np.ndarray:
        """Which vertices (V,) are not of the arms."""
        arms = [k for k, name in enumerate(JOINTS) if name[:-2] in ("shoulder", "elbow", "wrist")]
        return self.weights[:, arms].sum(1) < 0.5

    def landmarks(self, pose: Pose = T_POSE) -> dict[str, np.ndarray]:
        """Points (3,) [m] of the posed figure by name: its joints, and its marks, which go with a joint each."""
        turns, shifts = self.skeleton.moves(pose)
        points = dict(zip(JOINTS, self.skeleton.joints(pose), strict=True))
        for mark, place in self.marks.items():
            joint = JOINTS.index(MARKS.get(mark, "pelvis"))
            points[mark] = turns[joint] @ place + shifts[joint]
        return points

    def standing(self, pose: Pose) -> Pose:
        """The pose with its root raised or lowered until the figure's lowest point is on the floor, y = 0."""
        return pose.shifted(y=-float(self.posed(pose)[:, 1].min()))

    def sized(self, size: float) -> Mannequin:
        """The same figure `size` times as tall, and as wide."""
        if size == 1.0:
            return self
        marks = {name: place * size for name, place in self.marks.items()}
        return replace(
            self,
            name=f"{self.name} x {size:g}",
            vertices=self.vertices * size,
            heads=self.heads * size,
            marks=marks,
            folded=None if self.folded is None else self.folded * size,
        )

    def save(self, path: Path) -> None:
        """Writes one .npz: coordinates to a hundredth of a millimetre, weights to 1/65535."""
        steps = np.round(self.vertices * 1e5).astype(np.int32)
        with written_whole(Path(path)) as stream:
            np.savez_compressed(
                stream,
                format=np.array(FORMAT),
                name=np.array(self.name),
                skin=np.array(self.skin),
                vertices=steps,
                faces=self.faces.astype(np.int32 if len(self.vertices) > 65535 else np.uint16),
                heads=self.heads,
                weights=np.round(self.weights * 65535).astype(np.uint16),
                mark_names=np.array(list(self.marks)),
                marks=np.stack(list(self.marks.values())),
            )

    def digest(self) -> str:
        """A hash of the name and of everything that decides how the figure stands and moves."""
        dyes = tuple((piece.name, piece.dye) for piece in self.pieces)
        hashed = hashlib.sha256(repr((self.name, self.skin, *dyes)).encode())
        parts = {name: getattr(self, name) for name in ("vertices", "faces", "heads", "weights")} | {
            f"mark {name}": place for name, place in sorted(self.marks.items())
        }
        if self.folded is not None:
            parts["folded"] = self.folded
        for name, array in parts.items():
            hashed.update(
                f"{name} {array.shape} {array.dtype}".encode() + np.ascontiguousarray(array).tobytes()
            )
        return hashed.hexdigest()

    @staticmethod
    def load(path: Path) -> Mannequin:
        """Reads what `save` wrote; raises FileProblem on a missing, damaged or foreign file."""
        path = Path(path)
        form = read_npz(path, ("format",), "a mannequin", REMEDY)["format"]
        if form.size != 1 or form.astype(str).ravel()[0] != str(FORMAT):
            raise FileProblem(f"{path}: written in another format – {REMEDY}")
        data = read_npz(path, ("name", "skin", *_FIELDS, "mark_names"), "a mannequin", REMEDY)
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
    wanted = ((3,), (3,), (len(JOINTS), 3), (len(vertices), len(JOINTS)), (len(names), 3))
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
    if str(data["skin"]) not in SKINS:
        raise ValueError(f"skin {str(data['skin'])!r}, none of {', '.join(SKINS)}")
    points = dict(zip(names, marks, strict=True))
    return Mannequin(
        str(data["name"]), vertices, faces.astype(np.int32), heads, weights, points, str(data["skin"])
    )
