"""What silk and metal reflect: a small round picture of the hall, by rays once it is lit, painted before."""

from __future__ import annotations

from io import BytesIO
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hall_app.room.surface.palette import MATERIALS, linear

if TYPE_CHECKING:
    from hall_app.content.schema import PlanFile
    from hall_app.light.model import LightMap, Surfaces

__all__ = ["environment_jpeg", "painted", "seen"]

_SIZE = (256, 512)  # [pixels] height, width
_QUALITY = 88


def environment_jpeg(picture: NDArray[np.float64]) -> bytes:
    """A plain equirectangular JPEG of (256, 512, 3) linear light."""
    from PIL import Image

    stored = np.clip(picture, 0, 1)
    srgb = np.where(stored <= 0.0031308, 12.92 * stored, 1.055 * stored ** (1 / 2.4) - 0.055)
    stream = BytesIO()
    image = Image.fromarray(np.round(255 * srgb).astype(np.uint8))
    image.save(stream, "JPEG", quality=_QUALITY, optimize=True)
    return stream.getvalue()


def seen(plan: PlanFile, walls: Surfaces, light: LightMap) -> NDArray[np.float64]:
    """(256, 512, 3) linear light: the lit room round the middle of its largest bay, four rays a pixel."""
    from hall_app.light.rays import build_tree, cast

    eye = np.array([*_middle(plan)])
    inside = walls.chart >= 0  # the room without the exhibits: none shall mirror itself
    faces = walls.faces[inside]
    tree = build_tree(walls.vertices, faces)
    fine = _directions(2)
    way = fine.reshape(-1, 3)
    face, _, *bary = cast(tree, np.broadcast_to(eye, way.shape), way)
    met = np.maximum(face, 0)
    corners = light.uv[inside][met]
    u, v = (coordinate[:, None] for coordinate in bary)
    place = corners[:, 0] * (1 - u - v) + corners[:, 1] * u + corners[:, 2] * v
    high, wide = light.image.shape[:2]
    texel = np.clip((place * [wide, high]).astype(int), 0, [wide - 1, high - 1])
    colour = walls.albedo[inside][met] * light.image[texel[:, 1], texel[:, 0]] * light.gain
    glow = walls.emission[inside][met]
    lamp = glow.max(1) > 0
    colour[lamp] = glow[lamp] / glow[lamp].max(1, keepdims=True)
    colour[face < 0] = 0.0
    return np.asarray(colour.reshape(*fine.shape).reshape(_SIZE[0], 2, _SIZE[1], 2, 3).mean((1, 3)), float)


def _middle(plan: PlanFile) -> tuple[float, float, float]:
    """The eye: in the middle of the bay with the most floor, at a breast's height [m]."""
    import shapely

    rings = [bay.polygon for bay in plan.bay] or [plan.outline]
    spot = max((shapely.Polygon(ring) for ring in rings), key=lambda shape: shape.area).representative_point()
    return spot.x, 1.4, spot.y


def painted() -> NDArray[np.float64]:
    """(256, 512, 3) linear light: a hall with laylights, windows and grey floor, for a room that is not lit yet."""
    way = _directions()
    x, y, z = np.moveaxis(way, -1, 0)
    picture = _walls(x, y, z)
    ground = y < -0.22 * np.hypot(x, z)
    picture[ground] = _floor(-y[ground])
    up = y > 0.02
    reach = 3.6 / np.maximum(y, 0.02)
    at_x, at_z = x * reach, z * reach
    over = up & (np.abs(at_x) < 9) & (np.abs(at_z) < 9)
    picture[over] = 0.55 * linear(MATERIALS["ceiling"].colour)
    picture[over & (np.abs((at_z + 1.0) % 2.0 - 1.0) < 0.12)] = 0.6 * linear(MATERIALS["lacquer"].colour)
    light = linear(MATERIALS["laylight"].tint)
    for low_x, high_x, low_z, high_z in (
        (-1.6, 1.6, -6.5, 6.5),
        (4.5, 7.5, -5, -2),
        (4.5, 7.5, 2, 5),
        (-7.5, -4.5, -5, -2),
        (-7.5, -4.5, 2, 5),
    ):
        well = over & (at_x > low_x) & (at_x < high_x) & (at_z > low_z) & (at_z < high_z)
        bars = (np.abs((at_z + 0.5) % 1.0 - 0.5) < 0.05) | (np.abs((at_x + 0.4) % 0.8 - 0.4) < 0.04)
        picture[well & ~bars] = light
    return picture


def _directions(finer: int = 1) -> NDArray[np.float64]:
    """(256, 512, 3) unit vectors of the picture's pixels, +x in the middle, +z to its right, as three.js has it."""
    high, wide = finer * _SIZE[0], finer * _SIZE[1]
    polar = np.pi * (np.arange(high) + 0.5)[:, None] / high
    turn = 2 * np.pi * ((np.arange(wide) + 0.5)[None, :] / wide - 0.5)
    flat = np.sin(polar)
    return np.stack(
        [flat * np.cos(turn), np.broadcast_to(np.cos(polar), (high, wide)), flat * np.sin(turn)], axis=-1
    )


def _walls(x: NDArray, y: NDArray, z: NDArray) -> NDArray[np.float64]:
    """A ring of plaster, wainscot, timber and four pairs of windows, lighter above than below."""
    slope = y / np.maximum(np.hypot(x, z), 1e-6)
    picture = 0.62 * (1 + 0.25 * slope.clip(-0.5, 0.6))[..., None] * linear(MATERIALS["plaster"].colour)
    picture[slope < -0.08] = 0.45 * linear(MATERIALS["panel"].colour)
    picture[np.abs(slope + 0.07) < 0.015] = 0.5 * linear(MATERIALS["lacquer"].colour)
    picture[(slope > 0.26) & (slope < 0.33)] = 0.6 * linear(MATERIALS["band"].colour)
    picture[slope >= 0.33] = 0.5 * linear(MATERIALS["lacquer"].colour)
    turn = np.degrees(np.arctan2(z, x)) % 90
    pillar = np.abs(turn - 24) < 2.2
    picture[pillar & (slope > -0.5) & (slope < 0.33)] = 0.45 * linear(MATERIALS["lacquer"].colour)
    window = (np.abs(turn - 45) < 8) & (slope > -0.03) & (slope < 0.2)
    bars = np.abs((turn % 2.0) - 1.0) < 0.25
    picture[window & ~bars] = 0.95 * linear(MATERIALS["paper"].tint)
    return picture


def _floor(down: NDArray) -> NDArray[np.float64]:
    """Grey tiles, lighter under the laylight."""
    return (0.34 + 0.34 * down)[:, None] * linear(MATERIALS["floor"].colour)
