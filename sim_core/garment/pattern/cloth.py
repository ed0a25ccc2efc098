"""Panels meshed so that what is sewn together has equally many steps, and the index lists that join them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np

from sim_core.errors import OutlineError
from sim_core.garment.pattern.panels import Panel, Path, Seam, arc_length, at_length
from sim_core.mesh import PanelMesh, panel_mesh
from sim_core.mesh.outline import check_edge, signed_area

__all__ = ["MOST_VERTICES", "SIDES", "Cloth", "cut_cloth", "unsided"]

SIDES = (" left", " right")  # of the wearer: a panel of a whole cloth is called so behind its name


MOST_VERTICES = 200_000  # of a panel that is to be draped: a night's work


def unsided(name: str) -> str:
    """A panel's name without the side of a mirrored pattern."""
    return next((name.removesuffix(side) for side in SIDES if name.endswith(side)), name)


@dataclass(frozen=True)
class Cloth:
    """All panels meshed. P pattern vertices, F faces.

    vertices (P, 2) [m] in pattern axes, each panel in its own; faces (F, 3) int32, positive area in (x, -y);
    panel (F,) and panel_of (P,) number the panels of `names`; joined (P,): vertices joined flat have one number,
    closed (P,): once all seams are sewn; pairs (K, 2): what `sewn` draws together; middle (M,): vertices on x = 0.
    """

    names: tuple[str, ...]
    vertices: np.ndarray
    faces: np.ndarray
    panel: np.ndarray
    panel_of: np.ndarray
    joined: np.ndarray
    closed: np.ndarray
    pairs: np.ndarray
    middle: np.ndarray
    paths: dict[str, np.ndarray]

    @staticmethod
    def of(mesh: PanelMesh, name: str = "cloth") -> Cloth:
        """A single panel without seams."""
        alone = np.arange(len(mesh.vertices), dtype=np.int32)
        none = np.zeros(0, np.int32)
        faces = mesh.faces.astype(np.int32)
        panel, owner = np.zeros(len(faces), np.int32), np.zeros(len(alone), np.int32)
        return Cloth((name,), mesh.vertices, faces, panel, owner, alone, alone, none.reshape(0, 2), none, {})

    def along(self, path: Path, panel: Panel, side: str = "") -> np.ndarray:
        """Numbers of the pattern vertices on a path, in its direction; side: of a whole cloth, one of SIDES."""
        parts = []
        for leg in panel.path(path.start, path.end, ahead=path.ahead):
            index = self.paths[f"{panel.name}{side}/{leg}"]
            parts.append(index if path.ahead else index[::-1])
        return np.concatenate([parts[0][:1], *(part[1:] for part in parts)])

    def mirrored(self) -> Cloth:
        """Both halves: the second is the first turned over about x = 0; middles are joined to their images."""
        count = len(self.vertices)
        flipped = self.faces[:, [0, 2, 1]] + count
        names = tuple(name + side for side in SIDES for name in self.names)

        def doubled(index: np.ndarray) -> np.ndarray:
            image = index + index.max() + 1
            on = np.unique(index[self.middle])
            image[np.isin(index, on)] = index[np.isin(index, on)]
            return np.unique(np.r_[index, image], return_inverse=True)[1].astype(np.int32)

        joined = doubled(self.joined)
        first = np.unique(self.joined, return_index=True)[1]  # a pattern vertex of each joined one
        ends = first[self.pairs]
        paths = {f"{name}{SIDES[0]}/{leg}": index for (name, leg), index in self._legs()}
        paths |= {f"{name}{SIDES[1]}/{leg}": index + count for (name, leg), index in self._legs()}
        return Cloth(
            names,
            np.concatenate([self.vertices, self.vertices * [-1.0, 1.0]]),
            np.concatenate([self.faces, flipped]).astype(np.int32),
            np.r_[self.panel, self.panel + len(self.names)].astype(np.int32),
            np.r_[self.panel_of, self.panel_of + len(self.names)].astype(np.int32),
            joined,
            doubled(self.closed),
            np.concatenate([joined[ends], joined[ends + count]]).astype(np.int32).reshape(-1, 2),
            np.zeros(0, np.int32),
            paths,
        )

    def _legs(self) -> Iterator[tuple[tuple[str, str], np.ndarray]]:
        """Panel and number of every leg, with its vertices."""
        for key, index in self.paths.items():
            name, _, leg = key.rpartition("/")
            yield (name, leg), index


def cut_cloth(panels: Sequence[Panel], seams: Sequence[Seam], edge: float) -> Cloth:
    """Meshes all panels at `edge` [m]; both sides of every seam get equal steps, counted from their first points.

    Raises OutlineError naming the panel where one cannot be meshed.
    """
    by_name = {panel.name: panel for panel in panels}
    for panel in panels:
        with _named(panel):
            check_edge(edge, [panel.outline()], MOST_VERTICES)
    marks = _marks(by_name, seams, edge)
    vertices, faces, panel_of, owner, paths = [], [], [], [], {}
    start = 0
    for number, panel in enumerate(panels):
        samples, index = _samples(panel, marks)
        with _named(panel):
            mesh = panel_mesh(samples, edge=edge, sampled=True)
        for leg, where in enumerate(index):
            paths[f"{panel.name}/{leg}"] = where + start
        vertices.append(mesh.vertices)
        faces.append(mesh.faces + start)
        owner.append(np.full(len(mesh.faces), number, np.int32))
        panel_of.append(np.full(len(mesh.vertices), number, np.int32))
        start += len(mesh.vertices)
    alone = np.arange(start, dtype=np.int32)
    cloth = Cloth(
        names=tuple(by_name),
        vertices=np.concatenate(vertices),
        faces=np.concatenate(faces).astype(np.int32),
        panel=np.concatenate(owner),
        panel_of=np.concatenate(panel_of),
        joined=alone,
        closed=alone,
        pairs=np.zeros((0, 2), np.int32),
        middle=np.zeros(0, np.int32),
        paths=paths,
    )
    return _stitched(cloth, by_name, seams)


