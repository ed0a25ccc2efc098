"""Fewer triangles where a mesh is flat: vertices slide onto neighbours, seams and borders keep their lines.

Half-edge collapses in the order of their quadric error (Garland and Heckbert 1997). Vertices that stay have kept their
place and their pattern coordinates, so texture coordinates are exact and twins of a seam cannot part.
"""

from __future__ import annotations

import heapq

import numpy as np

__all__ = ["Thinning"]

LINE_WEIGHT = 4.0  # of keeping a border or seam in its line, against keeping a face in its plane
SHAPE_WEIGHT = 2e-3  # of short ways
LEAST_SHAPE = 0.05  # area over longest side squared; 0.43 is equilateral
TURN = 0.2  # cosine between a face's old and new normal


class Thinning:
    """A mesh that is made coarser step by step.

    vertices (V, 3) [m]; pattern (P, 2) [m] or None; faces (F, 3) of pattern vertices; weld (P,) to vertices;
    fixed (V,) bool: vertices that stay where they are.
    """

    def __init__(
        self,
        vertices: np.ndarray,
        faces: np.ndarray,
        weld: np.ndarray,
        pattern: np.ndarray | None = None,
        fixed: np.ndarray | None = None,
    ) -> None:
        self._x = [tuple(p) for p in vertices.tolist()]
        self._flat = None if pattern is None else [tuple(p) for p in pattern.tolist()]
        self._weld = weld.tolist()
        self._faces: list[tuple[int, int, int] | None] = [(a, b, c) for a, b, c in faces.tolist()]
        self.count = len(faces)
        self._around: list[set[int]] = [set() for _ in range(len(vertices))]
        for f, face in enumerate(faces.tolist()):
            for p in face:
                self._around[self._weld[p]].add(f)
        welded = weld[faces]
        self._lines = _line_neighbours(welded, faces, len(vertices))
        self._stays = np.zeros(len(vertices), bool) if fixed is None else fixed.copy()
        self._quadric = _quadrics(vertices, welded, self._lines)
        self._version = [0] * len(vertices)
        self._heap: list[tuple[float, int, int, int]] = []
        for v in range(len(vertices)):
            self._offer(v)

    def faces(self) -> np.ndarray:
        """The faces (F, 3) that are left, of pattern vertices."""
        return np.array([face for face in self._faces if face is not None], np.int32)

    def numbers(self) -> np.ndarray:
        """Which of the first faces (F,) are left, in the order of `faces`."""
        return np.array([number for number, face in enumerate(self._faces) if face is not None], np.int64)

    def to(self, triangles: int) -> None:
        """Collapses edges until at most `triangles` are left, or no collapse is sound."""
        while self.count > triangles and self._heap:
            _, v, u, version = heapq.heappop(self._heap)
            if version == self._version[v] and self._sound(v, u):
                self._collapse(v, u)

    def _neighbours(self, v: int) -> set[int]:
        found = {self._weld[p] for f in self._around[v] for p in self._faces[f] or ()}
        found.discard(v)
        return found

    def _offer(self, v: int) -> None:
        """Puts all ways v may go onto the heap."""
        self._version[v] += 1
        lines = self._lines[v]
        if self._stays[v] or not self._around[v] or len(lines) not in (0, 2):
            return
        x, q = self._x[v], self._quadric[v]
        for u in lines or self._neighbours(v):
            y = self._x[u]
            way = (x[0] - y[0]) ** 2 + (x[1] - y[1]) ** 2 + (x[2] - y[2]) ** 2
            heapq.heappush(
                self._heap, (_error(q, y) + SHAPE_WEIGHT * way * q[9] * 1e-3, v, u, self._version[v])
            )

    def _sound(self, v: int, u: int) -> bool:
        """No pinch, no turned or needle-like face, neither in space nor in the pattern."""
        shared = self._around[v] & self._around[u]
        if not shared or len(self._neighbours(v) & self._neighbours(u)) != len(shared):
            return False
        moved = self._moves(v, u, shared)
        if moved is None:
            return False
        for f in self._around[v] - shared:
            face = self._faces[f]
            assert face is not None
            new = tuple(moved.get(p, p) for p in face)
            if any(self._weld[p] == v for p in new) or not self._fair(face, new):
                return False
        return True

    def _moves(self, v: int, u: int, shared: set[int]) -> dict[int, int] | None:
        """Which pattern vertex takes the place of each twin of v: the twin of u that lies in one face with it."""
        moved: dict[int, int] = {}
        for f in shared:
            face = self._faces[f]
            assert face is not None
            old = next(p for p in face if self._weld[p] == v)
            new = next(p for p in face if self._weld[p] == u)
            if moved.setdefault(old, new) != new:
                return None
        return moved

    def _fair(self, face: tuple[int, ...], new: tuple[int, ...]) -> bool:
        before, after = ([self._x[self._weld[p]] for p in corners] for corners in (face, new))
        n, m = _normal(*before), _normal(*after)
        size = (m[0] ** 2 + m[1] ** 2 + m[2] ** 2) ** 0.5
        old = (n[0] ** 2 + n[1] ** 2 + n[2] ** 2) ** 0.5
        longest = max(_far(after[0], after[1]), _far(after[1], after[2]), _far(after[2], after[0]))
        if 0.5 * size < LEAST_SHAPE * longest:
            return False
        if n[0] * m[0] + n[1] * m[1] + n[2] * m[2] < TURN * old * size:
            return False
        if self._flat is None:
            return True
        (ax, ay), (bx, by), (cx, cy) = (self._flat[p] for p in new)
        # positive in (x, -y)
        return (by - ay) * (cx - ax) - (bx - ax) * (cy - ay) > 0.02 * longest

    def _collapse(self, v: int, u: int) -> None:
        shared = self._around[v] & self._around[u]
        moved = self._moves(v, u, shared)
        assert moved is not None
        ring = self._neighbours(v) | self._neighbours(u)
        for f in shared:
            for p in self._faces[f] or ():
                self._around[self._weld[p]].discard(f)
            self._faces[f] = None
        for f in self._around[v]:
            face = self._faces[f]
            assert face is not None
            a, b, c = (moved.get(p, p) for p in face)
            self._faces[f] = (a, b, c)
            self._around[u].add(f)
        self._around[v] = set()
        self.count -= len(shared)
        for w in self._lines[v]:
            self._lines[w].discard(v)
            if w != u:
                self._lines[w].add(u)
                self._lines[u].add(w)
        self._lines[v] = set()
        self._quadric[u] = [a + b for a, b in zip(self._quadric[u], self._quadric[v], strict=True)]
        self._version[v] += 1
        for w in ring - {v}:
            self._offer(w)


def _normal(a: tuple, b: tuple, c: tuple) -> tuple[float, float, float]:
    ux, uy, uz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    vx, vy, vz = c[0] - a[0], c[1] - a[1], c[2] - a[2]
    return uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx


def _far(a: tuple, b: tuple) -> float:
    return (a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2 + (a[2] - b[2]) ** 2


def _error(q: list[float], p: tuple) -> float:
    """Sum of weighted squared distances of p to all planes in q."""
    x, y, z = p
    square = q[0] * x * x + q[4] * y * y + q[7] * z * z + q[9]
    cross = q[1] * x * y + q[2] * x * z + q[5] * y * z
    return max(square + 2 * (cross + q[3] * x + q[6] * y + q[8] * z), 0.0)


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


def _quadrics(vertices: np.ndarray, faces: np.ndarray, lines: list[set[int]]) -> list[list[float]]:
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
    return total.tolist()


def _products(plane: np.ndarray) -> np.ndarray:
    """xx, xy, xz, xw, yy, yz, yw, zz, zw, ww of planes (N, 4)."""
    rows, columns = np.triu_indices(4)
    return plane[:, rows] * plane[:, columns]
