"""A size field: shorter edges around given points, growing outward no faster than a bounded gradation."""

from dataclasses import dataclass
from functools import cached_property
from math import isfinite
from pathlib import Path

import numpy as np

from sim_core.errors import FileProblem, OutlineError
from sim_core.mesh.geometry.nearest import SizeBoxes, least_sizes, size_boxes
from sim_core.validation.files import read_json, shown

__all__ = ["SizeField", "check_numbers", "read_size_field"]

SHORTEST = 64  # a point's edge is at least edge / SHORTEST
LARGEST = 1e6  # [m] sizes and places beyond this are no metres


def check_numbers(path: Path, name: str, rows: object, shape: str) -> None:
    """Raise FileProblem naming the first row of a list that holds something else than numbers.

    rows: what the file holds under `name`; other faults of shape are left to whoever makes an array of it.
    shape: such as "[x, y] in metres".
    """
    if not isinstance(rows, list):
        return
    for k, row in enumerate(rows):
        for value in row if isinstance(row, list) else [row]:
            if isinstance(value, bool | str) or value is None:
                raise FileProblem(f"{path}: {name}: point {k} is {shown(row)} – give numbers, {shape}")


@dataclass(frozen=True, eq=False)
class SizeField:
    """Edge length by place: min(edge, h_i + gradation * distance to point i). Its gradient is at most the gradation.

    points: (k, 2) [m], y down.  sizes: (k,) [m] edge length there.  gradation: [m/m], above 0, at most 1.
    """

    points: np.ndarray
    sizes: np.ndarray
    gradation: float = 0.2

    def __post_init__(self) -> None:
        if self.points.ndim != 2 or self.points.shape[1] != 2 or len(self.points) == 0:
            raise OutlineError(f"size field: points of shape {self.points.shape} – give (k, 2), at least one")
        if self.sizes.shape != (len(self.points),):
            raise OutlineError(f"size field: {self.sizes.shape} sizes for {len(self.points)} points")
        near = (np.abs(self.points) <= LARGEST).all()  # false for NaN too
        if not near or not ((self.sizes > 0) & (self.sizes <= LARGEST)).all():
            raise OutlineError(
                "size field: not finite, or a size that is not positive – give [x, y, size] in metres, "
                f"at most {LARGEST:g}"
            )
        if not (isfinite(self.gradation) and 0 < self.gradation <= 1):
            raise OutlineError(f"size field: gradation {self.gradation} – give a number above 0, at most 1")

    def at(self, points: np.ndarray, edge: float) -> np.ndarray:
        """Edge lengths (n,) [m] at points (n, 2) [m]; `edge` [m] is the longest."""
        places = np.ascontiguousarray(points, dtype=np.float64)
        return least_sizes(places, float(edge), float(self.gradation), *self._boxes)

    @cached_property
    def _boxes(self) -> SizeBoxes:
        return size_boxes(np.asarray(self.points, dtype=np.float64), np.asarray(self.sizes, dtype=np.float64))

    def check(self, edge: float) -> None:
        """Raise OutlineError where a size is far below the edge."""
        least = float(self.sizes.min())
        if least < edge / SHORTEST:
            raise OutlineError(
                f"size field: size {least:g} m is below a {SHORTEST}th of the edge – "
                f"give at least {edge / SHORTEST:.2g} m"
            )


def read_size_field(path: Path) -> SizeField:
    """A size field from JSON {"points": [[x, y, size], …], "gradation": 0.2}, metres. Raises FileProblem."""
    shape = 'it must hold {"points": [[x, y, size], ...], "gradation": 0.2} in metres'
    values = read_json(path, f"a size field (JSON): {shape}")
    if not isinstance(values, dict) or "points" not in values:
        raise FileProblem(f"{path}: points: missing – {shape}")
    unknown = sorted(set(values) - {"points", "gradation"})
    if unknown:
        raise FileProblem(f"{path}: {unknown[0][:80]}: unknown key – {shape}")
    gradation = values.get("gradation", 0.2)
    if isinstance(gradation, bool) or not isinstance(gradation, int | float):
        raise FileProblem(f"{path}: gradation: {shown(gradation)} – give a number above 0, at most 1")
    check_numbers(path, "points", values["points"], "[x, y, size] in metres")
    try:
        rows = np.array(values["points"], dtype=float)
    except (TypeError, ValueError, OverflowError, RecursionError) as error:
        raise FileProblem(f"{path}: points: not a list of [x, y, size] – {shape}") from error
    if rows.ndim != 2 or rows.shape[1] != 3:
        raise FileProblem(f"{path}: points: shape {rows.shape} – {shape}")
    try:
        return SizeField(rows[:, :2], rows[:, 2], float(gradation))
    except OutlineError as error:
        raise FileProblem(f"{path}: {error}") from error
