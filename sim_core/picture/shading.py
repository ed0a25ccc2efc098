"""Stills of meshes without a graphics card: smooth two-sided shading, shadows, sky occlusion, sheer cloth."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sim_core.errors import SimCoreError
from sim_core.picture.raster import LAYERS, Projected, Shadow, compose, depth_map, fragments
from sim_core.picture.raster import lit as lit_share
from sim_core.validation.files import written_whole

__all__ = ["Camera", "Light", "Lighting", "Surface", "lighting", "normals", "render", "save_png"]

_SKY_DIRECTIONS = 40
_SKY_PIXELS = 320
_SHADOW_PIXELS = 1400
_BIAS = 0.006  # [m] a surface lies before its own shadow


@dataclass(frozen=True)
class Surface:
    """A mesh to draw: vertices (V, 3) [m], faces (F, 3), sRGB colour 0..1; alpha < 1 is sheer seen head-on.

    gloss, sheen: strengths 0..1; through: share of light that passes thin cloth from behind.
    """

    vertices: np.ndarray
    faces: np.ndarray
    colour: tuple[float, float, float] = (0.8, 0.8, 0.8)
    alpha: float = 1.0
    gloss: float = 0.0
    sheen: float = 0.0
    through: float = 0.0


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
    """What no camera changes: the floor, each surface's view of the sky (V,), the key light's depth maps."""

    light: Light
    ground: Surface | None
    skies: tuple[np.ndarray, ...]
    shadow: Shadow


def lighting(surfaces: Sequence[Surface], light: Light | None = None, *, floor: bool = True) -> Lighting:
    """Light on `surfaces`, for several pictures of the same scene.

    Raises SimCoreError if a surface has no vertices, wrong shapes or coordinates that are not finite.
    """
    for number, surface in enumerate(surfaces):
        _check(number, surface)
    light = light or Light()
    ground = _floor(surfaces, light) if floor else None
    drawn = [*surfaces, ground] if ground else list(surfaces)
    skies = tuple(_sky_visibility(drawn, len(surfaces)))
    return Lighting(light, ground, skies, _shadow(surfaces, _unit(light.key)))


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
    light, width, height = lit.light, size[0] * supersample, size[1] * supersample
    image = np.broadcast_to(_linear(light.background), (height, width, 3)).astype(np.float64).copy()
    if lit.ground:
        _backdrop(image)
    depth = np.zeros((height, width))
    sheer = any(surface.alpha < 1 for surface in surfaces)
    layer_shape = (height, width, LAYERS) if sheer else (1, 1, LAYERS)
    layer_depth = np.full(layer_shape, np.inf, np.float32)
    layer_colour = np.zeros((*layer_shape, 4), np.float32)
    scene = np.array([camera.eye, _unit(light.key), light.key_colour, light.sky, light.ground], float)
    target = (depth, image, layer_depth, layer_colour)
    drawn = [*surfaces, lit.ground] if lit.ground else list(surfaces)
    for surface, sky in zip(drawn, lit.skies, strict=True):
        screen = _project(surface.vertices, camera, width, height)
        _draw(surface, screen, sky, surface is lit.ground, scene, lit.shadow, target)
    if sheer:
        compose(image, depth, layer_depth, layer_colour)
    small = image.reshape(size[1], supersample, size[0], supersample, 3).mean(axis=(1, 3))
    return (255 * _srgb(small) + 0.5).astype(np.uint8)


def _draw(
    surface: Surface,
    screen: np.ndarray,
    sky: np.ndarray,
    ground: bool,
    scene: np.ndarray,
    shadow: Shadow,
    target: tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray],
) -> None:
    """One surface into the target (depth, image, sheer layers' depths and colours)."""
    world, faces = np.ascontiguousarray(surface.vertices, float), surface.faces.astype(np.int32)
    mesh = Projected(screen, faces, world, normals(world, faces), sky)
    look = np.array([surface.gloss, surface.sheen, surface.through, surface.alpha, float(ground)])
    fragments(mesh, _linear(surface.colour), look, scene, shadow, *target)


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


def _unit(vector: Sequence[float] | np.ndarray) -> np.ndarray:
    array = np.asarray(vector, float)
    return array / np.linalg.norm(array)


def _linear(srgb: Sequence[float]) -> np.ndarray:
    c = np.asarray(srgb, float)
    return np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)


