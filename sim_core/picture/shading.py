"""Stills of meshes without a graphics card: smooth two-sided shading, shadows, sky occlusion, sheer cloth."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from sim_core.errors import SimCoreError
from sim_core.picture.fragments import ALPHA, FLOOR, TONES, Scene, Seen, Shadow, developed
from sim_core.picture.raster import (
    LAYERS,
    depth_map,
    fitted,
    nearest_faces,
    open_shares,
    placed,
    sheer_faces,
)
from sim_core.validation.files import written_whole

__all__ = [
    "Camera",
    "Fabric",
    "Light",
    "Lighting",
    "Surface",
    "fan",
    "lighting",
    "normals",
    "render",
    "save_png",
    "split_along",
]

_SKY_DIRECTIONS = 40
_SKY_PIXELS = 320
_SKY_BIAS = 0.012  # [m] likewise, in maps so coarse
_SHADOW_PIXELS = 1400
_BIAS = 0.006  # [m] a surface lies before its own shadow


@dataclass(frozen=True)
class Fabric:
    """A repeat that covers a surface: picture (h, w, 3) uint8 sRGB, size [m] of it across and down."""

    picture: np.ndarray
    size: tuple[float, float]


@dataclass(frozen=True)
class Surface:
    """A mesh to draw: vertices (V, 3) [m], faces (F, 3), sRGB colour 0..1; alpha < 1 is sheer seen head-on.

    gloss, sheen: strengths 0..1; through: share of light that passes thin cloth from behind; fabric: what the colour is
    multiplied by, corners (F, 3, 2) [m] where its faces lie in that, y down.
    """

    vertices: np.ndarray
    faces: np.ndarray
    colour: tuple[float, float, float] = (0.8, 0.8, 0.8)
    alpha: float = 1.0
    gloss: float = 0.0
    sheen: float = 0.0
    through: float = 0.0
    fabric: Fabric | None = None
    corners: np.ndarray | None = None


@dataclass(frozen=True)
class Camera:
    """A pinhole camera at `eye` looking at `target` [m], y up; fov: vertical angle [degrees]."""

    eye: tuple[float, float, float]
    target: tuple[float, float, float]
    fov: float = 30.0


@dataclass(frozen=True)
class Light:
    """One soft key light from direction `key`, sky and ground light; colours linear."""

    key: tuple[float, float, float] = (-0.55, 0.62, 0.56)
    key_colour: tuple[float, float, float] = (0.95, 0.9, 0.82)
    sky: tuple[float, float, float] = (0.52, 0.54, 0.58)
    ground: tuple[float, float, float] = (0.3, 0.27, 0.24)
    background: tuple[float, float, float] = (0.80, 0.77, 0.72)  # sRGB, floor and backdrop


@dataclass(frozen=True)
class Lighting:
    """What no camera changes: the floor, the share of the sky that each vertex of all surfaces sees (V,), one behind
    the other and the floor's last, and the key light's depth maps."""

    light: Light
    ground: Surface | None
    sky: np.ndarray
    shadow: Shadow


def lighting(
    surfaces: Sequence[Surface],
    light: Light | None = None,
    *,
    floor: bool = True,
    sky: np.ndarray | None = None,
) -> Lighting:
    """Light on `surfaces`, for several pictures of the same scene.

    sky: what `Lighting.sky` is to be, such as a mean of what it is shortly before and after; None: it is looked for.
    Raises SimCoreError if a surface has no vertices, wrong shapes or coordinates that are not finite.
    """
    for number, surface in enumerate(surfaces):
        _check(number, surface)
    light = light or Light()
    ground = _floor(surfaces, light) if floor else None
    casting = sum(len(surface.vertices) for surface in surfaces)
    points = _points(surfaces, ground)
    if sky is None:
        ways, faces = fan(_SKY_DIRECTIONS, 0.0, 1.0), _faces(surfaces)
        sky = 0.15 + 0.85 * open_shares(points, casting, faces, ways, _SKY_PIXELS, _SKY_BIAS)
    return Lighting(light, ground, sky, _shadow(surfaces, points[:casting], _unit(light.key)))


def normals(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Area-weighted unit vertex normals (V, 3); zero-length ones point up."""
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    face = np.cross(b - a, c - a)
    total = np.zeros_like(vertices)
    for corner in range(3):
        for axis in range(3):
            total[:, axis] += np.bincount(faces[:, corner], face[:, axis], len(vertices))
    size = np.linalg.norm(total, axis=1, keepdims=True)
    return np.where(size > 0, total / np.maximum(size, 1e-300), [0.0, 1.0, 0.0])


