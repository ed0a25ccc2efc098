"""The network that `inference.Follower` runs, to be trained: the same steps over several sheets glued into one."""

# pyright: reportMissingImports=false
# (torch is an extra)

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import torch
from torch import Tensor, nn

from sim_core.learn.inference import Ground, Settings
from sim_core.learn.inference.follower import GATE_BIAS
from sim_core.learn.inference.settings import KNOWN, PATCH, TOLD
from sim_core.learn.networks.compiled import Compiled
from sim_core.learn.networks.gathered import Gathered
from sim_core.learn.networks.moment import Moment
from sim_core.learn.networks.sheets import Sheets
from sim_core.learn.patches import CUBIC, SEEN, TWO_RINGS

__all__ = ["Glued", "LearnedSteps"]


class Glued:
    """Several grounds as one sheet. fine: where each one's vertices begin, and the end; at: the sums between coarse and
    fine vertices; which: (V,) the sheet of each."""

    def __init__(self, grounds: Sequence[Ground], sheets: Sequence[Sheets]) -> None:
        whole = Sheets.glued(sheets)
        counts = [len(one.corner) for one in sheets]
        device = whole.corner.device
        self.coarse, self.fine = np.cumsum([0, *(len(one.near) for one in sheets)]), np.cumsum([0, *counts])
        self.corner, self.share = whole.corner.long(), whole.share
        self.which = torch.repeat_interleave(torch.arange(len(counts)), torch.tensor(counts)).to(device)
        self.at = Compiled(grounds, whole) if device.type == "cpu" else Gathered(whole)


class _Block(nn.Module):
    def __init__(self, width: int, hidden: int) -> None:
        super().__init__()
        self.spiral = nn.Parameter(torch.randn(TWO_RINGS, width) / TWO_RINGS**0.5)
        self.widen, self.narrow = nn.Linear(width, hidden), nn.Linear(hidden, width)
        nn.init.normal_(self.narrow.weight, std=0.1 / hidden**0.5)
        nn.init.zeros_(self.narrow.bias)

    def forward(self, x: Tensor, at: Compiled | Gathered) -> Tensor:
        mixed = at.mixed(x, self.spiral)
        return x + self.narrow(nn.functional.hardswish(self.widen(mixed)))


class _Step(nn.Module):
    def __init__(self, settings: Settings) -> None:
        super().__init__()
        self.inner, self.outer = nn.Linear(KNOWN, settings.width), nn.Linear(settings.width, PATCH + 1)
        self.past = nn.Linear(TOLD, PATCH, bias=False)
        self.blocks = nn.ModuleList(_Block(settings.width, settings.hidden) for _ in range(settings.blocks))
        for zero in (self.outer.weight, self.outer.bias, self.past.weight):
            nn.init.zeros_(zero)

    def forward(self, known: Tensor, at: Compiled | Gathered) -> tuple[Tensor, Tensor]:
        x = self.inner(known)
        for block in self.blocks:
            x = block(x, at)
        out = self.outer(x)
        return out[:, :PATCH] + self.past(known[:, SEEN:]), out[:, PATCH]


class LearnedSteps(nn.Module):
    """All that is learned, named as `Settings.shapes` says. Begins as the base and a little of the last frame."""

    def __init__(self, settings: Settings) -> None:
        super().__init__()
        self.settings = settings
        self.steps = nn.ModuleList(_Step(settings) for _ in range(settings.steps))

    def forward(self, glued: Glued, moment: Moment, last: Tensor, before: Tensor) -> tuple[Tensor, Tensor]:
        """Displacements (V, 3) from the base, in units, from those of the last frame, carried along, and the patches
        (C, PATCH) that they were; before: the patches that were told a frame ago."""
        at, turn = glued.at, moment.turn
        was = at.fitted(last, turn).flatten(1)
        change = was - before
        off, there = torch.zeros_like(last), torch.zeros_like(was)
        for number, step in enumerate(self.steps):
            ways, means = at.lacking(moment, off)
            pushed = at.fitted(ways, turn).flatten(1)
            said, stays = step(torch.cat([moment.seen, there, change, there - was, pushed, means], dim=1), at)
            if number == 0:
                share = torch.sigmoid(stays + GATE_BIAS)[glued.corner] * glued.share
                off = last * share.sum(1, keepdim=True)
            off = off + at.displaced(said.view(-1, CUBIC, 3), turn)
            if number + 1 < len(self.steps):
                there = at.fitted(off, turn).flatten(1)
        return off, was
