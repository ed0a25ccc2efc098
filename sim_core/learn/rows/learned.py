"""Learned steps as a row."""

from __future__ import annotations

from dataclasses import dataclass

from sim_core.learn.data import Pair
from sim_core.learn.inference import Follower, Ground, Trained
from sim_core.learn.rows.row import Follow

__all__ = ["Ours"]


@dataclass(frozen=True)
class Ours:
    """The base, mended in learned steps by what balance lacks."""

    trained: Trained
    name: str = "ours"

    def follow(self, pair: Pair) -> Follow:
        return Follower(Ground.of(pair), self.trained.settings, self.trained.weights)
