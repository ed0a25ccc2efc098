"""The network that `inference.Follower` runs, to be trained: the same steps over several sheets glued into one."""

# pyright: reportMissingImports=false
# (torch is an extra)

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor, nn

from sim_core.learn.inference import Ground, Settings
from sim_core.learn.inference.follower import FURTHEST_WAY, GATE_BIAS
from sim_core.learn.inference.settings import KNOWN, PATCH, TOLD
from sim_core.learn.networks.operators import Carried, Displaced, Fitted, SpiralMix
from sim_core.learn.patches import CUBIC, SEEN, TWO_RINGS, limited

__all__ = ["Glued", "LearnedSteps", "Moment"]


class Glued:
    """Several grounds as one sheet of their vertices, one after the other. coarse, fine: where each begins; edges:
    (E, 2) of the fine sheets; edge_weight: (E,) float32, the mean length of its sheet's over each one's."""

    def __init__(self, grounds: Sequence[Ground]) -> None:
        self.grounds = tuple(grounds)
        self.coarse = np.cumsum([0, *(len(one.pair.coarse.rest) for one in grounds)])
        self.fine = np.cumsum([0, *(len(one.pair.fine.rest) for one in grounds)])

        def after(arrays: Sequence[np.ndarray], begins: np.ndarray) -> np.ndarray:
            return np.concatenate([a + b for a, b in zip(arrays, begins, strict=False)]).astype(np.int32)

        patches = [one.patches for one in grounds]
        self.near = after([one.surroundings.near for one in grounds], self.coarse)
        self.corner = after([one.corner for one in patches], self.coarse)
        self.share, self.lift, self.fit = (
            np.concatenate([getattr(one, name) for one in patches]) for name in ("share", "lift", "fit")
        )
        self.gathered = torch.from_numpy(self.corner.astype(np.int64)), torch.from_numpy(self.share)
        lengths = [np.sqrt(one.pair.fine.stencil.length2) for one in grounds]
        self.edges = after([one.pair.fine.stencil.edges for one in grounds], self.fine)
        self.edge_weight = np.concatenate([one.mean() / one for one in lengths]).astype(np.float32)

    def carried(self, fine: Tensor, before: np.ndarray, turn: np.ndarray) -> Tensor:
        """Displacements (V, 3) turned along from frames `before` (N, 3, 3) into those of `turn`: `Patches.carried`."""
        return Carried.apply(fine, before, turn, self.corner, self.share)


@dataclass(frozen=True)
class Moment:
    """A frame of every sheet: coarse (C, 3) [m] of each, frames (N, 3, 3), what is seen (N, SEEN), the base (V, 3) [m]
    of each, and what both sheets are accelerated by."""

    coarse: tuple[np.ndarray, ...]
    turn: np.ndarray
    seen: np.ndarray
    base: tuple[np.ndarray, ...]
    shared: tuple[np.ndarray, ...]

    @staticmethod
    def of(glued: Glued, films: Sequence[tuple[np.ndarray, int]]) -> Moment:
        """Of frame k of a coarse film (T, C, 3) [m] for each sheet."""
        seen, now = [], []
        for ground, (film, k) in zip(glued.grounds, films, strict=True):
            frames = [np.asarray(film[max(k - back, 0)], float) for back in range(3)]
            if k == 1:
                frames[2] = frames[1]
            seen.append(ground.surroundings.seen(*frames))
            now.append(frames[0])
        base = tuple(one.pair.base @ place for one, place in zip(glued.grounds, now, strict=True))
        shared = tuple(one.imbalance.shared(place) for one, place in zip(glued.grounds, now, strict=True))
        turn, told = (np.concatenate(parts) for parts in zip(*seen, strict=True))
        return Moment(tuple(now), turn, told, base, shared)


class _Block(nn.Module):
    def __init__(self, width: int, hidden: int) -> None:
        super().__init__()
        self.spiral = nn.Parameter(torch.randn(TWO_RINGS, width) / TWO_RINGS**0.5)
        self.widen, self.narrow = nn.Linear(width, hidden), nn.Linear(hidden, width)
        nn.init.normal_(self.narrow.weight, std=0.1 / hidden**0.5)
        nn.init.zeros_(self.narrow.bias)

    def forward(self, x: Tensor, near: np.ndarray) -> Tensor:
        mixed = SpiralMix.apply(x, self.spiral, near)
        return x + self.narrow(nn.functional.hardswish(self.widen(mixed)))


class _Step(nn.Module):
    def __init__(self, settings: Settings) -> None:
        super().__init__()
        self.inner, self.outer = nn.Linear(KNOWN, settings.width), nn.Linear(settings.width, PATCH + 1)
        self.past = nn.Linear(TOLD, PATCH, bias=False)
        self.blocks = nn.ModuleList(_Block(settings.width, settings.hidden) for _ in range(settings.blocks))
        for zero in (self.outer.weight, self.outer.bias, self.past.weight):
            nn.init.zeros_(zero)

    def forward(self, known: Tensor, near: np.ndarray) -> tuple[Tensor, Tensor]:
        x = self.inner(known)
        for block in self.blocks:
            x = block(x, near)
        out = self.outer(x)
        return out[:, :PATCH] + self.past(known[:, SEEN:]), out[:, PATCH]


class LearnedSteps(nn.Module):
    """All that is learned, named as `Settings.shapes` says. Begins as the base and a little of the last frame."""

    def __init__(self, settings: Settings) -> None:
        super().__init__()
        self.settings = settings
        self.steps = nn.ModuleList(_Step(settings) for _ in range(settings.steps))

    def forward(self, glued: Glued, moment: Moment, last: Tensor, first: Tensor) -> Tensor:
        """Displacements (V, 3) from the base, in units, from those one and two frames ago, carried along."""
        fixed = (moment.turn, glued.corner, glued.fit)
        was = Fitted.apply(last, *fixed).flatten(1)
        change = was - Fitted.apply(first, *fixed).flatten(1)
        seen = torch.from_numpy(moment.seen)
        off, there = torch.zeros_like(last), torch.zeros_like(was)
        for number, step in enumerate(self.steps):
            ways, means = _lacking(glued, moment, off)
            pushed = Fitted.apply(ways, *fixed).flatten(1)
            said, stays = step(
                torch.cat([seen, there, change, there - was, pushed, means], dim=1), glued.near
            )
            if number == 0:
                corner, share = glued.gathered
                off = last * (torch.sigmoid(stays + GATE_BIAS)[corner] * share).sum(1, keepdim=True)
            off = off + Displaced.apply(said.view(-1, CUBIC, 3), moment.turn, glued.corner, glued.lift)
            if number + 1 < len(self.steps):
                there = Fitted.apply(off, *fixed).flatten(1)
        return off


def _lacking(glued: Glued, moment: Moment, off: Tensor) -> tuple[Tensor, Tensor]:
    """What balance lacks, in units, and in the frames of coarse vertices; taken as it is, not differentiated."""
    ways, means, now = [], [], off.detach().numpy()
    for k, ground in enumerate(glued.grounds):
        fine = moment.base[k] + ground.unit * now[glued.fine[k] : glued.fine[k + 1]]
        way, mean = ground.imbalance.ways(fine, moment.coarse[k], moment.shared[k])
        turn = moment.turn[glued.coarse[k] : glued.coarse[k + 1]]
        ways.append(limited(way / ground.unit, FURTHEST_WAY))
        means.append(np.einsum("cji,cj->ci", turn, mean / ground.unit))
    return tuple(torch.from_numpy(np.concatenate(one).astype(np.float32)) for one in (ways, means))
