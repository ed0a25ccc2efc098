"""The mesh of a shop figure: its field's zero surface with finer cells at hands and feet, mirrored, with weights."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from scipy.spatial import KDTree

from sim_core.body.joints import JOINTS, OTHER_SIDE
from sim_core.body.making.form import SHOULDER, WRIST, FormSettings, crotch_height, figure_field, section
from sim_core.body.making.source import Body
from sim_core.body.mannequin import Mannequin
from sim_core.cloth.contact.distance_field import DistanceField
from sim_core.mesh import split_quads, surface_net

_SHOULDER, _WRIST = JOINTS.index("shoulder_l"), JOINTS.index("wrist_l")
FOLDED = 0.0  # cosine of the angle between neighbouring faces' normals
COARSE, MIDDLE, FINE = 0.0165, 0.0125, 0.0095  # [m] of cells: trunk, feet, hands


def mannequin_of(name: str, body: Body, web: float = 0.0) -> Mannequin:
    """The shop figure of an anatomical body, all its joints posable; web [m]: filled between hand and thumb."""
    scale = float(SHOULDER[1] / body.heads[_SHOULDER, 1])
    body = _scaled(body, scale)
    wide = float(body.heads[_SHOULDER, 0] / SHOULDER[0])
    settings = FormSettings(wide=wide, reach=float(body.heads[_WRIST, 0] - WRIST), web=web)
    field = figure_field(body, settings)
    axes = _axes(settings.reach)
    nodes = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    values = field.at(nodes.reshape(-1, 3)).reshape(nodes.shape[:3])
    vertices, quads = surface_net(0.5 * (values + values[::-1]), axes)
    sides = np.unique(np.sort(quads[:, [0, 1, 1, 2, 2, 3, 3, 0]].reshape(-1, 2), axis=1), axis=0)
    vertices = _relaxed(vertices, sides, field)
    twin = np.asarray(KDTree(vertices * [-1, 1, 1]).query(vertices)[1])
    vertices = 0.5 * (vertices + (vertices * [-1, 1, 1])[twin])
    weights = _weights(vertices, sides, twin, body)
    lift = np.array([0.0, vertices[:, 1].min(), 0.0])
    vertices = vertices - lift
    faces = split_quads(vertices, quads)
    vertices = _unfolded(vertices, faces, twin)
    heads = body.heads - lift
    heads = 0.5 * (heads + (heads * [-1, 1, 1])[list(OTHER_SIDE)])
    marks = {mark: place / scale for mark, place in _marks(vertices, faces, body).items()}
    return Mannequin(name, vertices / scale, faces, heads / scale, weights, marks)


def _scaled(body: Body, scale: float) -> Body:
    low, high = body.neck
    neck = (scale * low, scale * high)
    return replace(body, vertices=scale * body.vertices, heads=scale * body.heads, neck=neck)


def _axis(low: float, high: float, size: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    """Lines from low to high whose spacing follows `size` of the place."""
    x = np.linspace(low, high, 2000)
    density = 1 / size(x)
    count = np.r_[0.0, np.cumsum(0.5 * (density[1:] + density[:-1]) * np.diff(x))]
    return np.interp(np.linspace(0, count[-1], int(np.ceil(count[-1])) + 1), count, x)


def _axes(reach: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Lines of the grid whose cells are laid, finer at hands and feet; hands lie `reach` [m] further out."""
    half = _axis(0.0, 0.84 + reach, lambda x: np.interp(x - reach, [0.50, 0.62], [COARSE, FINE]))
    up = _axis(
        -0.02,
        1.49,
        lambda y: np.interp(
            y, [0.05, 0.12, 1.15, 1.22, 1.30, 1.40], [MIDDLE, COARSE, COARSE, FINE, FINE, MIDDLE]
        ),
    )
    deep = _axis(
        -0.20, 0.26, lambda z: np.interp(z, [-0.06, -0.02, 0.07, 0.10], [COARSE, MIDDLE, MIDDLE, COARSE])
    )
    return np.r_[-half[:0:-1], half], up, deep


