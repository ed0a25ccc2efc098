"""Local frames, fitted to the sequences that are learned from; a model for every kind of sheet among them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from sim_core.learn.data import Pair, Take
from sim_core.learn.rows.row import Follow
from sim_core.learn.upsampling import LocalFrames as Model
from sim_core.learn.upsampling import LocalFramesFit, weighted_sums

__all__ = ["LocalFrames"]


@dataclass(frozen=True)
class LocalFrames:
    """models: of every `Pair.kind` that was learned from, in units of its width; others get the biharmonic base."""

    models: Mapping[str, Model]
    name: str = "local_frames"

    @staticmethod
    def fitted(takes: Sequence[Take], *, thin: int = 1) -> LocalFrames:
        """From every `thin`-th frame of these sequences; sheets of one kind are brought to one size."""
        fits: dict[str, LocalFramesFit] = {}
        for take in takes:
            pair, film = take.pair, take.film
            width = _width(pair)
            which = pair.kind
            if which not in fits:
                fits[which] = LocalFramesFit(
                    pair.coarse.rest / width, pair.coarse.faces, pair.fine.rest / width, pair.base
                )
            fits[which].add(film.coarse[::thin] / width, film.fine[::thin] / width)
        return LocalFrames({which: fit.solve() for which, fit in fits.items()})

    def follow(self, pair: Pair) -> Follow:
        model, width = self.models.get(pair.kind), _width(pair)
        if model is None:
            return lambda coarse: weighted_sums(pair.base, coarse)
        own = replace(model, base=pair.base)
        return lambda coarse: width * own.predict(coarse / width)


def _width(pair: Pair) -> float:
    return float(np.ptp(pair.fine.rest[:, 0]))
