"""Fewer triangles where a mesh is flat: vertices slide onto neighbours, seams and borders keep their lines.

Half-edge collapses in the order of their quadric error (Garland and Heckbert 1997). Vertices that stay have kept their
place and their pattern coordinates, so texture coordinates are exact and twins of a seam cannot part.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sim_core.errors import SimCoreError
from sim_core.garment.levels.collapses import TWINS, Heap, Mesh, offer_all, thin
from sim_core.validation import points

__all__ = ["Thinning", "moment_of"]

LINE_WEIGHT = 4.0  # of keeping a border or seam in its line, against keeping a face in its plane


class Thinning:
    """A mesh that is made coarser step by step.

    vertices (V, 3) [m]; pattern (P, 2) [m] or None; faces (F, 3) of pattern vertices; weld (P,) to vertices;
    fixed (V,) bool: vertices that stay where they are; moments: where the vertices (V, 3) [m] are at other times, when
    the mesh is to be as true: what is flat as cloth hangs may be bent over a knee a moment later. Raises SimCoreError
    for a moment of other vertices, or one that is not finite.
    """

    def __init__(
        self,
        vertices: np.ndarray,
        faces: np.ndarray,
        weld: np.ndarray,
        pattern: np.ndarray | None = None,
        fixed: np.ndarray | None = None,
        moments: Sequence[np.ndarray] = (),
    ) -> None:
        count, welded = len(vertices), weld[faces]
        places = [vertices, *(moment_of(number, x, count) for number, x in enumerate(moments))]
        lines = _line_neighbours(welded, faces, count)
        corners = welded.ravel()
        order = np.argsort(corners, kind="stable")
        link = np.full(len(corners), -1, np.int64)
        alike = corners[order][1:] == corners[order][:-1]
        link[order[:-1][alike]] = order[1:][alike]
        head = np.full(count, -1, np.int64)
        head[corners[::-1]] = np.arange(len(corners))[::-1]
        self._mesh = Mesh(
            x=np.ascontiguousarray(np.column_stack(places), float),
            flat=np.zeros((0, 2)) if pattern is None else np.ascontiguousarray(pattern, float),
            weld=weld.astype(np.int64),
            faces=faces.astype(np.int64),
            alive=np.ones(len(faces), bool),
            head=head,
            link=link,
            lines=np.array([u for near in lines for u in sorted(near)], np.int64),
            line_start=np.cumsum([0, *map(len, lines)]),
            stays=np.zeros(count, bool) if fixed is None else fixed.copy(),
            quadric=np.column_stack([_quadrics(x, welded, lines) for x in places]),
            version=np.zeros(count, np.int64),
            count=np.array([len(faces)]),
            ring=np.zeros(count, np.int64),
            met=np.zeros(count, np.int64),
            clock=np.zeros(1, np.int64),
            old=np.zeros(TWINS, np.int64),
            new=np.zeros(TWINS, np.int64),
        )
        room = 8 * count + 64
        heap = Heap(np.zeros(room), np.zeros((room, 3), np.int64), np.zeros(1, np.int64))
        self._heap = offer_all(self._mesh, heap)

    @property
    def count(self) -> int:
        """How many faces are left."""
        return int(self._mesh.count[0])

    def faces(self) -> np.ndarray:
        """The faces (F, 3) that are left, of pattern vertices."""
        return self._mesh.faces[self._mesh.alive].astype(np.int32)

    def numbers(self) -> np.ndarray:
        """Which of the first faces (F,) are left, in the order of `faces`."""
        return np.flatnonzero(self._mesh.alive)

    def to(self, triangles: int) -> None:
        """Collapses edges until at most `triangles` are left, or no collapse is sound."""
        self._heap = thin(self._mesh, self._heap, triangles)


def moment_of(number: int, moment: np.ndarray, count: int) -> np.ndarray:
    """Places (V, 3) [m] of so many vertices; raises SimCoreError, naming the moment, for what is none."""
    places = points(f"moments[{number}]", moment)
    if len(places) != count:
        raise SimCoreError(f"moments[{number}]: {len(places)} vertices – the mesh has {count}")
    return places


def _line_neighbours(welded: np.ndarray, faces: np.ndarray, count: int) -> list[set[int]]:
    """Per vertex its neighbours along borders and seams: edges of one face, or of two that name it differently."""
    lines: list[set[int]] = [set() for _ in range(count)]
    seen: dict[tuple[int, int], tuple[int, int] | None] = {}
    for face, name in zip(welded.tolist(), faces.tolist(), strict=True):
        for k in range(3):
            a, b, p, q = face[k], face[k - 2], name[k], name[k - 2]
            key, names = ((a, b), (p, q)) if a < b else ((b, a), (q, p))
            if key not in seen:
                seen[key] = names
            elif seen[key] == names:
                seen[key] = None  # within one panel
    for (a, b), names in seen.items():
        if names is not None:
            lines[a].add(b)
            lines[b].add(a)
    return lines


def _quadrics(vertices: np.ndarray, faces: np.ndarray, lines: list[set[int]]) -> np.ndarray:
    """Ten numbers per vertex: the planes of its faces by area, and planes that hold its lines."""
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    size = np.linalg.norm(normal, axis=1)
    normal /= np.maximum(size, 1e-300)[:, None]
    total = np.zeros((len(vertices), 10))
    plane = np.column_stack([normal, -(normal * a).sum(1)])
    np.add.at(total, faces.ravel(), np.repeat(_products(plane) * (size / 6)[:, None], 3, axis=0))
    shading = np.zeros_like(vertices)
    np.add.at(shading, faces.ravel(), np.repeat(normal * size[:, None], 3, axis=0))
    pairs = np.array([(i, j) for i, near in enumerate(lines) for j in near if i < j]).reshape(-1, 2)
    if len(pairs):
        i, j = pairs.T
        way = vertices[j] - vertices[i]
        upright = shading[i] + shading[j]
        upright /= np.maximum(np.linalg.norm(upright, axis=1), 1e-300)[:, None]
        across = np.cross(way, upright)
        across /= np.maximum(np.linalg.norm(across, axis=1), 1e-300)[:, None]
        weight = LINE_WEIGHT * (way**2).sum(1) / 2
        for n in (across, upright):
            held = _products(np.column_stack([n, -(n * vertices[i]).sum(1)])) * weight[:, None]
            np.add.at(total, i, held)
            np.add.at(total, j, held)
    return total


def _products(plane: np.ndarray) -> np.ndarray:
    """xx, xy, xz, xw, yy, yz, yw, zz, zw, ww of planes (N, 4)."""
    rows, columns = np.triu_indices(4)
    return plane[:, rows] * plane[:, columns]
