"""Garments as tests want them: dressed in about a second, drawn with one plain colour."""

from dataclasses import dataclass

import numpy as np

from sim_core.garment.outfit import Step

SHORT = (
    Step("sew", 0.48, (0.0, 1.5), 6.0, 0.0),
    Step("weld"),
    Step("settle", 0.12, (2.0, 9.81), 3.0, 0.15),
    Step("pin", spots=("nape",)),
    Step("pose", 0.2, damping=2.5, friction=0.1),
    Step("close", 0.12, damping=2.5),
    Step("release"),
    Step("rest", 0.16, damping=10.0, friction=0.45),
)


@dataclass(frozen=True)
class Maps:
    """What a weave's look is drawn by: albedo, normal, direction (H, W, 3), opacity, height and roughness (H, W) uint8,
    its size and relief [m]; rough and level, its yarns along the weft, where it is not said otherwise."""

    albedo: np.ndarray
    normal: np.ndarray
    opacity: np.ndarray
    size: tuple[float, float]
    relief: float = 1e-4

    @property
    def height(self) -> np.ndarray:
        return np.full_like(self.opacity, 128)

    @property
    def roughness(self) -> np.ndarray:
        return np.full_like(self.opacity, 153)

    @property
    def direction(self) -> np.ndarray:
        return np.full_like(self.albedo, (255, 128, 128))


def plain_maps(opacity: int = 255) -> Maps:
    """One colour all over, flat."""
    flat = np.full((32, 32, 3), [128, 128, 255], np.uint8)
    albedo = np.full((32, 32, 3), 200, np.uint8)
    return Maps(albedo, flat, np.full((32, 32), opacity, np.uint8), (0.004, 0.005))
