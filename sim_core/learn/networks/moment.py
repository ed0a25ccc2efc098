"""A frame as the learned steps are given it."""

# pyright: reportMissingImports=false
# (torch is an extra)

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
import torch
from torch import Tensor

from sim_core.learn.inference import Ground
from sim_core.learn.upsampling import weighted_sums

__all__ = ["Moment"]


@dataclass(frozen=True)
class Moment:
    """Of C coarse and V fine vertices: coarse (C, 3) [m], their frames `turn` (C, 3, 3), what is seen (C, SEEN), the
    base (V, 3) [m], and what both sheets are accelerated by (V, 3) [m/s2]; places and accelerations double on the
    CPU."""

    coarse: Tensor
    turn: Tensor
    seen: Tensor
    base: Tensor
    shared: Tensor

    @staticmethod
    def of(ground: Ground, film: np.ndarray, k: int) -> Moment:
        """Of frame k of a coarse film (T, C, 3) [m]."""
        now, before, earlier = (np.asarray(film[max(k - back, 0)], float) for back in range(3))
        if k == 1:
            earlier = before
        turn, seen = ground.surroundings.seen(now, before, earlier)
        arrays = now, turn, seen, weighted_sums(ground.pair.base, now), ground.imbalance.shared(now)
        return Moment(*(torch.from_numpy(array) for array in arrays))

    @staticmethod
    def glued(moments: Sequence[Moment]) -> Moment:
        """Several sheets' as one."""
        return Moment(*(torch.cat([getattr(one, field.name) for one in moments]) for field in fields(Moment)))

    @staticmethod
    def stacked(moments: Sequence[Moment], device: torch.device) -> Moment:
        """Frames of one sheet, (T, ...) each, single, on a device."""
        return Moment(
            *(
                torch.stack([getattr(one, field.name).float() for one in moments]).to(device)
                for field in fields(Moment)
            )
        )

    def row(self, k: int) -> Moment:
        """One of those that are stacked."""
        return Moment(*(getattr(self, field.name)[k] for field in fields(Moment)))
