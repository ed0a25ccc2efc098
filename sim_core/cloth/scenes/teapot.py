"""The Utah teapot as four closed parts that overlap (body, lid, handle, spout), and its distance field."""

from __future__ import annotations

import tomllib
from functools import lru_cache
from pathlib import Path

import numpy as np
from scipy.spatial import KDTree

from sim_core.cloth.contact.distance_field import field_of
from sim_core.cloth.contact.solids import GridSdf

FILE = Path(__file__).with_name("teapot.toml")
BEAD = 1.2  # radius, in cells, of the bead along the lip of the sampled spout
SINK = 0.1  # how far (in the teapot's own units) the lid reaches down into the body, so that both overlap


def _bernstein(count: int) -> np.ndarray:
    """The four cubic Bernstein polynomials at count + 1 places (count + 1, 4)."""
    t = np.linspace(0, 1, count + 1)
    return np.stack([(1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t**2 * (1 - t), t**3], axis=1)


def _chained(pieces: list[np.ndarray]) -> np.ndarray:
    return np.concatenate([pieces[0], *(piece[1:] for piece in pieces[1:])])


def _turned(profile: np.ndarray, around: int) -> tuple[np.ndarray, np.ndarray]:
    """A closed surface of revolution: profile (N, 2) of radius and height from pole to pole, poles left out."""
    angle = np.linspace(0, 2 * np.pi, around, endpoint=False)
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    inner = profile[1:-1]
    points = np.concatenate(
        [inner[:, None, :1] * ring, np.broadcast_to(inner[:, None, 1:], (len(inner), around, 1))], axis=2
    )
    ends = np.array([[0, 0, profile[0, 1]], [0, 0, profile[-1, 1]]])
    return _closed(points, ends)


def _closed(rings: np.ndarray, ends: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A tube of rings (R, N, 3) closed by fans about its two ends (2, 3); faces outwards."""
    count, around = rings.shape[:2]
    a = np.arange(count * around).reshape(count, around)
    b, first, last = np.roll(a, -1, axis=1), count * around, count * around + 1
    sides = [np.stack([a[:-1], b[:-1], b[1:]], -1), np.stack([a[:-1], b[1:], a[1:]], -1)]
    caps = [
        np.stack([b[0], a[0], np.full(around, first)], -1),
        np.stack([a[-1], b[-1], np.full(around, last)], -1),
    ]
    faces = np.concatenate([f.reshape(-1, 3) for f in (*sides, *caps)]).astype(np.int32)
    points = np.concatenate([rings.reshape(-1, 3), ends])
    p = points[faces]
    volume = np.einsum("fi,fi->", p[:, 0], np.cross(p[:, 1], p[:, 2]))
    return points, faces if volume > 0 else faces[:, ::-1].copy()


def _rings(rows: np.ndarray, steps: int, *, filled: bool) -> np.ndarray:
    """The rings (R, N, 3) of a tube from the control rows (3 K + 1, 4, 3) of its half at y <= 0.

    filled: up to its highest ring.
    """
    base = _bernstein(steps)
    half = _chained(
        [np.einsum("si,tj,ijc->stc", base, base, rows[k : k + 4]) for k in range(0, len(rows) - 1, 3)]
    )
    if filled:
        half = half[: int(np.argmax(half[..., 2].mean(1))) + 1]
    other = half[:, -2:0:-1] * [1, -1, 1]
    return np.concatenate([half, other], axis=1)


def _tube(rows: np.ndarray, steps: int, *, filled: bool) -> tuple[np.ndarray, np.ndarray]:
    """A tube with both its ends closed."""
    rings = _rings(rows, steps, filled=filled)
    return _closed(rings, np.stack([rings[0].mean(0), rings[-1].mean(0)]))


def _lip(steps: int = 12) -> np.ndarray:
    """The ring (N, 3) at which the filled spout ends, in the published axes."""
    spout = np.array(tomllib.loads(FILE.read_text("utf-8"))["tubes"]["spout"], float)
    return _rings(spout, steps, filled=True)[-1]


def teapot_mesh(
    scale: float = 0.1, steps: int = 12, *, filled: bool = False
) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (V, 3) [m] and faces (F, 3) of the teapot standing on y = 0, its spout along +x.

    scale: metres per unit of the published points (6.5 wide, 3.15 high); steps: divisions of a patch. Four closed
    parts, faces outwards, which overlap where they meet. filled: the mouth of the spout is closed at its lip, which
    is too thin for a sampled distance to have a direction there.
    """
    data = tomllib.loads(FILE.read_text("utf-8"))
    base = _bernstein(steps)
    curve = {name: base @ np.array(points, float) for name, points in data["profiles"].items()}
    body = _chained([curve[name] for name in ("bottom", "foot", "belly", "rim")])
    body = np.concatenate([body, [[0.0, body[-1, 1]]]])
    lid = _chained([curve["lid"], curve["knob"]])
    lid = np.concatenate([[[0.0, lid[0, 1] - SINK], [lid[0, 0], lid[0, 1] - SINK]], lid])
    parts = [_turned(body, 4 * steps), _turned(lid, 4 * steps)]
    handle, spout = (np.array(data["tubes"][name], float) for name in ("handle", "spout"))
    parts += [_tube(handle, steps, filled=False), _tube(spout, steps, filled=filled)]
    first = np.cumsum([0, *(len(points) for points, _ in parts)])
    points = np.concatenate([points for points, _ in parts])
    faces = np.concatenate([faces + n for (_, faces), n in zip(parts, first, strict=False)])
    return np.ascontiguousarray(scale * points[:, [0, 2, 1]] * [1, 1, -1]), faces.astype(np.int32)


@lru_cache(maxsize=4)
def teapot_solid(scale: float = 0.1, cell: float = 0.005) -> GridSdf:
    """The teapot's sampled distance field, nodes `cell` [m] apart, exact in the outer 3 cm.

    The lip of the spout has a bead of BEAD cells, sticking out by less than half of that: a sharper edge has no way
    out on a grid, and cloth would sink into it.
    """
    vertices, faces = teapot_mesh(scale, filled=True)
    found = field_of(vertices, faces, cell=cell, band=0.03)
    radius, ring = BEAD * cell, scale * _lip()[:, [0, 2, 1]] * [1, 1, -1]
    middle = ring.mean(0)
    inward = middle - ring
    inward /= np.linalg.norm(inward, axis=1)[:, None]
    axis = np.linalg.svd(ring - middle)[2][2]
    down = axis * -np.sign(axis[1])
    line = _dense(ring + 0.6 * radius * (inward + down), cell / 4)
    low, high = (np.floor((edge - found.origin) / cell).astype(int) for edge in (line.min(0), line.max(0)))
    reach = int(np.ceil(0.03 / cell))
    low, high = np.maximum(low - reach, 0), np.minimum(high + reach + 1, found.values.shape)
    box = tuple(slice(a, b) for a, b in zip(low, high, strict=True))
    axes = [np.arange(a, b) for a, b in zip(low, high, strict=True)]
    nodes = found.origin + cell * np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    found.values[box] = np.minimum(found.values[box], KDTree(line).query(nodes)[0] - radius)
    return found.solid()


def _dense(ring: np.ndarray, step: float) -> np.ndarray:
    """Points (N, 3) at most `step` apart along a closed line (K, 3)."""
    after = np.roll(ring, -1, axis=0)
    count = int(np.ceil(np.linalg.norm(after - ring, axis=1).max() / step))
    share = np.arange(count)[:, None, None] / count
    return (ring + share * (after - ring)).reshape(-1, 3)
