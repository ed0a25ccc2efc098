"""Rows without training: the coarse surface, and the smoothest sheet with its means."""

from __future__ import annotations

from dataclasses import dataclass

from sim_core.learn.data import Pair
from sim_core.learn.rows.row import Follow
from sim_core.learn.upsampling import weighted_sums

__all__ = ["Biharmonic", "Linear"]


@dataclass(frozen=True)
class Linear:
    """Fine vertices on the faces of the coarse mesh."""

    name: str = "linear"

    def follow(self, pair: Pair) -> Follow:
        return lambda coarse: weighted_sums(pair.spread, coarse)


@dataclass(frozen=True)
class Biharmonic:
    """The smoothest fine sheet whose means about the coarse vertices are those of the coarse surface (better than the
    smoothest one through the coarse vertices, which is worse than linear where the fine sheet was led by its means);
    where they were pooled, the one through them."""

    name: str = "biharmonic"

    def follow(self, pair: Pair) -> Follow:
        return lambda coarse: weighted_sums(pair.base, coarse)
