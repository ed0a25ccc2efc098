"""How large a network is, and what its arrays are called: training and inference read the same names."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from sim_core.learn.patches import CUBIC, SEEN, TWO_RINGS

__all__ = ["KNOWN", "PATCH", "RIVALS", "TOLD", "Rival", "Settings", "Shapes"]

PATCH = 3 * CUBIC  # numbers of a patch
TOLD = (
    4 * PATCH + 3
)  # of the fine sheet: patches now, how they changed twice, ways and means that balance lacks
KNOWN = SEEN + TOLD

Shapes = Mapping[str, tuple[int, ...]]


@dataclass(frozen=True)
class Settings:
    """width, hidden: channels of coarse vertices, and within a block; blocks: of a step; steps: times that the fine
    sheet is mended in a frame."""

    width: int = 32
    hidden: int = 64
    blocks: int = 2
    steps: int = 2

    def shapes(self) -> Shapes:
        """The name and shape of every array."""
        found: dict[str, tuple[int, ...]] = {}
        for step in range(self.steps):
            name = f"steps.{step}"
            found |= {
                f"{name}.inner.weight": (self.width, KNOWN),
                f"{name}.inner.bias": (self.width,),
                f"{name}.outer.weight": (PATCH + 1, self.width),
                f"{name}.outer.bias": (PATCH + 1,),
                f"{name}.past.weight": (PATCH, TOLD),
            }
            for block in range(self.blocks):
                part = f"{name}.blocks.{block}"
                found |= {
                    f"{part}.spiral": (TWO_RINGS, self.width),
                    f"{part}.widen.weight": (self.hidden, self.width),
                    f"{part}.widen.bias": (self.hidden,),
                    f"{part}.narrow.weight": (self.width, self.hidden),
                    f"{part}.narrow.bias": (self.width,),
                }
        return found


@dataclass(frozen=True)
class Rival:
    """A network to compare with. length: of spirals, 0: geometry images; width: channels; share: of vertices that
    pooling keeps, by `pooling`; rate: of learning, at which it learned most of a first few hundred updates."""

    length: int
    width: int
    share: float
    pooling: str
    rate: float


RIVALS = {
    "mfsr": Rival(0, 48, 1.0, "none", 2e-3),
    "mesh_conv": Rival(9, 32, 0.25, "quadric errors", 2e-3),
    "paper": Rival(100, 16, 0.6, "Gauss curvature", 5e-4),
}
