"""The `Clip` value: meshes in motion, quantised, every frame by itself, and a figure that goes along by its bones."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from sim_core.errors import FileProblem, SimCoreError
from sim_core.garment.clip import clip_file
from sim_core.garment.clip.clip_file import Contents, MeshEntry
from sim_core.garment.clip.drawn import Drawn
from sim_core.garment.clip.frame_code import STEP, FrameCode
from sim_core.garment.clip.morphs import morph_glb
from sim_core.garment.clip.skinned import Skinned
from sim_core.validation import finite, numeric_array, triangles
from sim_core.validation.files import read_bytes, written_whole

__all__ = ["Clip", "Moved"]

RATES = (1.0, 240.0)  # [1/s]


@dataclass(frozen=True)
class Moved:
    """A mesh as it moved. name; positions (T, V, 3) [m]; faces (F, 3) of its vertices; drawn: what of a model goes with
    it."""

    name: str
    positions: np.ndarray
    faces: np.ndarray
    drawn: tuple[Drawn, ...] = field(default=())


@dataclass(frozen=True)
class Clip:
    """Frames of one or more meshes at a rate. T frames, V vertices of all meshes that go by their vertices.

    code: how positions become whole steps and bytes; meshes: their names, faces and vertices, in order; steps
    (T, V, 3) uint16; figure: who goes along by its bones; rate [1/s]; loop: whether the first frame follows the last;
    error [m]: the farthest that a vertex lies from where it was given.
    """

    code: FrameCode
    meshes: tuple[MeshEntry, ...]
    steps: np.ndarray
    figure: Skinned | None = None
    rate: float = 25.0
    loop: bool = False
    error: float = 0.0

    @staticmethod
    def of(
        meshes: Sequence[Moved],
        *,
        figure: Skinned | None = None,
        rate: float = 25.0,
        loop: bool = False,
        step: float = STEP,
    ) -> Clip:
        """A clip of meshes, all in the same number of frames, and of a figure in as many.

        step [m]: of the quantisation, at most 0.25 mm; finer by itself where the meshes are small. A figure is kept by
        its bones, or as one more mesh where that takes fewer bytes.
        Raises SimCoreError, naming mesh and remedy, for frames that do not agree, faces of vertices that there are not,
        what is not finite, meshes that span more than 65 535 steps, and more of them than a file may hold.
        """
        rate = finite("clip: rate", rate, least=RATES[0], most=RATES[1])
        given = [_checked(mesh) for mesh in meshes]
        counts = {mesh.name: len(mesh.positions) for mesh in given} | (
            {figure.name: figure.frames} if figure else {}
        )
        if len(counts) != len(given) + (figure is not None):
            raise SimCoreError("clip: two meshes of one name – name them apart")
        if len(set(counts.values())) != 1 or not all(counts.values()):
            told = ", ".join(f"{name} {count}" for name, count in counts.items()) or "none"
            raise SimCoreError(f"clip: frames: {told} – give one or more, as many of each")
        if figure is not None and (not given or _smaller_by_vertices(figure, step)):
            given, figure = [*given, _by_vertices(figure)], None
        joined = np.concatenate([mesh.positions for mesh in given], axis=1)
        begins = np.cumsum([0, *(mesh.positions.shape[1] for mesh in given)])
        clip_file.check_size(joined.shape[1], len(joined), clip_file.POSE if figure else 0)
        faces = np.concatenate([mesh.faces + begin for mesh, begin in zip(given, begins, strict=False)])
        low, high = joined.min((0, 1)), joined.max((0, 1))
        code = FrameCode.of(low, high, faces, joined.shape[1], step)
        steps = code.steps(joined)
        away = max(
            float(np.linalg.norm(code.positions(s) - x, axis=1).max())
            for s, x in zip(steps, joined, strict=True)
        )
        entries = tuple(MeshEntry(m.name, m.positions.shape[1], m.faces, m.drawn) for m in given)
        return Clip(code, entries, steps, figure, rate, bool(loop), away)

    @property
    def frames(self) -> int:
        """How many there are."""
        return len(self.steps)

    @property
    def seconds(self) -> float:
        """How long it plays: a loop from its first frame to that again, others to their last."""
        return (self.frames if self.loop else self.frames - 1) / self.rate

    @property
    def names(self) -> tuple[str, ...]:
        """Of its meshes, and then of its figure."""
        return (*(mesh.name for mesh in self.meshes), *((self.figure.name,) if self.figure else ()))

    def positions(self, frame: int, name: str) -> np.ndarray:
        """Vertices (V, 3) float64 [m] of a mesh, or of the figure, in a frame; raises SimCoreError for another name."""
        if not 0 <= frame < self.frames:
            raise SimCoreError(f"clip: frame {frame} – there are 0 to {self.frames - 1}")
        if self.figure is not None and name == self.figure.name:
            return self.figure.posed(frame)
        begin = 0
        for mesh in self.meshes:
            if mesh.name == name:
                return self.code.positions(self.steps[frame, begin : begin + mesh.count])
            begin += mesh.count
        raise SimCoreError(f"clip: no mesh {name!r} – there are {', '.join(self.names)}")

    def faces(self, name: str) -> np.ndarray:
        """Faces (F, 3) int32 of a mesh, or of the figure; raises SimCoreError for another name."""
        for mesh in (*self.meshes, *((self.figure,) if self.figure else ())):
            if mesh.name == name:
                return mesh.faces
        raise SimCoreError(f"clip: no mesh {name!r} – there are {', '.join(self.names)}")

    def frame_bytes(self, frame: int) -> bytes:
        """One frame by itself, the figure's pose with it: as in a file, and as a live socket would send it."""
        return self.code.packed(self.steps[frame], self.figure.frame_bytes(frame) if self.figure else b"")

    def to_bytes(self) -> bytes:
        """The file's bytes."""
        frames = [self.frame_bytes(frame) for frame in range(self.frames)]
        contents = Contents(self.code, self.meshes, self.figure, self.rate, self.loop, self.error)
        return clip_file.written(contents, frames)

    @staticmethod
    def from_bytes(data: bytes) -> Clip:
        """Reads what `to_bytes` made; raises SimCoreError on what is damaged, cut off or something else."""
        contents, frames = clip_file.read(data)
        figure = contents.figure
        beside = clip_file.POSE if figure else 0
        steps, poses = contents.code.unpacked(frames, beside)
        if figure is not None:
            told = np.frombuffer(b"".join(poses), "<f4").reshape(len(frames), -1)
            if not np.isfinite(told).all():
                raise SimCoreError("clip: a pose is not finite – bake it again")
            turns = told[:, :-3].reshape(len(frames), -1, 4)
            if not (np.abs(np.linalg.norm(turns, axis=2) - 1.0) < 1e-3).all():
                raise SimCoreError("clip: a pose turns by no unit quaternion – bake it again")
            figure = replace(figure, turns=turns, shifts=told[:, -3:])
        return Clip(
            contents.code, contents.meshes, steps, figure, contents.rate, contents.loop, contents.error
        )

    def save(self, path: Path) -> int:
        """Writes the file whole or not at all; returns its bytes. Raises FileProblem where it cannot be written."""
        data = self.to_bytes()
        with written_whole(Path(path)) as stream:
            stream.write(data)
        return len(data)

    @staticmethod
    def load(path: Path) -> Clip:
        """Reads what `save` wrote; raises FileProblem on a missing, damaged or foreign file."""
        path = Path(path)
        try:
            return Clip.from_bytes(read_bytes(path, "a clip that Clip.save wrote", clip_file.LARGEST))
        except FileProblem:
            raise
        except SimCoreError as error:
            raise FileProblem(f"{path}: {error}") from error

    def write_glb(self, path: Path) -> int:
        """Writes a GLB whose meshes move by morph targets, for other programs; returns its bytes.

        The hall plays clips themselves: a GLB of 100 frames is ten times as large.
        """
        moved = [
            (name, np.stack([self.positions(k, name) for k in range(self.frames)]), self.faces(name))
            for name in self.names
        ]
        data = morph_glb(moved, self.rate, self.loop)
        with written_whole(Path(path)) as stream:
            stream.write(data)
        return len(data)


