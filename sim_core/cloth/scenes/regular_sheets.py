"""Rows of equilateral triangles between straight sides, without the half-width triangles that cost small steps."""

from __future__ import annotations

from math import sqrt

import numpy as np

from sim_core.errors import WrongArgument

MOST_VERTICES = 400_000
BLEND = 3  # columns over which every other row leans to the straight side


def equilateral_sheet(width: float, height: float, edge: float) -> tuple[np.ndarray, np.ndarray]:
    """Rest (V, 2) [m] and faces (F, 3) of a sheet of rows of triangles; even rows have one vertex more than odd ones.

    Every other row is stretched by half an edge over its last columns, so that the sides are straight. Raises
    WrongArgument for an edge that leaves less than two triangles across, or makes more than 400 000 vertices.
    """
    least, most = sqrt(width * height * 2 / sqrt(3) / MOST_VERTICES), min(width, height) / 2
    if not least <= edge <= most:
        raise WrongArgument(
            f"edge {edge} m – a sheet of {width} x {height} m takes {least:.2g} to {most:.2g} m"
        )
    return _lattice(width, height, max(1, round(width / edge)), max(1, round(height / (edge * sqrt(0.75)))))


def sheet_of(width: float, height: float, vertices: int) -> tuple[np.ndarray, np.ndarray]:
    """The sheet with as nearly so many vertices as its triangles, within 4 % of equilateral, allow.

    Raises WrongArgument if there is none.
    """
    if not 12 <= vertices <= MOST_VERTICES:
        raise WrongArgument(f"vertices: {vertices} – a sheet takes 12 to {MOST_VERTICES}")
    guess = sqrt(width * height * 2 / sqrt(3) / vertices)
    found = []
    for columns in range(max(2, int(width / guess * 0.8)), int(width / guess * 1.25) + 3):
        for rows in range(max(2, int(height / guess)), int(1.5 * height / guess) + 3):
            skew = abs(height / rows / (width / columns * sqrt(0.75)) - 1)
            count = (rows + 1) * columns + rows // 2 + 1
            if skew < 0.04 or vertices < 200:
                found.append((round(abs(count / vertices - 1), 3), skew, columns, rows))
    off, skew, columns, rows = min(found, default=(1.0, 1.0, 0, 0))
    if off > 0.3 or skew > 0.5:
        raise WrongArgument(f"vertices: {vertices} – too few for a sheet of {width} x {height} m")
    return _lattice(width, height, columns, rows)


def _lattice(width: float, height: float, columns: int, rows: int) -> tuple[np.ndarray, np.ndarray]:
    step = width / columns
    even = np.arange(columns + 1) * step
    even[-1] = width
    place = np.arange(columns)
    lean = [np.clip(1 - k / min(BLEND, columns / 2), 0, None) for k in (place, place[::-1])]
    odd = step * (place + 0.5 - 0.5 * lean[0] + 0.5 * lean[1])
    odd[0], odd[-1] = 0.0, width
    lines = [even if row % 2 == 0 else odd for row in range(rows + 1)]
    first = np.cumsum([0, *map(len, lines)])
    rest = np.concatenate(
        [np.stack([x, np.full(len(x), row * height / rows)], axis=1) for row, x in enumerate(lines)]
    )
    faces = []
    for row in range(rows):
        long, short = (first[row], first[row + 1]) if row % 2 == 0 else (first[row + 1], first[row])
        c, inner = long + np.arange(columns), short + np.arange(columns - 1)
        faces.append(np.stack([c, c + 1, short + np.arange(columns)], axis=1))
        faces.append(np.stack([inner, c[1:], inner + 1], axis=1))
    return rest, _facing(rest, np.concatenate(faces))


def disc(diameter: float, edge: float) -> tuple[np.ndarray, np.ndarray]:
    """Rest (V, 2) [m] and faces (F, 3) of a round sheet about the origin: rings of equilateral triangles."""
    rings = max(2, round(diameter / 2 / edge))
    rest, first = [np.zeros((1, 2))], [0]
    for k in range(1, rings + 1):
        angle = 2 * np.pi * np.arange(6 * k) / (6 * k)
        rest.append(diameter / 2 * k / rings * np.stack([np.cos(angle), np.sin(angle)], axis=1))
        first.append(first[-1] + (6 * (k - 1) or 1))
    faces = []
    for k in range(1, rings + 1):
        outer, inner = 6 * k, 6 * (k - 1)
        for side in range(6):
            for t in range(k):
                a = first[k] + (side * k + t) % outer
                b = first[k] + (side * k + t + 1) % outer
                c = first[k - 1] + ((side * (k - 1) + t) % inner if inner else 0)
                faces.append((a, b, c))
                if t > 0:
                    faces.append((a, c, first[k - 1] + (side * (k - 1) + t - 1) % inner))
    points = np.concatenate(rest)
    return points, _facing(points, np.array(faces))


def _facing(rest: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Faces int32 of positive area in (x, -y)."""
    a, b = rest[faces[:, 1]] - rest[faces[:, 0]], rest[faces[:, 2]] - rest[faces[:, 0]]
    turned = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0] > 0
    faces[turned] = faces[turned][:, [0, 2, 1]]
    return faces.astype(np.int32)
