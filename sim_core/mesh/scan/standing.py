"""A scan stood up: in metres, y upwards, its foot on the ground and its middle over the origin."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np

from sim_core.mesh.scan.scan import Scan

__all__ = ["UPWARDS", "Upwards", "stood"]

Upwards = Literal["x", "y", "z", "-x", "-y", "-z"]
# Which way of the file is up -> the rows of the rotation that makes it y.
UPWARDS: dict[str, tuple[tuple[int, int, int], ...]] = {
    "y": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
    "z": ((1, 0, 0), (0, 0, 1), (0, -1, 0)),
    "x": ((0, -1, 0), (1, 0, 0), (0, 0, 1)),
    "-y": ((1, 0, 0), (0, -1, 0), (0, 0, -1)),
    "-z": ((1, 0, 0), (0, 0, -1), (0, 1, 0)),
    "-x": ((0, 1, 0), (-1, 0, 0), (0, 0, 1)),
}


def stood(scan: Scan, metres: float, up: Upwards) -> Scan:
    """The scan whose unit is so many metres and whose axis `up` points upwards; vertices that no face uses are left
    out."""
    used, faces = np.unique(scan.faces, return_inverse=True)
    vertices = scan.vertices[used] @ np.array(UPWARDS[up], float).T * metres
    low, high = vertices.min(0), vertices.max(0)
    middle = (low + high) / 2
    vertices -= [middle[0], low[1], middle[2]]
    colours = None if scan.colours is None else scan.colours[used]
    return replace(scan, vertices=vertices, faces=faces.reshape(-1, 3).astype(np.int32), colours=colours)
