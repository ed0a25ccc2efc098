"""The paper's Figure 1 as code: axis points, surface points, normals, draw, translate, transform, light, image."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim_core.weave.model import Weave
from sim_core.weave.yarns.geometry import YarnGeometry
from sim_core.weave.yarns.particles.cell import ParticleCell
from sim_core.weave.yarns.paths import strands

__all__ = ["FigureOne", "figure_one", "figure_one_picture"]

SIDES = 192
STEPS = (
    "axis points",
    "surface points",
    "normals",
    "draw",
    "translate",
    "translate repeats",
    "transform",
    "light, image",
)


@dataclass(frozen=True, eq=False)
class FigureOne:
    """What each box of the figure holds.

    axis: (n, 3) [m] points of one warp end.  surface: (n, SIDES, 3) points round it.  normals: (n, SIDES, 3) unit.
    drawn: (h, w) float, that yarn alone under the lamp, NaN elsewhere.  translated: the whole repeat.  tiled: 3 x 3
    repeats by translation.  turned: tiled, seen at an angle.  lit: (h, w, 3) uint8, the image.
    """

    axis: np.ndarray
    surface: np.ndarray
    normals: np.ndarray
    drawn: np.ndarray
    translated: np.ndarray
    tiled: np.ndarray
    turned: np.ndarray
    lit: np.ndarray


def figure_one(weave: Weave, geometry: YarnGeometry | ParticleCell, *, pixels: int = 240) -> FigureOne:
    """The route of Fig. 1 for a relaxed cloth. pixels: height and width of each picture.

    1 axis points: the relaxed particles of a yarn. 2 surface points: its section set round every axis point.
    3 normals: across the section. 4 draw: points to pixels, nearest to the eye on top. 5 translate: the other yarns,
    then whole repeats; exact, since the relaxed repeat is periodic. 6 transform: turned about the weft and looked at.
    7 light: Lambert and a highlight. 8 image.
    """
    systems = strands(weave, geometry)
    lamp = np.array([-0.4, 0.5, 0.77])
    points, normals, colours, thin = [], [], [], []
    first: tuple[np.ndarray, np.ndarray, np.ndarray] | None = None
    for system in systems:
        for number in range(len(system.place)):
            times = -(
                -2 * pixels // system.side.shape[1]
            )  # a third of a pixel apart when one repeat fills the picture
            axis = _dense(system.points(number), system, times)
            surface, normal = _section(axis, system.yarn.width / 2, system.yarn.height / 2)
            colour = np.repeat(np.repeat(system.colour[number], times)[:, None], SIDES, axis=1)
            keep = (colour >= 0).ravel()
            first = first or (axis, surface, normal)
            points.append(surface.reshape(-1, 3)[keep])
            normals.append(normal.reshape(-1, 3)[keep])
            colours.append(system.palette[np.maximum(colour.ravel()[keep], 0)])
            third = np.zeros(colour.shape, bool)
            third[::3] = True  # enough where three repeats fill the picture
            thin.append(third.ravel()[keep])
    assert first is not None
    cloud, facing, tint = np.concatenate(points), np.concatenate(normals), np.concatenate(colours)
    width, height = weave.size
    shifts = np.array([[a * width, b * height, 0.0] for a in range(3) for b in range(3)])
    few = np.concatenate(thin)
    many = (cloud[few][None] + shifts[:, None]).reshape(-1, 3)
    many_facing, many_tint = np.tile(facing[few], (9, 1)), np.tile(tint[few], (9, 1))
    tilt = np.radians(50)
    turn = np.array([[1, 0, 0], [0, np.cos(tilt), -np.sin(tilt)], [0, np.sin(tilt), np.cos(tilt)]]).T
    shade = lambda n: 0.2 + 0.8 * np.clip(n @ lamp, 0, 1)  # noqa: E731
    lit = _splat(many @ turn, _shine(many_tint, many_facing @ turn, lamp), pixels)
    return FigureOne(
        first[0],
        first[1],
        first[2],
        _splat(first[1].reshape(-1, 3), shade(first[2].reshape(-1, 3))[:, None], pixels)[..., 0],
        _splat(cloud, shade(facing)[:, None], pixels)[..., 0],
        _splat(many, shade(many_facing)[:, None], pixels)[..., 0],
        _splat(many @ turn, shade(many_facing @ turn)[:, None], pixels)[..., 0],
        np.rint(np.nan_to_num(np.clip(lit, 0, 1) ** (1 / 2.2), nan=0.06) * 255).astype(np.uint8),
    )


def _dense(points: np.ndarray, system, times: int) -> np.ndarray:
    """Axis points `times` as close on a periodic cubic spline, the repeat closed by its own translation."""
    from scipy.interpolate import CubicSpline

    along = 1 if system.along == "warp" else 0
    knots = np.arange(len(points) + 1)
    t = np.arange(len(points) * times) / times
    rest = CubicSpline(knots, np.vstack([points, points[:1]])[:, [1 - along, 2]], bc_type="periodic")(t)
    made = np.column_stack([rest, rest])
    made[:, 1 - along], made[:, 2] = rest[:, 0], rest[:, 1]
    made[:, along] = t / len(points) * system.length
    return made[:, :3]


def _section(axis: np.ndarray, half_width: float, half_height: float) -> tuple[np.ndarray, np.ndarray]:
    tangent = np.gradient(axis, axis=0)
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    across = np.cross([0.0, 0.0, 1.0], tangent)
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    up = np.cross(tangent, across)
    angle = 2 * np.pi * np.arange(SIDES) / SIDES
    cosine, sine = np.cos(angle)[:, None], np.sin(angle)[:, None]
    surface = axis[:, None] + half_width * cosine * across[:, None] + half_height * sine * up[:, None]
    normal = cosine / half_width * across[:, None] + sine / half_height * up[:, None]
    return surface, normal / np.linalg.norm(normal, axis=2, keepdims=True)


def _shine(tint: np.ndarray, normal: np.ndarray, lamp: np.ndarray) -> np.ndarray:
    half = (lamp + [0, 0, 1]) / np.linalg.norm(lamp + [0, 0, 1])
    diffuse = 0.2 + 0.8 * np.clip(normal @ lamp, 0, 1)
    return tint**2.2 * diffuse[:, None] + 0.2 * np.clip(normal @ half, 0, 1)[:, None] ** 30


def _splat(points: np.ndarray, values: np.ndarray, pixels: int) -> np.ndarray:
    """(pixels, pixels, c) of the value of the highest point in each pixel, NaN where there is none."""
    low, high = points[:, :2].min(axis=0), points[:, :2].max(axis=0)
    scale = (pixels - 1) / float((high - low).max())
    offset = (pixels - 1 - (high - low) * scale) / 2
    column, row = np.rint((points[:, :2] - low) * scale + offset).astype(int).T
    picture = np.full((pixels, pixels, values.shape[1]), np.nan)
    order = np.argsort(points[:, 2], kind="stable")  # later ones lie higher and are kept
    picture[pixels - 1 - row[order], column[order]] = values[order]
    return picture


def figure_one_picture(figure: FigureOne) -> np.ndarray:
    """The eight steps side by side, two rows of four: (2 n, 4 n, 3) uint8."""
    n = len(figure.drawn)
    pace = max(1, len(figure.axis) // 60)
    dots = _splat(figure.axis[::pace], np.ones((len(figure.axis[::pace]), 1)), n)
    cloud = figure.surface[::pace, ::16].reshape(-1, 3)
    facing = figure.normals[::pace, ::16].reshape(-1, 3)
    front = facing[:, 2] >= 0
    grey = [
        dots, _splat(cloud[front], np.full((int(front.sum()), 1), 0.8), n),
        _splat(cloud[front], facing[front] / 2 + 0.5, n),
        figure.drawn[..., None], figure.translated[..., None], figure.tiled[..., None], figure.turned[..., None],
    ]  # fmt: skip
    shown = [
        np.rint(np.nan_to_num(np.broadcast_to(_dots(g) if k < 3 else g, (n, n, 3)), nan=0.06) * 255).astype(
            np.uint8
        )
        for k, g in enumerate(grey)
    ]
    shown.append(figure.lit)
    return np.asarray(_captioned(np.vstack([np.hstack(shown[:4]), np.hstack(shown[4:])]), n))


def _dots(picture: np.ndarray) -> np.ndarray:
    """Every point 2 x 2 pixels large."""
    for axis in (0, 1):
        picture = np.where(np.isnan(picture), np.roll(picture, 1, axis=axis), picture)
    return picture


def _captioned(picture: np.ndarray, n: int):
    from PIL import Image, ImageDraw, ImageFont

    image = Image.fromarray(picture)
    pen, font = ImageDraw.Draw(image), ImageFont.load_default(max(10, n // 17))
    for k, step in enumerate(STEPS):
        corner = k % 4 * n, k // 4 * n
        pen.rectangle((*corner, corner[0] + n - 1, corner[1] + n // 12), fill=(15, 15, 15))
        pen.text((corner[0] + 4, corner[1] + 1), f"{k + 1} {step}", fill=(240, 240, 235), font=font)
    return image
