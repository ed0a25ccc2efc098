"""What stays of each kind of sheet, decided by frames of training alone, and the takes of what it leaves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from sim_core.errors import SimCoreError
from sim_core.learn.data.take import Take
from sim_core.learn.pooling import Pooled, collapse, decimate, mean_absolute_curvature

__all__ = ["POOLINGS", "pooled_by_kind", "pooled_takes"]

GAUSS, QUADRIC = "Gauss curvature", "quadric errors"
POOLINGS = (GAUSS, QUADRIC)
QUADRIC_FRAMES, CURVATURE_FRAMES = 24, 200  # of training, that pooling looks at


def pooled_by_kind(takes: Sequence[Take], pooling: str, share: float) -> dict[str, Pooled]:
    """By `Pair.kind`, what less than a share of the fine vertices is; pooling: of POOLINGS."""
    kinds: dict[str, list[Take]] = {}
    for take in takes:
        kinds.setdefault(take.pair.kind, []).append(take)
    return {kind: _pooled(own, pooling, share) for kind, own in kinds.items()}


def pooled_takes(takes: Sequence[Take], pooled: Mapping[str, Pooled]) -> list[Take]:
    """The same sequences from what pooling keeps of them. Raises SimCoreError for a kind of sheet it does not know."""
    found = []
    for take in takes:
        if (own := pooled.get(take.pair.kind)) is None:
            raise SimCoreError(
                f"{take.name}: no sheet of its kind ({take.pair.kind}) was pooled – learn from one"
            )
        found.append(Take.pooled(take.recipe, take.film, own))
    return found


def _pooled(takes: Sequence[Take], pooling: str, share: float) -> Pooled:
    sheet = takes[0].pair.fine
    pins = sorted({pin for take in takes for pin in take.pair.pins[1]})
    width = float(np.ptp(sheet.rest[:, 0]))

    def drawn(count: int) -> np.ndarray:
        """So many frames of all films, at one size."""
        each, parts = max(1, count // len(takes)), []
        for take in takes:
            own, fine = float(np.ptp(take.pair.fine.rest[:, 0])), take.film.fine
            parts.append(fine[np.linspace(0, len(fine) - 1, each).astype(int)] * (width / own))
        return np.concatenate(parts).astype(float)

    if pooling == GAUSS:
        curvature = mean_absolute_curvature(drawn(CURVATURE_FRAMES), sheet.faces)
        return decimate(sheet.rest, sheet.faces, curvature, share, pins=pins)
    return collapse(sheet.rest, sheet.faces, drawn(QUADRIC_FRAMES), share, pins=pins)