def _srgb(linear: np.ndarray) -> np.ndarray:
    c = np.clip(linear, 0, 1)
    return np.where(c <= 0.0031308, 12.92 * c, 1.055 * c ** (1 / 2.4) - 0.055)


def _axes(forward: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    side = np.cross(forward, [0.0, 1.0, 0.0] if abs(forward[1]) < 0.99 else [0.0, 0.0, -1.0])
    side /= np.linalg.norm(side)
    return side, np.cross(side, forward)


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


def _light_matrix(points: np.ndarray, direction: np.ndarray, pixels: int) -> np.ndarray:
    """(3, 4) parallel projection along `direction` that fits all points; z grows away from the light [m]."""
    side, up = _axes(-direction)
    rows = np.stack([side, up, -direction])
    seen = points @ rows.T
    low, span = seen.min(0), max(float(np.ptp(seen[:, :2], axis=0).max()), 1e-6)
    scale = (pixels - 4) / span
    matrix = np.concatenate([rows, np.zeros((3, 1))], axis=1)
    matrix[:2] *= scale
    matrix[:2, 3] = 2 - low[:2] * scale
    return matrix


def _depths(surfaces: Sequence[Surface], matrix: np.ndarray, pixels: int) -> np.ndarray:
    depth = np.full((pixels, pixels), np.inf)
    for surface in surfaces:
        depth_map(surface.vertices @ matrix[:, :3].T + matrix[:, 3], surface.faces.astype(np.int32), depth)
    return depth


def _shadow(surfaces: Sequence[Surface], key: np.ndarray) -> Shadow:
    """The key light's depth maps of the opaque and of the sheer, and how much the sheer holds back."""
    matrix = _light_matrix(np.concatenate([s.vertices for s in surfaces]), key, _SHADOW_PIXELS)
    opaque, sheer = [s for s in surfaces if s.alpha >= 1], [s for s in surfaces if s.alpha < 1]
    veil = 0.7 * max((s.alpha for s in sheer), default=0.0)
    first, second = (_depths(group, matrix, _SHADOW_PIXELS) for group in (opaque, sheer))
    return Shadow(matrix, first, second, veil, _BIAS)


def _sky_visibility(surfaces: Sequence[Surface], casters: int) -> list[np.ndarray]:
    """Share of the sky each vertex sees, by depth maps from a fixed fan of directions: (V,) per surface."""
    points = np.concatenate([s.vertices for s in surfaces[:casters]])
    total = [np.zeros(len(s.vertices)) for s in surfaces]
    golden = np.pi * (3 - np.sqrt(5))
    for k in range(_SKY_DIRECTIONS):
        y = (k + 0.5) / _SKY_DIRECTIONS
        ring = np.sqrt(1 - y * y)
        direction = np.array([ring * np.cos(golden * k), y, ring * np.sin(golden * k)])
        matrix = _light_matrix(points, direction, _SKY_PIXELS)
        depth = _depths(surfaces[:casters], matrix, _SKY_PIXELS)
        for sum_, surface in zip(total, surfaces, strict=True):
            sum_ += lit_share(surface.vertices @ matrix[:, :3].T + matrix[:, 3], depth, 0.012, 1)
    return [0.15 + 0.85 * sum_ / _SKY_DIRECTIONS for sum_ in total]


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


def _backdrop(image: np.ndarray) -> None:
    """Floor and wall are one colour, a little darker towards the top: no horizon to look at."""
    image *= np.linspace(0.80, 1.03, image.shape[0])[:, None, None]