def _checked(mesh: Moved) -> Moved:
    """The mesh with its types; raises SimCoreError naming it."""
    name = f"clip: mesh {mesh.name}"
    positions = np.asarray(numeric_array(name, mesh.positions, "expected (T, V, 3)"), float)
    if positions.ndim != 3 or positions.shape[2] != 3 or not positions.size:
        raise SimCoreError(f"{name}: shape {positions.shape} – expected (T, V, 3) [m], T and V above 0")
    if not np.isfinite(positions).all():
        frame = int(np.flatnonzero(~np.isfinite(positions).all((1, 2)))[0])
        raise SimCoreError(f"{name}: frame {frame} holds numbers that are not finite")
    count = positions.shape[1]
    faces = np.ascontiguousarray(triangles(f"{name}: faces", mesh.faces, count), np.int32)
    for drawn in mesh.drawn:
        if drawn.index.size and not (0 <= drawn.index.min() and drawn.index.max() < count):
            raise SimCoreError(f"{name}: {drawn.node} draws vertices beyond the {count} there are")
    return Moved(mesh.name, positions, faces, tuple(mesh.drawn))


def _by_vertices(figure: Skinned) -> Moved:
    positions = np.stack([figure.posed(frame) for frame in range(figure.frames)])
    return Moved(figure.name, positions, figure.faces, figure.drawn)


def _smaller_by_vertices(figure: Skinned, step: float) -> bool:
    """Whether the figure takes fewer bytes as a mesh than by its bones; the first frames tell."""
    told = clip_file.bones_bytes(figure)
    if told > figure.frames * (6 * len(figure.rest) + 64):
        return True
    if told < figure.frames * len(figure.rest) // 2:  # half a byte a vertex: no surface packs as small
        return False
    moved = _by_vertices(figure).positions
    low, high = moved.min((0, 1)), moved.max((0, 1))
    code = FrameCode.of(low, high, figure.faces, len(figure.rest), step)
    return sum(len(code.packed(code.steps(x))) for x in moved) < told
