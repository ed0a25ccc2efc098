"""Which sequences are learned from and which are only ever tested on: whole sequences, never frames of one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from sim_core.errors import SimCoreError
from sim_core.learn.data.recipe import Recipe

__all__ = ["Split", "split"]

HELD_OUT = (
    3,
    6,
    9,
)  # of every ten cases: 3 of 10 flags, 5 of 16 teapots, 5 of 18 hanging sheets, of every size


@dataclass(frozen=True)
class Split:
    """train: learned from; validation: of those the last, by which a network is chosen where one is; test: the rest."""

    train: tuple[Recipe, ...]
    validation: Recipe
    test: tuple[Recipe, ...]


def split(recipes: Sequence[Recipe]) -> Split:
    """By the number of the case. Raises SimCoreError where nothing is left to learn from or to test on."""
    test = tuple(one for one in recipes if one.case % 10 in HELD_OUT)
    train = tuple(one for one in recipes if one.case % 10 not in HELD_OUT)
    if not test or not train:
        raise SimCoreError(
            f"{len(recipes)} sequences – cases 3, 6, 9, 13 … are tested on and the others learned from: make 3 or more"
        )
    return Split(train, train[-1], test)
