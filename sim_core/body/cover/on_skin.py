"""Close dress that goes with a figure's skin: a bodice and trousers, cut out of the figure's own surface and let out.

Heights are those of the T-pose.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.ndimage import gaussian_filter1d
from scipy.spatial import KDTree

from sim_core.body.joints import JOINTS
from sim_core.body.mannequin import Colour, Mannequin, Piece

__all__ = ["on_skin"]

TOP = 0.030  # [m] above the bust that a bodice (抹胸) begins
OVER = 0.055  # [m] above the hips that it ends, over the trousers
HEM = 0.030  # [m] above the ankles that trousers end
EASE, OUTER = 0.0005, 0.001  # [m] off the skin: of what is worn next to it, and of what is worn over that
EDGE = 0.001  # [m] within which an edge rises from the skin
WIDE = (0.056, 0.062)  # [m] half a trouser leg at least, at its hem and at the knee
FORK = (0.11, -0.03)  # [m] below and above the crotch between which a leg becomes the trunk
NEAR = 0.0004  # [m] from a line that a vertex is moved onto it
ALIKE = 1e-6  # [m] from the mirror image of another vertex
STEP = 0.01  # [m] between sections of a leg


def on_skin(figure: Mannequin, bodice: Colour | None, trousers: Colour | None) -> Mannequin:
    """The figure in a bodice and trousers of these colours (None: without), with vertices on every edge of them."""
    marks = figure.marks
    top, over = float(marks["bust"][1]) + TOP, float(marks["hip"][1]) + OVER
    waist = 0.5 * (over + float(marks["waist"][1]))
    hem = float(figure.heads[JOINTS.index("ankle_l"), 1]) + HEM
    lines = [top, top - EDGE, over, over + EDGE] if bodice else []
    lines += [hem, hem + EDGE] + ([] if bodice else [waist, waist - EDGE]) if trousers else []
    # No face is its own mirror image: it would be cut one way round.
    figure = _cut(_evened(figure), 0.0, axis=0)
    for line in lines:
        figure = _cut(figure, line)
    y, body = figure.vertices[:, 1], figure.trunk()
    pieces, off = list[Piece](), np.zeros(len(y))
    x = figure.vertices.copy()
    if trousers:
        above = over if bodice else waist
        pieces.append(Piece("trousers", trousers, body & _within(y, hem, above)))
        grown = _rises(y - hem) * (1.0 if bodice else _rises(waist - y))
        off = np.where(pieces[-1].vertices, EASE * grown, off)
        x[:, [0, 2]] += (pieces[-1].vertices * _rises(y - hem))[:, None] * _hanging(figure, hem)
    if bodice:
        pieces.append(Piece("bodice", bodice, body & _within(y, over, top)))
        beneath = EASE if trousers else 0.0
        rise = np.minimum(beneath + (OUTER - beneath) * _rises(y - over), OUTER * _rises(top - y))
        off = np.where(pieces[-1].vertices, rise, off)
    x = _mirrored(figure.vertices, x + off[:, None] * _normals(figure))
    return replace(figure, name=f"{figure.name}, covered", vertices=x, pieces=tuple(pieces))


def _within(y: np.ndarray, low: float, high: float) -> np.ndarray:
    return (y > low - 1e-9) & (y < high + 1e-9)


def _rises(way: np.ndarray) -> np.ndarray:
    """0 at an edge, 1 from EDGE on."""
    return np.clip(way / EDGE, 0.0, 1.0)


def _hanging(figure: Mannequin, hem: float) -> np.ndarray:
    """How far (V, 2) [m], along x and z, trouser legs hang off the legs' skin: nowhere slimmer than WIDE."""
    fork, knee = float(figure.marks["crotch"][1]), float(figure.heads[JOINTS.index("knee_l"), 1])
    x, out = figure.vertices, np.zeros((len(figure.vertices), 2))
    heights = np.arange(hem - STEP, fork + STEP, STEP)
    for side in (1.0, -1.0):
        leg = (side * x[:, 0] > 0) & figure.trunk() & (x[:, 1] > hem - 2 * STEP) & (x[:, 1] < fork + 2 * STEP)
        middle, half = _sections(x[leg], heights)
        at = np.column_stack([np.interp(x[leg, 1], heights, column) for column in (*middle.T, *half.T)])
        wide = np.interp(x[leg, 1], [hem, knee], WIDE)[:, None]
        out[leg] = (x[leg][:, [0, 2]] - at[:, :2]) * (np.maximum(wide / at[:, 2:], 1.0) - 1.0)
    share = np.interp(x[:, 1], [fork - FORK[0], fork - FORK[1]], [1.0, 0.0])
    out *= (share * share * (3 - 2 * share))[:, None]
    # Neither leg goes over the middle.
    room = np.minimum(np.abs(x[:, 0]), 0.004)
    beyond = np.abs(x[:, 0]) + np.sign(x[:, 0]) * out[:, 0] < room
    out[beyond, 0] = (np.sign(x[:, 0]) * room - x[:, 0])[beyond]
    return out