def split_along(faces: np.ndarray, creases: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Faces (F, 3) whose sides of creases, edges (C, 2), have vertices of their own, and of each such vertex (N,) the
    one it was: normals are smooth up to a crease, not over it."""
    if not len(creases):
        return faces, np.arange(int(faces.max(initial=-1)) + 1)
    count = int(faces.max()) + 1
    on = np.isin(np.arange(count), creases)
    corner = np.arange(faces.size).reshape(-1, 3)
    ends = np.stack([faces, np.roll(faces, -1, 1)], 2).reshape(-1, 2)
    own = np.stack([corner, np.roll(corner, -1, 1)], 2).reshape(-1, 2)
    turned = ends[:, 0] > ends[:, 1]
    ends[turned], own[turned] = ends[turned][:, ::-1], own[turned][:, ::-1]
    key = ends[:, 0].astype(np.int64) * count + ends[:, 1]
    low, high = np.sort(creases, axis=1).T.astype(np.int64)
    order = np.argsort(key, kind="stable")
    same = (key[order][1:] == key[order][:-1]) & ~np.isin(key[order][1:], low * count + high)
    one, other = own[order][:-1][same], own[order][1:][same]
    graph = coo_array((np.ones(one.size), (one.ravel(), other.ravel())), shape=(faces.size, faces.size))
    part = connected_components(graph, directed=False)[1].reshape(faces.shape)
    _, first, index = np.unique(
        np.where(on[faces], part + count, faces).ravel(), return_index=True, return_inverse=True
    )
    return index.reshape(faces.shape).astype(np.int32), faces.ravel()[first]


def render(
    surfaces: Sequence[Surface],
    camera: Camera,
    size: tuple[int, int] = (960, 720),
    *,
    light: Light | None = None,
    supersample: int = 2,
    floor: bool = True,
    lit: Lighting | None = None,
) -> np.ndarray:
    """A picture (height, width, 3) uint8 of `surfaces`; size: (width, height) in pixels.

    lit: what `lighting` gave for the same surfaces, in place of light and floor.
    Raises SimCoreError if a surface has no vertices, wrong shapes or coordinates that are not finite.
    """
    lit = lit or lighting(surfaces, light, floor=floor)
    width, height = size[0] * supersample, size[1] * supersample
    scene = _scene(surfaces, lit, camera, width, height)
    backdrop = np.tile(_linear(lit.light.background), (height, 1))
    if lit.ground:  # one colour, a little darker towards the top, and a floor that only shades it: no horizon
        backdrop *= np.linspace(0.80, 1.03, height)[:, None]
    return developed(scene, lit.shadow, _seen(scene, width, height), backdrop, _tones(), supersample)


def _scene(surfaces: Sequence[Surface], lit: Lighting, camera: Camera, width: int, height: int) -> Scene:
    """All surfaces and the floor before the camera."""
    drawn = [*surfaces, lit.ground] if lit.ground else list(surfaces)
    world, light = _points(surfaces, lit.ground), lit.light
    looks = np.array(
        [[*_linear(one.colour), one.gloss, one.sheen, one.through, one.alpha, 0.0] for one in drawn], float
    )
    looks[len(surfaces) :, FLOOR] = 1.0
    texels, tiles = _texels(drawn)
    return Scene(
        screen=_project(world, camera, width, height),
        world=world,
        normals=np.concatenate([normals(np.asarray(one.vertices, float), one.faces) for one in drawn]),
        sky=lit.sky,
        faces=_faces(drawn),
        of=np.repeat(np.arange(len(drawn), dtype=np.int32), [len(one.faces) for one in drawn]),
        looks=looks,
        lights=np.array([camera.eye, _unit(light.key), light.key_colour, light.sky, light.ground], float),
        texels=texels,
        tiles=tiles,
        corners=np.concatenate(
            [np.zeros((len(one.faces), 3, 2)) if one.corners is None else one.corners for one in drawn]
        ),
    )


def _texels(drawn: Sequence[Surface]) -> tuple[np.ndarray, np.ndarray]:
    """The fabrics' linear colours (T, 3) float32, each once, and of every surface (S, 5) where its own are."""
    tiles, texels = np.zeros((len(drawn), 5)), [np.ones((1, 3), np.float32)]
    first, begun = 1, dict[int, int]()
    for number, surface in enumerate(drawn):
        fabric = surface.fabric
        if fabric is None or surface.corners is None:
            continue
        rows, columns = fabric.picture.shape[:2]
        if id(fabric) not in begun:
            begun[id(fabric)] = first
            texels.append(_linear(fabric.picture.reshape(-1, 3) / 255.0).astype(np.float32))
            first += rows * columns
        scale = columns / fabric.size[0], rows / fabric.size[1]
        tiles[number] = begun[id(fabric)], rows, columns, *scale
    return np.concatenate(texels), tiles


def _seen(scene: Scene, width: int, height: int) -> Seen:
    """What is in each pixel."""
    sheer = scene.looks[scene.of, ALPHA] < 1.0
    near, owner = np.zeros((height, width), np.float32), np.full((height, width), -1, np.int32)
    nearest_faces(scene.screen, scene.faces, np.flatnonzero(~sheer), near, owner)
    shape = (height, width) if sheer.any() else (0, 0)
    count, layers = np.zeros(shape, np.uint8), np.zeros((*shape, LAYERS), np.int32)
    if sheer.any():
        depths = np.zeros((*shape, LAYERS), np.float32)
        sheer_faces(scene.screen, scene.faces, np.flatnonzero(sheer), near, count, depths, layers)
    return Seen(owner, count, layers)


def _points(surfaces: Sequence[Surface], ground: Surface | None) -> np.ndarray:
    """The vertices (V, 3) of all, the floor's last."""
    drawn = [*surfaces, ground] if ground else surfaces
    return np.concatenate([np.asarray(one.vertices, float) for one in drawn])


def _faces(surfaces: Sequence[Surface]) -> np.ndarray:
    """Their faces (F, 3) int32, of `_points`."""
    first = np.cumsum([0, *(len(one.vertices) for one in surfaces)])
    faces = [one.faces + start for one, start in zip(surfaces, first[:-1], strict=True)]
    return np.concatenate(faces).astype(np.int32)


def save_png(path: Path, picture: np.ndarray) -> None:
    """Writes a picture (h, w, 3) uint8; raises FileProblem where it cannot."""
    from PIL import Image

    with written_whole(path) as stream:
        Image.fromarray(picture).save(stream, "PNG", optimize=True)


def _check(number: int, surface: Surface) -> None:
    v, f = surface.vertices, surface.faces
    if v.ndim != 2 or v.shape[1] != 3 or len(v) == 0 or f.ndim != 2 or f.shape[1] != 3:
        raise SimCoreError(
            f"surface {number}: shapes {v.shape}, {f.shape} – expected (V, 3) and (F, 3), V > 0"
        )
    if not np.isfinite(v).all():
        raise SimCoreError(f"surface {number}: vertices are not finite – nothing to draw")
    if surface.corners is not None and surface.corners.shape != (len(f), 3, 2):
        raise SimCoreError(
            f"surface {number}: corners {surface.corners.shape} of {len(f)} faces – expected (F, 3, 2)"
        )


def _unit(vector: Sequence[float] | np.ndarray) -> np.ndarray:
    array = np.asarray(vector, float)
    return array / np.linalg.norm(array)


def _linear(srgb: Sequence[float] | np.ndarray) -> np.ndarray:
    c = np.asarray(srgb, float)
    return np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)


