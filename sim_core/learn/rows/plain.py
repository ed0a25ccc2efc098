"""Rows without training: the coarse surface, and the smoothest sheet with its means."""

from __future__ import annotations

from dataclasses import dataclass

from sim_core.learn.data import Pair, Recipe
from sim_core.learn.rows.row import Follow
from sim_core.learn.upsampling import weighted_sums

__all__ = ["Biharmonic", "Linear"]


@dataclass(frozen=True)
class Linear:
    """Fine vertices on the faces of the coarse mesh."""

    name: str = "linear"

    def follow(self, recipe: Recipe) -> Follow:
        matrix = Pair.of(recipe).spread
        return lambda coarse: weighted_sums(matrix, coarse)


@dataclass(frozen=True)
class Biharmonic:
    """The smoothest fine sheet whose means about the coarse vertices are those of the coarse surface. Better than the
    smoothest one through the coarse vertices, which is worse than linear where the fine sheet was led by its means."""

    name: str = "biharmonic"

    def follow(self, recipe: Recipe) -> Follow:
        matrix = Pair.of(recipe).base
        return lambda coarse: weighted_sums(matrix, coarse)
