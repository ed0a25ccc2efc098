"""Everything of a sequence's two sheets that a network stands on."""

from __future__ import annotations

from dataclasses import dataclass

from sim_core.learn.data import Pair, Recipe
from sim_core.learn.patches import Imbalance, Patches, Surroundings

__all__ = ["UNIT", "Ground"]

UNIT = 0.25  # of a coarse edge: what displacements are told in


@dataclass(frozen=True)
class Ground:
    """The sheets, patches between them, what coarse vertices see, and what the fine sheet lacks to balance.

    unit [m]: of displacements from the base.
    """

    pair: Pair
    patches: Patches
    surroundings: Surroundings
    imbalance: Imbalance
    unit: float

    @staticmethod
    def of(recipe: Recipe) -> Ground:
        """That of a sequence."""
        pair = Pair.of(recipe)
        coarse, fine = (recipe.on(count).pins for count in (recipe.coarse, recipe.fine))
        patches = Patches.of(pair.coarse.rest, pair.coarse.faces, pair.fine.rest)
        surroundings = Surroundings.of(pair.coarse.rest, pair.coarse.faces, tuple(coarse))
        imbalance = Imbalance.of(pair, tuple(coarse), tuple(fine))
        return Ground(pair, patches, surroundings, imbalance, UNIT * patches.length)