def _mean_of_neighbours(x: np.ndarray, sides: np.ndarray) -> np.ndarray:
    out = np.zeros_like(x)
    for here, there in ((0, 1), (1, 0)):
        for c in range(x.shape[1]):
            out[:, c] += np.bincount(sides[:, here], x[sides[:, there], c], len(x))
    return out / np.bincount(sides.ravel(), minlength=len(x))[:, None]


def _relaxed(x: np.ndarray, sides: np.ndarray, field: DistanceField, rounds: int = 25) -> np.ndarray:
    """Vertices spread evenly along the surface and laid exactly on it."""
    for _ in range(rounds):
        move = _mean_of_neighbours(x, sides) - x
        gradient = field.with_gradient(x)[1]
        normal = gradient / np.linalg.norm(gradient, axis=1, keepdims=True)
        x = x + 0.5 * (move - (move * normal).sum(1, keepdims=True) * normal)
        for _ in range(2):
            value, gradient = field.with_gradient(x)
            x = x - (0.9 * value / np.maximum((gradient**2).sum(1), 0.05))[:, None] * gradient
    return x


def _unfolded(x: np.ndarray, faces: np.ndarray, twin: np.ndarray, rounds: int = 20) -> np.ndarray:
    """The surface with its folds drawn out: where two faces turn back on each other, as between thumb and hand."""
    sides, first = np.unique(
        np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0, return_inverse=True
    )
    pair = np.argsort(first.ravel(), kind="stable").reshape(-1, 2) // 3
    for _ in range(rounds):
        normal = np.cross(x[faces[:, 1]] - x[faces[:, 0]], x[faces[:, 2]] - x[faces[:, 0]])
        normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-15)
        folded = (normal[pair[:, 0]] * normal[pair[:, 1]]).sum(1) < FOLDED
        if not folded.any():
            break
        moved = np.zeros(len(x), bool)
        moved[faces[pair[folded]].ravel()] = True
        moved |= moved[twin]
        x = np.where(moved[:, None], 0.5 * (x + _mean_of_neighbours(x, sides)), x)
        x = 0.5 * (x + (x * [-1, 1, 1])[twin])
    return x


def _weights(x: np.ndarray, sides: np.ndarray, twin: np.ndarray, body: Body, rounds: int = 12) -> np.ndarray:
    """Skinning weights (V, 21) from the body's nearest vertices, smoothed over the mesh, mirrored."""
    far, near = KDTree(body.vertices).query(x, 8)
    share = 1 / (far + 0.003)
    weights = (body.weights[near] * (share / share.sum(1, keepdims=True))[..., None]).sum(1)
    for _ in range(rounds):
        weights = 0.5 * (weights + _mean_of_neighbours(weights, sides))
    weights = weights + weights[twin][:, list(OTHER_SIDE)]
    return weights / weights.sum(1, keepdims=True)


def _marks(x: np.ndarray, faces: np.ndarray, body: Body) -> dict[str, np.ndarray]:
    """Places a garment is cut by, measured on the finished figure."""

    def at(y: float) -> np.ndarray:
        points = section(x, faces, y)
        return points[np.abs(points[:, 0]) < 0.3]

    def centre(y: float) -> np.ndarray:
        return np.array([0.0, y, float(at(y)[:, 1].mean())])

    heights = np.arange(0.95, 1.12, 0.005)
    waist = float(heights[np.argmin([np.ptp(at(float(y))[:, 0]) for y in heights])])
    chest = np.arange(1.08, 1.22, 0.005)
    bust = float(chest[np.argmax([at(float(y))[:, 1].max() for y in chest])])
    seat = np.arange(0.75, 0.95, 0.005)
    hip = float(seat[np.argmin([at(float(y))[:, 1].min() for y in seat])])
    neck = body.neck[0] + 0.02
    nape = np.array([0.0, neck, float(at(neck)[:, 1].min())])
    return {
        "neck": centre(neck),
        "nape": nape,
        "bust": centre(bust),
        "waist": centre(waist),
        "hip": centre(hip),
        "crotch": np.array([0.0, crotch_height(body), 0.0]),
        "top": np.array([0.0, x[:, 1].max(), 0.0]),
        "tip_l": x[x[:, 0].argmax()],
        "tip_r": x[x[:, 0].argmin()],
    }
