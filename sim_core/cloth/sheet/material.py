"""What the solver has to know about a cloth: mass, stiffness, damping, friction."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from sim_core.errors import SimCoreError
from sim_core.validation import finite


class ParametersLike(Protocol):
    """The part of `sim_core.weave.ClothParameters` a material is made from."""

    @property
    def density(self) -> float: ...
    @property
    def stretch_warp(self) -> float: ...
    @property
    def stretch_weft(self) -> float: ...
    @property
    def shear(self) -> float: ...
    @property
    def poisson(self) -> float: ...
    @property
    def bend_warp(self) -> float: ...
    @property
    def bend_weft(self) -> float: ...
    @property
    def friction(self) -> float: ...


_OF_A_WEAVE = {
    "density": "density",
    "stretch": "stretch_weft",
    "stretch_warp": "stretch_warp",
    "shear": "shear",
    "poisson": "poisson",
    "bend": "bend_weft",
    "bend_warp": "bend_warp",
    "friction": "friction",
}


@dataclass(frozen=True)
class Material:
    """A thin elastic sheet; the warp runs along pattern y, the weft along pattern x.

    density [kg/m2], stretch [N/m] along the weft (and along the warp unless `stretch_warp` is given),
    shear [N/m] (None: isotropic, stretch / (2 (1 + poisson))), bend [N m] against bending the weft's yarns, and
    the warp's unless `bend_warp` is given, friction: Coulomb's mu, mass_damping [1/s], stiffness_damping [s].
    Raises SimCoreError on a value that has no meaning.
    """

    density: float
    stretch: float
    poisson: float = 0.3
    bend: float = 5e-5
    friction: float = 0.3
    mass_damping: float = 0.5
    stiffness_damping: float = 2e-5
    stretch_warp: float | None = None
    shear: float | None = None
    bend_warp: float | None = None

    def __post_init__(self) -> None:
        for name in ("density", "stretch", "stretch_warp", "shear"):
            if name in ("density", "stretch") or getattr(self, name) is not None:
                finite(f"material.{name}", getattr(self, name), above=0)
        for name in ("bend", "bend_warp", "friction", "mass_damping", "stiffness_damping"):
            if name != "bend_warp" or self.bend_warp is not None:
                finite(f"material.{name}", getattr(self, name), least=0)
        if not -1.0 < finite("material.poisson", self.poisson, least=-1, most=1) < 1.0:
            raise SimCoreError(f"material.poisson: {self.poisson} – must lie between -1 and 1 (plane stress)")

    @staticmethod
    def of(
        parameters: ParametersLike, *, mass_damping: float = 0.5, stiffness_damping: float = 2e-5
    ) -> Material:
        """The material of a weave's homogenised parameters."""
        found = {}
        for ours, theirs in _OF_A_WEAVE.items():
            if not hasattr(parameters, theirs):
                kind = type(parameters).__name__
                raise SimCoreError(
                    f"parameters: a {kind} has no {theirs} – give the ClothParameters of a weave"
                )
            found[ours] = finite(f"parameters.{theirs}", getattr(parameters, theirs))
        return Material(**found, mass_damping=mass_damping, stiffness_damping=stiffness_damping)

    def elasticity(self) -> np.ndarray:
        """D (3, 3) [N/m] of W = g.D.g/2 per area, g = (G00, G11, G01) the Green strain (St. Venant-Kirchhoff)."""
        weft, warp = self.stretch, self.stretch if self.stretch_warp is None else self.stretch_warp
        shear = math.sqrt(weft * warp) / (2 * (1 + self.poisson)) if self.shear is None else self.shear
        scale = 1 / (1 - self.poisson**2)
        cross = self.poisson * math.sqrt(weft * warp) * scale
        return np.array([[weft * scale, cross, 0.0], [cross, warp * scale, 0.0], [0.0, 0.0, 4 * shear]])

    def bending(self) -> np.ndarray:
        """B (3,) [N m] of W = (B0 xx^2 + B1 yy^2 + 2 B2 xy^2) / 2 per area, of curvatures along weft, warp and both.

        A cylinder whose rulings are at any angle then stores k^2/2 (sqrt(B0) cos^2 + sqrt(B1) sin^2)^2: what stiffens
        against twist is not measured for weaves, and taken as Huber (1923) has it, the mean of both.
        """
        weft, warp = self.bend, self.bend if self.bend_warp is None else self.bend_warp
        return np.array([weft, warp, weft if weft == warp else math.sqrt(weft * warp)])
