"""The values that come out of the weave room: yarn geometry, texture maps, cloth parameters."""

from dataclasses import asdict, dataclass, field

import numpy as np

__all__ = ["ClothParameters", "TextureMaps", "YarnGeometry"]


@dataclass(frozen=True, eq=False)
class YarnGeometry:
    """Heights of the yarn axes at the crossings of one repeat, in force balance and periodic.

    warp_height, weft_height: (picks, ends) float64 [m] above the middle plane.
    force: (picks, ends) float64 [N] with which the two yarns press on each other, >= 0.
    warp_crimp: (ends,), weft_crimp: (picks,): excess length of the yarn over its straight distance (small slope).
    residual: largest net vertical force on a crossing / largest crossing force.
    penetration: largest overlap [m] of two yarns at a crossing; complementarity: largest force x gap / (V D).
    """

    warp_height: np.ndarray
    weft_height: np.ndarray
    force: np.ndarray
    warp_crimp: np.ndarray
    weft_crimp: np.ndarray
    residual: float
    penetration: float
    complementarity: float
    iterations: int

    def crest_to_trough(self) -> tuple[float, float]:
        """h1 of the warp and h2 of the weft [m]: the largest crest-to-trough distance of any yarn."""
        return float(np.ptp(self.warp_height, axis=0).max()), float(np.ptp(self.weft_height, axis=1).max())


@dataclass(frozen=True, eq=False)
class TextureMaps:
    """Tileable pictures of a cloth seen from its face.

    albedo, normal: (n, m, 3) uint8; height, opacity: (n, m) uint8. Rows run along the warp (pick 0 first, v down),
    columns along the weft. normal: tangent space as glTF has it (x right, y up the picture, z out of it).
    size: (2,) [m] of the tile, across and down.  relief: [m] between height 0 and 255.
    seam: largest difference, as a fraction of 255 levels, between the tiled maps and the same cloth rendered
    as one piece across the border.
    """

    albedo: np.ndarray
    normal: np.ndarray
    height: np.ndarray
    opacity: np.ndarray
    size: tuple[float, float]
    relief: float
    seam: float


@dataclass(frozen=True)
class ClothParameters:
    """What a cloth solver needs to know of a weave.

    density [kg/m2], thickness [m], stretch_warp, stretch_weft, shear [N/m], poisson, bend [N m] (geometric mean of
    bend_warp and bend_weft), friction.  bounds: name -> (least, most) where a value lies between two bounds.
    provenance: name -> formula, inputs and source in one sentence.
    """

    density: float
    thickness: float
    stretch_warp: float
    stretch_weft: float
    shear: float
    poisson: float
    bend: float
    friction: float
    bend_warp: float
    bend_weft: float
    bounds: dict[str, tuple[float, float]] = field(default_factory=dict)
    provenance: dict[str, str] = field(default_factory=dict)

    def to_dict(self) -> dict:
        """A plain dictionary that JSON can hold."""
        return asdict(self)
