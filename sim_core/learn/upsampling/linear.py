"""Fine vertices on the flat faces of the coarse mesh."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_array

from sim_core.errors import SimCoreError
from sim_core.learn.topology import checked_sheet
from sim_core.learn.upsampling.location import located
from sim_core.validation import coordinates

__all__ = ["linear"]


def linear(rest_coarse: np.ndarray, faces_coarse: np.ndarray, rest_fine: np.ndarray) -> csr_array:
    """W (N, K), fine = W @ coarse: each point by the barycentric weights of the coarse face it lies in at rest.

    rest_coarse: (K, 2) [m]; faces_coarse: (G, 3), any mesh of the sheet; rest_fine: (N, 2) [m]. Affine maps are
    exact; a point outside the coarse mesh, by rounding or where its border was thinned, is the nearest on it. Raises
    SimCoreError for arrays of other shapes or coordinates that are not finite.
    """
    rest, faces = checked_sheet(rest_coarse, faces_coarse)
    points = coordinates("rest_fine", rest_fine)
    if points.ndim != 2 or points.shape[1] != 2:
        raise SimCoreError(f"rest_fine: shape {points.shape} – the flat positions (N, 2) [m] are meant")
    face, weights = located(rest, faces, points)
    made = csr_array(
        (weights.ravel(), faces[face].ravel(), 3 * np.arange(len(points) + 1, dtype=np.int32)),
        shape=(len(points), len(rest)),
    )
    made.eliminate_zeros()
    made.sort_indices()
    return made
