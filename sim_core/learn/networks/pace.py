"""How fast a training learns: a rate that grows over the first updates and dies away over all, gradients cut."""

# pyright: reportMissingImports=false
# (torch is an extra)

from __future__ import annotations

import math

import torch
from torch import Tensor, nn

__all__ = ["HEARD", "rate_at", "stepped"]

WARM = 100  # updates until the rate is whole
CLIPPED = 1.0  # length of a gradient
HEARD = 200  # updates whose loss is told, as a mean


def stepped(network: nn.Module, optimiser: torch.optim.Optimizer, loss: Tensor, rate: float) -> None:
    """One update of a network by the gradient of a loss."""
    for group in optimiser.param_groups:
        group["lr"] = rate
    optimiser.zero_grad()
    loss.backward()
    nn.utils.clip_grad_norm_(network.parameters(), CLIPPED)
    optimiser.step()


def rate_at(update: int, updates: int, whole: float) -> float:
    """Warm-up times a half cosine (Loshchilov and Hutter 2017)."""
    return whole * min(1.0, (update + 1) / WARM) * 0.5 * (1.0 + math.cos(math.pi * update / updates))
