"""The clearance grid: samples of the body's clearance for the page, the minimap and the check of reach."""

from __future__ import annotations

import hashlib
import json
import math
import os
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
import shapely
from scipy import ndimage

from hall_app.walk.body import BODY, Body, world_of
from hall_app.walk.solids import Floor, Prism

CELL = 0.04  # [m] see README.md: error against bytes
SCALE = 1e-4  # [m] per unit of int16: clearances up to 3.27 m, beyond that they are cut
MARGIN = 2  # samples around the outline, for the page's 4 x 4 neighbourhood
GRID_VERSION = 1  # raise it whenever the samples of an unchanged floor would change
_KEPT = 8  # grids in a cache folder: the last few states of a plan being edited

Progress = Callable[[float, str], None]


class UnreachableError(ValueError):
    """No place where the visitor could stand: one line with the remedy."""


@dataclass(frozen=True)
class Reach:
    """Samples of a grid that belong together, and the nearest of them to any sample: found in a millisecond's part.

    mask: (nz, nx) bool. nearest: (2, nz, nx) int16, row and column.
    """

    grid: Grid
    mask: np.ndarray
    nearest: np.ndarray

    def spot(self, x: float, z: float) -> tuple[float, float]:
        """The sample of `mask` nearest to (x, z) [m], within a cell: the best one named by the samples around."""
        grid = self.grid
        (nz, nx), column, row = self.mask.shape, (x - grid.x0) / grid.cell, (z - grid.z0) / grid.cell
        found = []
        for r in {_within(row, nz), _within(row + 1, nz)}:
            for c in {_within(column, nx), _within(column + 1, nx)}:
                iz, ix = self.nearest[:, r, c]
                found.append((float(grid.x0 + ix * grid.cell), float(grid.z0 + iz * grid.cell)))
        return min(found, key=lambda spot: math.hypot(spot[0] - x, spot[1] - z))

    def beside(self, x: float, z: float) -> bool:
        """True if a sample of `mask` is a corner of the cell around (x, z) [m] or beside it."""
        ix, iz = int((x - self.grid.x0) // self.grid.cell), int((z - self.grid.z0) // self.grid.cell)
        rows, columns = slice(max(iz - 1, 0), max(iz + 3, 0)), slice(max(ix - 1, 0), max(ix + 3, 0))
        return bool(self.mask[rows, columns].any())


def _within(index: float, count: int) -> int:
    """The whole number below, inside 0..count-1."""
    return int(min(max(index, 0), count - 1))


@dataclass(frozen=True)
class Grid:
    """Clearance samples: row iz, column ix is the place (x0 + ix * cell, z0 + iz * cell).

    samples: (nz, nx) int16 in units of scale [m], rounded down: never more than FCL says.
    body: whose clearance.
    """

    samples: np.ndarray
    x0: float
    z0: float
    cell: float = CELL
    scale: float = SCALE
    body: Body = BODY

    @property
    def clearance(self) -> np.ndarray:
        """(nz, nx) float64 [m]."""
        return self.samples * self.scale

    @cached_property
    def free(self) -> np.ndarray:
        """(nz, nx) bool: the body can rest here, its skin clear."""
        return self.clearance >= self.body.skin

    @cached_property
    def _labels(self) -> np.ndarray:
        labels, _ = ndimage.label(self.free, structure=np.ones((3, 3)))  # type: ignore[misc]
        return labels

    def meta(self) -> dict[str, float | int]:
        """What the page needs besides the bytes: x0, z0, cell, nx, nz, scale."""
        nz, nx = self.samples.shape
        return {"x0": self.x0, "z0": self.z0, "cell": self.cell, "nx": nx, "nz": nz, "scale": self.scale}

    def to_bytes(self) -> bytes:
        """The samples as little-endian int16, row by row (/grid.bin)."""
        return self.samples.astype("<i2").tobytes()

    @cached_property
    def _reaches(self) -> dict[int, Reach]:
        return {}

    def _reach_of(self, label: int, mask: np.ndarray) -> Reach:
        if label not in self._reaches:
            nearest = ndimage.distance_transform_edt(~mask, return_distances=False, return_indices=True)
            self._reaches[label] = Reach(self, mask, np.asarray(nearest).astype(np.int16))
        return self._reaches[label]

    def nearest_free(self, x: float, z: float) -> tuple[float, float]:
        """The sample nearest to (x, z) [m] where the body can stand. Raises UnreachableError if there is none."""
        if not self.free.any():
            raise UnreachableError(f"no free spot near ({x:g}, {z:g}) – the floor is full, move a solid")
        return self._reach_of(0, self.free).spot(x, z)

    def reach(self, start: tuple[float, float]) -> Reach:
        """What can be reached on foot from the free spot nearest to start (x, z) [m].

        Some 20 ms for the first who asks, nothing for the others: all visitors share it. Raises UnreachableError.
        """
        x, z = self.nearest_free(*start)
        label = int(self._labels[round((z - self.z0) / self.cell), round((x - self.x0) / self.cell)])
        known = self._reaches.get(label)
        return known or self._reach_of(label, self._labels == label)


def flood(grid: Grid, start: tuple[float, float]) -> np.ndarray:
    """(nz, nx) bool: what can be reached on foot from start (x, z) [m].

    Neighbouring free samples, diagonals included, are nearer than Body.leap: the step between them is safe.
    A gap may be missed if it is less than a cell wider than the body and its skin (0.62 + 0.04 m).
    """
    return grid.reach(start).mask


def bake(floor: Floor, *, body: Body = BODY, cell: float = CELL, progress: Progress | None = None) -> Grid:
    """Sample the clearance of the whole floor with FCL; about 6 µs a sample. Safe in several threads.

    Raises ValueError for a cell too wide for safe steps between neighbours.
    """
    if not 2 * cell**2 <= body.leap**2:
        raise ValueError(
            f"cell {cell} m: its diagonal is longer than the safe step {body.leap:.3f} m – use less"
        )
    x0, z0, x1, z1 = floor.bounds
    x0, z0 = x0 - MARGIN * cell, z0 - MARGIN * cell
    nx, nz = (int(np.ceil((end - begin) / cell)) + 1 + MARGIN for begin, end in ((x0, x1), (z0, z1)))
    inside = _inside(floor, x0 + cell * np.arange(nx), z0 + cell * np.arange(nz))
    world = world_of(floor, body)
    samples = np.full((nz, nx), -body.radius)
    for iz in range(nz):
        if progress and iz % 16 == 0:
            progress(iz / nz, "walking grid")
        for ix in np.nonzero(inside[iz])[0]:
            samples[iz, ix] = world.clearance(x0 + ix * cell, z0 + iz * cell)
    if progress:
        progress(1.0, "walking grid")
    units = np.clip(np.floor(samples / SCALE + 1e-6), -32768, 32767)
    return Grid(units.astype(np.int16), x0, z0, cell, SCALE, body)


def _inside(floor: Floor, xs: np.ndarray, zs: np.ndarray) -> np.ndarray:
    shapely.prepare(floor.shape)
    return shapely.contains_xy(floor.shape, xs[None, :], zs[:, None])


def grid_key(floor: Floor, *, body: Body = BODY, cell: float = CELL) -> str:
    """Hash of everything the samples depend on."""
    solids = [
        ["prism", s.polygon] if isinstance(s, Prism) else ["round", s.x, s.z, s.radius] for s in floor.solids
    ]
    what = [GRID_VERSION, floor.outline, solids, body.radius, body.skin, body.core, cell, SCALE, MARGIN]
    return hashlib.sha256(json.dumps(what).encode()).hexdigest()


def cached_grid(
    floor: Floor,
    folder: Path,
    *,
    cell: float = CELL,
    progress: Progress | None = None,
) -> Grid:
    """The grid of this floor from `folder`, baked and kept there if missing or damaged.

    A read-only folder is no obstacle: the grid is then baked each time.
    """
    key = grid_key(floor, cell=cell)
    path = Path(folder) / f"walk-{key[:16]}.grid"
    found = _read(path, key)
    if found is not None:
        return found
    grid = bake(floor, cell=cell, progress=progress)
    _write(path, key, grid)
    return grid


def _read(path: Path, key: str) -> Grid | None:
    try:
        head, payload = path.read_bytes().split(b"\n", 1)
        meta = json.loads(head)
        if meta["key"] != key or meta["sha256"] != hashlib.sha256(payload).hexdigest():
            return None
        samples = np.frombuffer(payload, dtype="<i2").astype(np.int16).reshape(meta["nz"], meta["nx"])
        return Grid(samples, meta["x0"], meta["z0"], meta["cell"], meta["scale"], BODY)
    except (OSError, ValueError, KeyError, TypeError):  # missing, cut short, or not ours: bake again
        return None


def _write(path: Path, key: str, grid: Grid) -> None:
    payload = grid.to_bytes()
    head = {**grid.meta(), "key": key, "sha256": hashlib.sha256(payload).hexdigest()}
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=path.name)
        with os.fdopen(handle, "wb") as file:
            file.write(json.dumps(head).encode() + b"\n" + payload)
        os.replace(temporary, path)  # atomic: readers see the old file or the whole new one
        kept = sorted(path.parent.glob("walk-*.grid"), key=lambda file: file.stat().st_mtime)
        for old in kept[:-_KEPT]:
            old.unlink()
    except OSError:
        return
