"""Principal components of a correlation matrix, rotated (the paper's Tables 2 and 3), and names proposed for them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from survey.analysis.components.oblique_rotation import oblimin
from survey.analysis.components.orthogonal_rotation import varimax
from survey.analysis.errors import NoComponents, WrongShape

__all__ = [
    "Components",
    "Rotation",
    "eigenvalues",
    "homes",
    "kaiser_count",
    "principal_components",
    "proposed_modules",
]

Rotation = Literal["varimax", "oblimin", "none"]


@dataclass(frozen=True)
class Components:
    """eigenvalues: (p,) of R, largest first; their sum is p.

    unrotated, loadings: (p, k), before and after rotation; loadings is the pattern where the rotation is oblique.
    correlation: (k, k) of the components, the identity unless oblique. Rotation leaves the total and each item's
    communality (p,) as they are. rotated: (k,) sums of squares, for oblique ones Σ pattern × structure.
    """

    eigenvalues: NDArray[np.float64]
    unrotated: NDArray[np.float64]
    loadings: NDArray[np.float64]
    correlation: NDArray[np.float64]
    rotation: Rotation

    @property
    def kept(self) -> int:
        return self.loadings.shape[1]

    @property
    def structure(self) -> NDArray[np.float64]:
        """(p, k) correlations of items and components."""
        return self.loadings @ self.correlation

    @property
    def communalities(self) -> NDArray[np.float64]:
        return (self.loadings * self.structure).sum(axis=1)

    @property
    def rotated(self) -> NDArray[np.float64]:
        return (self.loadings * self.structure).sum(axis=0)

    @property
    def transformation(self) -> NDArray[np.float64]:
        """(k, k) that takes the unrotated loadings to the rotated ones."""
        return np.asarray(np.linalg.lstsq(self.unrotated, self.loadings, rcond=None)[0], dtype=np.float64)

    def sorted_items(self) -> list[int]:
        """Items by the component on which they load most, then by that loading, as Table 3 is printed."""
        home = np.abs(self.loadings).argmax(axis=1)
        return sorted(range(len(home)), key=lambda item: (home[item], -abs(self.loadings[item, home[item]])))


def eigenvalues(correlation: NDArray[np.float64]) -> NDArray[np.float64]:
    """(p,), largest first."""
    return np.asarray(np.linalg.eigvalsh(correlation)[::-1], dtype=np.float64)


def kaiser_count(values: NDArray[np.float64]) -> int:
    """How many eigenvalues (p,) exceed 1; one of exactly 1 (no correlation at all) must not for a rounding error."""
    return int((values > 1.0 + 1e-12).sum())


def principal_components(
    correlation: ArrayLike, *, keep: int | None = None, rotation: Rotation = "varimax"
) -> Components:
    """Components of a correlation matrix (p, p).

    keep: how many; None keeps those with an eigenvalue above 1 (Kaiser's criterion).
    Raises WrongShape for a matrix that is no correlation matrix, NoComponents when nothing can be kept, NotConverged.
    """
    r = np.asarray(correlation, dtype=np.float64)
    if r.ndim != 2 or r.shape[0] != r.shape[1] or not np.isfinite(r).all():
        raise WrongShape("a correlation matrix is square and finite")
    if not np.allclose(r, r.T, atol=1e-12) or not np.allclose(np.diag(r), 1.0, atol=1e-12):
        raise WrongShape("a correlation matrix is symmetric with ones on its diagonal")
    values, vectors = np.linalg.eigh(r)
    values, vectors = values[::-1].copy(), vectors[:, ::-1]
    count = kaiser_count(values) if keep is None else keep
    if not 1 <= count <= len(r):
        raise NoComponents(
            f"{count} components of {len(r)} items – no eigenvalue above 1, or a wrong number asked"
        )
    unrotated = vectors[:, :count] * np.sqrt(np.maximum(values[:count], 0.0))
    unrotated = unrotated * np.where(unrotated.sum(axis=0) < 0.0, -1.0, 1.0)
    straight = np.eye(count)
    if rotation == "oblimin":
        return Components(values, unrotated, *oblimin(unrotated), rotation)
    turned = varimax(unrotated) if rotation == "varimax" else unrotated
    return Components(values, unrotated, turned, straight, rotation)


def homes(components: Components) -> list[int]:
    """(p,) the component on which each item loads most."""
    return np.abs(components.loadings).argmax(axis=1).tolist()


def proposed_modules(
    components: Components, items: Sequence[str], module_of: Mapping[str, str]
) -> list[str | None]:
    """(k,) per component the module with the most squared loading among the items at home there, or None.

    A module that would name two components names the one it fills more.
    """
    home, squares = homes(components), components.loadings**2
    weight: dict[tuple[int, str], float] = {}
    for row, item in enumerate(items):
        if item in module_of:
            key = (home[row], module_of[item])
            weight[key] = weight.get(key, 0.0) + float(squares[row, home[row]])
    names: list[str | None] = [None] * components.kept
    for (column, module), _ in sorted(weight.items(), key=lambda entry: -entry[1]):
        if names[column] is None and module not in names:
            names[column] = module
    return names
