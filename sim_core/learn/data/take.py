"""A sequence as it is learned from or tested on: its two sheets, and what they did."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from sim_core.learn.data.film import Film
from sim_core.learn.data.pair import Pair
from sim_core.learn.data.recipe import Recipe
from sim_core.learn.pooling import Pooled

__all__ = ["Take"]


@dataclass(frozen=True)
class Take:
    """recipe: what was simulated; pair: both sheets; film: their frames."""

    recipe: Recipe
    pair: Pair
    film: Film

    @staticmethod
    def of(recipe: Recipe, film: Film) -> Take:
        """Super-resolution: the coarse sheet is the one that was simulated."""
        return Take(recipe, Pair.of(recipe), film)

    @staticmethod
    def pooled(recipe: Recipe, film: Film, pooled: Pooled) -> Take:
        """Reconstruction: the coarse sheet is what pooling keeps of every fine frame."""
        kept = film.fine[:, pooled.kept]
        return Take(recipe, Pair.pooled(recipe, pooled), replace(film, coarse=kept, coarse_ms=0.0))

    @property
    def name(self) -> str:
        """The sequence's."""
        return self.recipe.name

    def first(self, frames: int | None) -> Take:
        """Of no more than so many frames."""
        film = replace(self.film, coarse=self.film.coarse[:frames], fine=self.film.fine[:frames])
        return replace(self, film=film)

    def told(self) -> dict[str, Any]:
        """By which a record knows it again."""
        return self.recipe.told() | {"sheets": self.pair.kind, "frames": len(self.film.fine)}
