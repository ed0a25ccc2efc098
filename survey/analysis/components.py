"""Principal components of a correlation matrix and their rotation (the paper's Tables 2 and 3)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from survey.analysis.errors import AnalysisError
from survey.analysis.varimax import varimax

__all__ = ["Components", "principal_components"]


@dataclass(frozen=True)
class Components:
    """eigenvalues: (p,) of R, largest first; their sum is p.

    unrotated, loadings: (p, k), before and after Kaiser-normalised varimax; rotation leaves the total and each
    item's communality (p,) as they are. initial, rotated: sums of squares, (p,) and (k,).
    """

    eigenvalues: NDArray[np.float64]
    unrotated: NDArray[np.float64]
    loadings: NDArray[np.float64]

    @property
    def kept(self) -> int:
        return self.loadings.shape[1]

    @property
    def communalities(self) -> NDArray[np.float64]:
        return (self.loadings**2).sum(axis=1)

    @property
    def rotated(self) -> NDArray[np.float64]:
        return (self.loadings**2).sum(axis=0)

    def sorted_items(self) -> list[int]:
        """Items by the component on which they load most, then by that loading, as Table 3 is printed."""
        home = np.abs(self.loadings).argmax(axis=1)
        return sorted(range(len(home)), key=lambda item: (home[item], -abs(self.loadings[item, home[item]])))


def principal_components(correlation: ArrayLike, *, keep: int | None = None) -> Components:
    """Components of a correlation matrix (p, p).

    keep: how many; None keeps those with an eigenvalue above 1 (Kaiser's criterion).
    Raises AnalysisError for a matrix that is no correlation matrix, or when nothing can be kept.
    """
    r = np.asarray(correlation, dtype=np.float64)
    if r.ndim != 2 or r.shape[0] != r.shape[1] or not np.isfinite(r).all():
        raise AnalysisError("a correlation matrix is square and finite")
    if not np.allclose(r, r.T, atol=1e-12) or not np.allclose(np.diag(r), 1.0, atol=1e-12):
        raise AnalysisError("a correlation matrix is symmetric with ones on its diagonal")
    values, vectors = np.linalg.eigh(r)
    values, vectors = values[::-1], vectors[:, ::-1]
    # An eigenvalue of exactly 1 (no correlation at all) must not be kept for a rounding error.
    count = int((values > 1.0 + 1e-12).sum()) if keep is None else keep
    if not 1 <= count <= len(r):
        raise AnalysisError(
            f"{count} components of {len(r)} items – no eigenvalue above 1, or a wrong number asked"
        )
    unrotated = vectors[:, :count] * np.sqrt(np.maximum(values[:count], 0.0))
    unrotated = unrotated * np.where(unrotated.sum(axis=0) < 0.0, -1.0, 1.0)
    return Components(values, unrotated, varimax(unrotated))
