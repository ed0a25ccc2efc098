"""Meshes of one frame side by side, coloured by how far they are off, scene below scene, as one picture."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sim_core.errors import SimCoreError
from sim_core.validation.files import written_whole

__all__ = ["Shown", "draw_side_by_side"]

VIEW = np.array([0.42, 0.38, 0.82])  # from the cloth to who looks at it, y up
LIGHT = np.array([-0.35, 0.75, 0.56])
PLAIN, SOLID = (0.80, 0.78, 0.74), (0.45, 0.38, 0.33)
BEHIND = 0.01  # [m] that what the cloth lies on is taken to be farther off: both are drawn face by face
DIM = 0.45  # share of a colour that a face keeps which the light only grazes
CROWDED = 4000  # faces, from where on a mesh is drawn without its edges


@dataclass(frozen=True)
class Shown:
    """A mesh: positions (V, 3) [m], faces (F, 3), words to stand above it; errors (V,) [m] that colour it, if any;
    solid: vertices and faces of what it lies on, if anything."""

    words: str
    positions: np.ndarray
    faces: np.ndarray
    errors: np.ndarray | None = None
    solid: tuple[np.ndarray, np.ndarray] | None = None


def draw_side_by_side(path: Path, rows: Sequence[Sequence[Shown]]) -> None:
    """Draws a PNG, or a JPEG where the name ends so: a row of meshes each, seen alike, with a scale of errors [mm].

    The scale ends at the 99th percentile of the row's errors. Raises SimCoreError where there is nothing to draw,
    FileProblem where the file cannot be written.
    """
    if not rows or not all(rows):
        raise SimCoreError("rows – give at least one mesh in each")
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    most = max(len(row) for row in rows)
    figure = Figure(figsize=(3.6 * most + 0.9, 3.9 * len(rows)), dpi=110, layout="constrained")
    FigureCanvasAgg(figure)
    grid = figure.subplots(len(rows), most, squeeze=False)
    for axes in grid.flat:
        axes.set_axis_off()
    for cells, row in zip(grid, rows, strict=True):
        _row(figure, cells, row)
    with written_whole(path) as stream:
        figure.savefig(stream, format="jpeg" if path.suffix in (".jpg", ".jpeg") else "png")


def _row(figure: Any, cells: Any, row: Sequence[Shown]) -> None:
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    told = [1e3 * shown.errors for shown in row if shown.errors is not None]
    worst = float(np.percentile(np.concatenate(told), 99)) if told else 1.0
    scale = ScalarMappable(Normalize(0.0, max(worst, 1e-6)), "viridis")
    right = _unit(np.cross([0.0, 1.0, 0.0], VIEW))
    axes = np.stack([right, _unit(np.cross(VIEW, right)), _unit(VIEW)])
    solids = [shown.solid[0] for shown in row if shown.solid is not None]
    everything = np.concatenate([*(shown.positions for shown in row), *solids]) @ axes.T
    low, high = everything.min(0), everything.max(0)
    for cell, shown in zip(cells, row, strict=False):
        _mesh(cell, shown, axes, scale)
        cell.set_xlim(low[0], high[0])
        cell.set_ylim(low[1], high[1])
        cell.set_aspect("equal")
        cell.set_title(shown.words, fontsize=9)
    if told:
        bar = figure.colorbar(scale, ax=list(cells), fraction=0.02, pad=0.01)
        bar.set_label("off by [mm]", fontsize=9)


def _mesh(cell: Any, shown: Shown, axes: np.ndarray, scale: Any) -> None:
    """The faces from behind to the front, each as bright as the light falls on it from either side."""
    from matplotlib.collections import PolyCollection

    corners = np.asarray(shown.positions, float)[shown.faces]
    colours = np.tile(PLAIN, (len(corners), 1))
    if shown.errors is not None:
        colours = scale.to_rgba(1e3 * shown.errors[shown.faces].mean(1))[:, :3]
    edges, behind = np.full(len(corners), len(corners) < CROWDED), np.zeros(len(corners))
    if shown.solid is not None:
        below = np.asarray(shown.solid[0], float)[shown.solid[1]]
        corners = np.concatenate([corners, below])
        colours = np.concatenate([colours, np.tile(SOLID, (len(below), 1))])
        edges = np.concatenate([edges, np.zeros(len(below), bool)])
        behind = np.concatenate([behind, np.full(len(below), BEHIND)])
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    colours = colours * (DIM + (1.0 - DIM) * np.abs(normal @ _unit(LIGHT)))[:, None]
    seen = corners @ axes.T
    order = np.argsort(seen[:, :, 2].mean(1) - behind)
    lines = np.where(edges[:, None], 0.7 * colours, colours)
    drawn = PolyCollection(
        list(seen[order, :, :2]), facecolors=colours[order], edgecolors=lines[order], linewidths=0.25
    )
    cell.add_collection(drawn)


def _unit(vector: Sequence[float] | np.ndarray) -> np.ndarray:
    return np.asarray(vector, float) / np.linalg.norm(vector)
