"""Inner points for a size field: fine lattices thinned to the local edge length."""

import numpy as np

from sim_core.errors import OutlineError
from sim_core.mesh.outline.samples import Rim
from sim_core.mesh.outline.size_field import SizeField
from sim_core.mesh.points.lattice import lattice_points, lattice_size
from sim_core.mesh.points.layer import apart, layer_points
from sim_core.mesh.points.raycast import inside

__all__ = ["graded_points", "lattice_near"]

TILE = 32  # rows and columns of a candidate lattice that are made, or left out, together
FINER = 3  # candidates lie on lattices of this part of the local edge
APART = 0.9  # of the local edge: distance of inner points; smoothing evens it out
LAYER_APART = 0.7
MOST = 500_000
PROBES = 200  # of the longer side: grid on which the number of points is estimated


def graded_points(rim: Rim, edge: float, sizes: SizeField) -> np.ndarray:
    """Inner points (n, 2) [m] of a panel whose edge lengths follow `sizes`: a row along the rim, then the inside.

    Candidates come from staggered lattices of a third of each octave of edge lengths, in rows from the upper left,
    and stay where no earlier one is nearer than 0.9 of the edge length wanted there. Raises OutlineError for more
    than half a million points.
    """
    contours = rim.contours
    low, high = contours[0].min(axis=0), contours[0].max(axis=0)
    _check(low, high, edge, sizes)
    found = []
    longest = edge
    while longest > min(edge, float(sizes.sizes.min())) / 2:
        points = lattice_near(low, high, longest, edge, sizes)
        wanted = sizes.at(points, edge)
        found.append(points[(wanted <= longest) & (wanted > longest / 2)])
        longest /= 2
    points = np.concatenate(found)
    points = points[inside(points, contours)]
    points = points[np.lexsort((points[:, 0], points[:, 1]))]
    row = layer_points(rim.points, rim.steps)
    row = row[inside(row, contours)]
    first = len(rim.points)
    every = np.concatenate([rim.points, row, points])
    reach = sizes.at(every, edge) * APART
    reach[first : first + len(row)] *= LAYER_APART / APART
    return every[first:][apart(every, reach, first)[first:]]


def lattice_near(low, high, longest: float, edge: float, sizes: SizeField) -> np.ndarray:
    """The staggered points of step longest / 3 in tiles that may want edges of longest / 2 to longest. (n, 2) [m]

    A lattice of the finest edges over a whole panel may have hundreds of millions of points, nearly all unwanted.
    """
    step = longest / FINER
    rows, columns = lattice_size(low, high, step)
    i, j = (
        at.ravel() for at in np.meshgrid(np.arange(0, rows, TILE), np.arange(0, columns, TILE), indexing="ij")
    )
    half = TILE * step / 2
    middle = low + np.column_stack([j * step + half, i * step * np.sqrt(3) / 2 + half])
    reach = sizes.gradation * 2 * half  # a tile's points are nearer to its middle than its side
    wanted = sizes.at(middle, edge)
    near = (wanted - reach <= longest) & (wanted + reach >= longest / 2)
    row, column = np.divmod(np.arange(TILE * TILE), TILE)
    i, j = (i[near, None] + row).ravel(), (j[near, None] + column).ravel()
    within = (i < rows) & (j < columns)
    return lattice_points(low, step, i[within], j[within])


def _check(low, high, edge: float, sizes: SizeField) -> None:
    """Estimate the number of points over the panel's rectangle before any are made."""
    step = float((high - low).max()) / PROBES
    x, y = (np.arange(a + step / 2, b, step) for a, b in zip(low, high, strict=True))
    probes = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    count = float((step * step * 2 / np.sqrt(3) / sizes.at(probes, edge) ** 2).sum())
    if count > MOST:
        raise OutlineError(
            f"size field: about {count:.3g} points – give larger sizes; at most {MOST} are made"
        )