def _sections(x: np.ndarray, heights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Middles and half widths (H, 2) [m], along x and z, of a leg (N, 3) at heights (H,), smoothed along it."""
    lows, highs = (np.zeros((len(heights), 2)) for _ in range(2))
    for k, height in enumerate(heights):
        away = np.abs(x[:, 1] - height)
        near = x[away <= max(1.5 * STEP, float(np.sort(away)[min(7, len(away) - 1)]))][:, [0, 2]]
        lows[k], highs[k] = near.min(0), near.max(0)
    lows, highs = (gaussian_filter1d(each, 2.0, axis=0, mode="nearest") for each in (lows, highs))
    return 0.5 * (lows + highs), 0.5 * (highs - lows)


def _normals(figure: Mannequin) -> np.ndarray:
    from sim_core.picture import normals

    return normals(figure.vertices, figure.faces)


def _evened(figure: Mannequin) -> Mannequin:
    """The figure with a point in every pair of faces across the middle that go the other way round in the mirror."""
    away, twin = _twins(figure.vertices)
    faces = figure.faces
    edges = _edges(faces)
    there = {(int(a), int(b)) for a, b in edges}
    if away.max() > ALIKE:
        return figure
    pairs: dict[tuple[int, int], list[int]] = {}
    for k, (a, b) in enumerate(edges):
        if (int(min(twin[a], twin[b])), int(max(twin[a], twin[b]))) not in there:
            pairs.setdefault((int(a), int(b)), []).append(k // 3)
    own = np.array(list(pairs.values()), int).reshape(-1, 2)
    corners = np.array([np.unique(faces[pair]) for pair in own], int).reshape(-1, 4)
    number = len(figure.vertices) + np.arange(len(own))
    new = [np.zeros((0, 3), int)]
    for (a, b), pair, middle in zip(pairs, own, number, strict=True):
        for face in faces[pair]:
            ring = [int(k) for k in face]
            sides = [(i, j) for i, j in zip(ring, ring[1:] + ring[:1], strict=True) if {i, j} != {a, b}]
            new.append(np.array([(i, j, middle) for i, j in sides]))
    kept = np.delete(faces, own.ravel(), axis=0)
    return replace(
        figure,
        vertices=np.concatenate([figure.vertices, figure.vertices[corners].mean(1) * [0.0, 1.0, 1.0]]),
        weights=np.concatenate([figure.weights, figure.weights[corners].mean(1)]),
        faces=np.concatenate([kept, *new]).astype(np.int32),
    )


def _edges(faces: np.ndarray) -> np.ndarray:
    """The three edges (3 F, 2) of every face, one face after another, the lower vertex first."""
    return np.sort(np.stack([faces, np.roll(faces, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1)


def _twins(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Distances (V,) [m] of the mirror images of vertices (V, 3) from the nearest vertex, and which (V,) that is."""
    away, nearest = KDTree(x).query(x * [-1.0, 1.0, 1.0])
    return np.asarray(away), np.asarray(nearest)


def _mirrored(before: np.ndarray, after: np.ndarray) -> np.ndarray:
    """Vertices (V, 3) [m] moved to `after`, as far to both sides where they were their own mirror image `before`."""
    away, twin = _twins(before)
    return 0.5 * (after + after[twin] * [-1.0, 1.0, 1.0]) if away.max() < ALIKE else after


def _cut(figure: Mannequin, at: float, axis: int = 1) -> Mannequin:
    """The figure with vertices wherever the surface of trunk and legs passes `at` [m] on an axis; the surface stays."""
    x, faces = figure.vertices.copy(), figure.faces
    body = figure.trunk()
    if axis == 1:  # beside the middle a vertex would come to lie on its own mirror image
        x[body & (np.abs(x[:, 1] - at) < NEAR), 1] = at
    side = np.where(body, np.sign(x[:, axis] - at), 0.0)
    ends = _edges(faces)
    ends = np.unique(ends[side[ends[:, 0]] * side[ends[:, 1]] < 0], axis=0)
    share = (at - x[ends[:, 0], axis]) / (x[ends[:, 1], axis] - x[ends[:, 0], axis])
    number = {(int(a), int(b)): len(x) + k for k, (a, b) in enumerate(ends)}

    def between(values: np.ndarray) -> np.ndarray:
        mixed = (1 - share)[:, None] * values[ends[:, 0]] + share[:, None] * values[ends[:, 1]]
        return np.concatenate([values, mixed])

    x = between(x)
    x[len(figure.vertices) :, axis] = at
    crossed = (side[faces] * side[np.roll(faces, -1, axis=1)] < 0).any(1)
    new = [_parted(tuple(int(k) for k in face), number, x) for face in faces[crossed]]
    rest = np.concatenate([faces[~crossed], *new]) if new else faces
    return replace(figure, vertices=x, faces=rest.astype(np.int32), weights=between(figure.weights))


def _parted(face: tuple[int, ...], number: dict[tuple[int, int], int], x: np.ndarray) -> np.ndarray:
    """Faces (2 or 3, 3) of a face of which one edge or two are cut; number: of the vertex on each edge that is.

    What is left of a face beyond two cuts goes along its shorter diagonal, which it does in the mirror, too.
    """
    cuts = [number.get((min(a, b), max(a, b))) for a, b in zip(face, face[1:] + face[:1], strict=True)]
    whole = cuts.index(None)  # the edge that is not cut, or the first of two
    a, b, c = face[whole], face[(whole + 1) % 3], face[(whole + 2) % 3]
    after, before = cuts[(whole + 1) % 3], cuts[(whole + 2) % 3]
    if after is None:
        return np.array([[a, b, before], [b, c, before]])
    if before is None:
        return np.array([[a, b, after], [a, after, c]])
    if np.linalg.norm(x[a] - x[after]) < np.linalg.norm(x[b] - x[before]):
        return np.array([[c, before, after], [a, b, after], [a, after, before]])
    return np.array([[c, before, after], [a, b, before], [b, after, before]])