def _srgb(linear: np.ndarray) -> np.ndarray:
    c = np.clip(linear, 0, 1)
    return np.where(c <= 0.0031308, 12.92 * c, 1.055 * c ** (1 / 2.4) - 0.055)


def _axes(forward: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    side = np.cross(forward, [0.0, 1.0, 0.0] if abs(forward[1]) < 0.99 else [0.0, 0.0, -1.0])
    side /= np.linalg.norm(side)
    return side, np.cross(side, forward)


def fan(count: int, first: float, last: float) -> np.ndarray:
    """Evenly spread directions (K, 3, 3) to look from, whose elevations have sines between first and last.

    Of each: to the right, up and away from the eye.
    """
    golden, ways = np.pi * (3 - np.sqrt(5)), []
    for k in range(count):
        y = first + (last - first) * (k + 0.5) / count
        ring = np.sqrt(1 - y * y)
        away = -np.array([ring * np.cos(golden * k), y, ring * np.sin(golden * k)])
        ways.append([*_axes(away), away])
    return np.array(ways)


def _project(points: np.ndarray, camera: Camera, width: int, height: int) -> np.ndarray:
    """Screen x, y [pixel] and 1 / distance (<= 0 behind the camera), (V, 3)."""
    eye = np.asarray(camera.eye, float)
    forward = _unit(np.asarray(camera.target, float) - eye)
    side, up = _axes(forward)
    away = points - eye
    z = away @ forward
    scale = 0.5 * height / np.tan(np.radians(camera.fov) / 2) / np.where(z > 1e-3, z, 1.0)
    inverse = np.where(z > 1e-3, 1 / np.where(z > 1e-3, z, 1.0), 0.0)
    return np.stack(
        [0.5 * width + (away @ side) * scale, 0.5 * height - (away @ up) * scale, inverse], axis=1
    )


def _shadow(surfaces: Sequence[Surface], points: np.ndarray, key: np.ndarray) -> Shadow:
    """The key light's depth maps of the opaque and of the sheer, and how much the sheer holds back."""
    matrix, at = np.zeros((3, 4)), np.zeros_like(points)
    fitted(points, np.stack([*_axes(-key), -key]), _SHADOW_PIXELS, matrix)
    placed(points, matrix, at)
    sheer = np.repeat([one.alpha < 1 for one in surfaces], [len(one.faces) for one in surfaces])
    faces, maps = _faces(surfaces), []
    for which in (~sheer, sheer):
        pixels = _SHADOW_PIXELS if which.any() else 0
        depth = np.full((pixels, pixels), np.inf, np.float32)
        depth_map(at, faces[which], depth)
        maps.append(depth)
    veil = 0.7 * max((one.alpha for one in surfaces if one.alpha < 1), default=0.0)
    return Shadow(matrix, maps[0], maps[1], veil, _BIAS)


@cache
def _tones() -> np.ndarray:
    """sRGB (TONES + 1,) uint8 of linear light from 0 to 1."""
    return (255 * _srgb(np.linspace(0.0, 1.0, TONES + 1)) + 0.5).astype(np.uint8)


def _floor(surfaces: Sequence[Surface], light: Light) -> Surface:
    """A fine square under everything, so that it can carry the sky's occlusion as a soft shadow."""
    points = np.concatenate([s.vertices for s in surfaces])
    low, high = points.min(0), points.max(0)
    centre, reach, n = (
        (low + high) / 2,
        1.2 * float(max(np.ptp(points[:, 0]), np.ptp(points[:, 2]))) + 1.0,
        96,
    )
    x, z = np.meshgrid(np.linspace(-reach, reach, n), np.linspace(-reach, reach, n), indexing="ij")
    vertices = np.stack([centre[0] + x.ravel(), np.full(n * n, low[1] - 1e-4), centre[2] + z.ravel()], axis=1)
    a = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    faces = np.concatenate([np.stack([a, a + 1, a + n], 1), np.stack([a + 1, a + n + 1, a + n], 1)])
    return Surface(vertices, faces.astype(np.int32), light.background)
