"""The pictures of the mesh room's README: the paper's Figures 2 and 3 from our own functions, and meshes by quality.

python tests/bench/mesh_pictures.py [FOLDER]        (docs/pictures)
"""

import sys
from pathlib import Path

import numpy as np
from mesh_cases import half_robe
from PIL import Image, ImageDraw, ImageFont

from sim_core.mesh import (
    SizeField,
    inside,
    keep_points,
    mesh_picture,
    panel_mesh,
    sampled_contours,
    staggered_points,
)
from sim_core.mesh.outline import clean_contours

FINE = 2  # drawn so much larger, then reduced
INK, FAINT, RED = (24, 34, 44), (168, 176, 182), (196, 70, 50)


class Sheet:
    """A white page with metres on it, y down."""

    def __init__(self, low, high, width: int) -> None:
        self.low, self.scale = np.asarray(low), width * FINE / (high[0] - low[0])
        size = (width * FINE, int((high[1] - low[1]) * self.scale))
        self.image = Image.new("RGB", size, "white")
        self.draw = ImageDraw.Draw(self.image)
        self.font = ImageFont.load_default(15 * FINE)

    def at(self, point) -> tuple[float, float]:
        x, y = (np.asarray(point) - self.low) * self.scale
        return float(x), float(y)

    def line(self, points, colour, width: int = 2) -> None:
        self.draw.line([self.at(p) for p in points], fill=colour, width=width * FINE)

    def dot(self, point, radius: float, colour, *, hollow: bool = False) -> None:
        x, y = self.at(point)
        r = radius * FINE
        fill = "white" if hollow else colour
        self.draw.ellipse([x - r, y - r, x + r, y + r], fill=fill, outline=colour, width=FINE)

    def text(self, point, words: str, colour=INK) -> None:
        self.draw.text(self.at(point), words, fill=colour, font=self.font)

    def save(self, path: Path) -> None:
        width, height = self.image.size
        self.image.resize((width // FINE, height // FINE), Image.Resampling.LANCZOS).save(path, optimize=True)


def figure_2(path: Path) -> None:
    """Points row by row from the upper left corner, odd rows moved by -L/2; those kept for a panel in black."""
    outline, edge = half_robe(), 0.06
    low, high = outline.min(axis=0), outline.max(axis=0)
    page = Sheet(low - 0.09, high + 0.06, 620)
    contours = clean_contours(outline, ())
    samples = sampled_contours(contours, edge)
    points = staggered_points(low, high, edge)
    kept = {tuple(p) for p in keep_points(points, samples, edge=edge)}
    page.line([*samples[0], samples[0][0]], INK)
    for point in points:
        page.dot(point, 4, INK if tuple(point) in kept else FAINT, hollow=tuple(point) not in kept)
    for point in samples[0]:
        page.dot(point, 3, RED)
    for row, column, name in ((0, 0, "P00"), (0, 1, "P01"), (1, 0, "P10"), (1, 1, "P11"), (2, 0, "P20")):
        columns = int(np.floor((high[0] - low[0]) / edge)) + 2
        page.text(points[row * columns + column] + (0.006, -0.03), name, FAINT)
    page.save(path)


def figure_3(path: Path) -> None:
    """Rays to the right: an odd number of crossings (dots) means inside; hollow points are asked about."""
    t = np.arange(240) * 2 * np.pi / 240
    radius = 1 + 0.22 * np.cos(3 * t + 0.4) + 0.13 * np.sin(5 * t)
    shape = np.column_stack([1.5 * radius * np.cos(t), radius * np.sin(t)])
    page = Sheet((-2.6, -1.45), (2.7, 1.45), 760)
    page.line([*shape, shape[0]], INK, 3)
    page.text((0.9, 0.05), "S")
    asked = {"N": (-2.2, 0.62), "M": (-0.9, -0.25), "P": (-2.3, 0.2), "Q": (-1.2, -0.755)}
    for name, point in asked.items():
        x, y = point
        a, b = shape, np.roll(shape, -1, axis=0)
        crossed = (a[:, 1] > y) != (b[:, 1] > y)  # the half-open rule of `inside`
        a, b = a[crossed], b[crossed]
        where = a[:, 0] + (y - a[:, 1]) * (b[:, 0] - a[:, 0]) / (b[:, 1] - a[:, 1])
        where = np.sort(where[where > x])
        is_in = bool(inside(np.array([point]), [shape])[0])
        if is_in != bool(len(where) % 2):
            raise SystemExit(f"{name}: {len(where)} crossings, but inside says {is_in}")
        page.line([point, (2.6, y)], FAINT)
        for k, cross in enumerate(where, 1):
            page.dot((cross, y), 5, INK)
            page.text((cross + 0.02, y - 0.17), f"{name}{k}")
        page.dot(point, 6, RED if is_in else INK, hollow=True)
        page.text((x - 0.05, y + 0.04), f"{name}: {'inside' if is_in else 'outside'}", RED if is_in else INK)
    page.save(path)


def meshes(folder: Path) -> None:
    """One panel three ways: the paper's method, without small angles, and with a size field and fold lines."""
    robe = half_robe()
    field = SizeField(np.array([[0.05, 0.08], [0.27, 0.37], [0.75, 0.16]]), np.array([0.008, 0.008, 0.012]))
    folds = [[[x, 0.55], [x, 1.15]] for x in (0.1, 0.2)]
    kinds = {
        "mesh-fair": panel_mesh(robe, edge=0.028, quality="fair"),
        "mesh-best": panel_mesh(robe, edge=0.028, quality="best"),
        "mesh-graded": panel_mesh(robe, edge=0.04, quality="best", sizes=field, constraints=folds),
    }
    for name, mesh in kinds.items():
        Image.fromarray(mesh_picture(mesh, size=800)).save(folder / f"{name}.png", optimize=True)


def main() -> int:
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parents[2] / "docs" / "pictures"
    folder.mkdir(parents=True, exist_ok=True)
    figure_2(folder / "mesh-figure2.png")
    figure_3(folder / "mesh-figure3.png")
    meshes(folder)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