@contextmanager
def _named(panel: Panel) -> Iterator[None]:
    try:
        yield
    except OutlineError as error:
        raise OutlineError(f"panel.{panel.name}: {error}") from error


def _stitched(cloth: Cloth, panels: dict[str, Panel], seams: Sequence[Seam]) -> Cloth:
    flat, sewn, middle = [], [], [np.zeros(0, np.int32)]
    for seam in seams:
        a = cloth.along(seam.a, panels[seam.a.panel])
        if seam.b is None:
            middle.append(a)
            continue
        twins = np.column_stack([a, cloth.along(seam.b, panels[seam.b.panel])])
        (flat if seam.kind == "joined" else sewn).append(twins)
    none = np.zeros((0, 2), np.int32)
    joined = _united(len(cloth.vertices), np.concatenate([none, *flat]))
    closed = _united(len(cloth.vertices), np.concatenate([none, *flat, *sewn]))
    pairs = np.unique(np.sort(joined[np.concatenate([none, *sewn])], axis=1), axis=0)
    values = {**cloth.__dict__, "joined": joined, "closed": closed}
    values["pairs"] = pairs[pairs[:, 0] != pairs[:, 1]].astype(np.int32)
    values["middle"] = np.unique(np.concatenate(middle)).astype(np.int32)
    return Cloth(**values)


def _united(count: int, twins: np.ndarray) -> np.ndarray:
    """Number of the point (count,) each vertex belongs to when twins (K, 2) are one, in order of first mention."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    graph = coo_array((np.ones(len(twins)), (twins[:, 0], twins[:, 1])), (count, count))
    label = connected_components(graph, directed=False)[1]
    _, first = np.unique(label, return_index=True)
    rank = np.zeros(len(first), np.int32)
    rank[np.argsort(first)] = np.arange(len(first))
    return rank[label]


def _marks(panels: dict[str, Panel], seams: Sequence[Seam], edge: float) -> dict[tuple[str, int], np.ndarray]:
    """Arc lengths [m] of the samples on every leg, both ends included, in the outline's order."""
    marks: dict[tuple[str, int], np.ndarray] = {}
    for panel in panels.values():
        for k, leg in enumerate(panel.legs):
            length = arc_length(leg)[-1]
            marks[panel.name, k] = np.linspace(0, length, _steps(length, edge) + 1)
    for seam in seams:
        if seam.b is not None:
            _match(marks, panels, seam.a, seam.b, edge)
    return marks


def _match(
    marks: dict[tuple[str, int], np.ndarray], panels: dict[str, Panel], a: Path, b: Path, edge: float
) -> None:
    sides = []
    for path in (a, b):
        panel = panels[path.panel]
        numbers = panel.path(path.start, path.end, ahead=path.ahead)
        sides.append((path, numbers, [arc_length(panel.legs[k])[-1] for k in numbers]))
    most = max(sides, key=lambda side: len(side[1]))[2]
    split = [
        lengths if len(lengths) == len(most) else [lengths[0] * part / sum(most) for part in most]
        for _, _, lengths in sides
    ]
    steps = [_steps(max(pair), edge) for pair in zip(*split, strict=True)]
    for (path, numbers, lengths), parts in zip(sides, split, strict=True):
        pieces = [np.linspace(0, part, n + 1) for part, n in zip(parts, steps, strict=True)]
        if len(numbers) < len(parts):
            offset = np.r_[0.0, np.cumsum(parts)[:-1]]
            pieces = [np.concatenate([[0.0], *(p[1:] + o for p, o in zip(pieces, offset, strict=True))])]
        for leg, piece, length in zip(numbers, pieces, lengths, strict=True):
            marks[path.panel, leg] = piece if path.ahead else length - piece[::-1]


def _steps(length: float, edge: float) -> int:
    return max(1, int(np.ceil(length / edge - 1e-6)))


def _samples(panel: Panel, marks: dict[tuple[str, int], np.ndarray]) -> tuple[np.ndarray, list[np.ndarray]]:
    """Outline samples (n, 2), cloth on their left in (x, -y), and per leg the numbers of its samples in order."""
    parts, index, count = [], [], 0
    for k, leg in enumerate(panel.legs):
        points = at_length(leg, marks[panel.name, k])
        parts.append(points[:-1])
        index.append(np.arange(count, count + len(points)))
        count += len(points) - 1
    samples = np.concatenate(parts)
    index = [where % count for where in index]
    if signed_area(samples) < 0:
        samples = samples[::-1].copy()
        index = [count - 1 - where for where in index]
    return samples, index
