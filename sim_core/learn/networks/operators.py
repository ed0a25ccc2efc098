"""The compiled loops as operators that torch differentiates; on a GPU the same sums by its own gathers."""

# pyright: reportMissingImports=false
# (torch is an extra)

from __future__ import annotations

from typing import Any

import numpy as np
import torch
from torch import Tensor

from sim_core.learn.convolution import depthwise, depthwise_gradients
from sim_core.learn.patches import CUBIC
from sim_core.learn.patches.kernels import add_up, carry_over, draw_down

__all__ = ["Carried", "Displaced", "EdgeGap", "Fitted", "SpiralMix"]


def _array(tensor: Tensor) -> np.ndarray:
    return tensor.detach().contiguous().numpy()


class SpiralMix(torch.autograd.Function):
    """`depthwise`: features (N, W), weights (L, W), spirals (N, L) int32 as an array -> (N, W)."""

    @staticmethod
    def forward(ctx: Any, features: Tensor, weights: Tensor, spirals: np.ndarray) -> Tensor:
        ctx.save_for_backward(features, weights)
        ctx.spirals = spirals
        return torch.from_numpy(depthwise(_array(features), spirals, _array(weights)))

    @staticmethod
    def backward(ctx: Any, *upon: Tensor) -> tuple[Tensor, Tensor, None]:
        features, weights = (_array(one) for one in ctx.saved_tensors)
        of_features, of_weights = depthwise_gradients(features, ctx.spirals, weights, _array(upon[0]))
        return torch.from_numpy(of_features), torch.from_numpy(of_weights), None


def _down(patches: Tensor, turn: np.ndarray, corner: np.ndarray, weights: np.ndarray) -> Tensor:
    out = np.zeros((len(corner), 3), np.float32)
    draw_down(_array(patches), turn, corner, weights, out)
    return torch.from_numpy(out)


def _up(fine: Tensor, turn: np.ndarray, corner: np.ndarray, weights: np.ndarray) -> Tensor:
    out = np.zeros((len(turn), CUBIC, 3), np.float32)
    add_up(_array(fine), turn, corner, weights, out)
    return torch.from_numpy(out)


class Displaced(torch.autograd.Function):
    """Patches (C, CUBIC, 3) -> displacements (V, 3): `Patches.displaced`."""

    @staticmethod
    def forward(ctx: Any, patches: Tensor, *fixed: np.ndarray) -> Tensor:
        ctx.fixed = fixed
        return _down(patches, *fixed)

    @staticmethod
    def backward(ctx: Any, *upon: Tensor) -> tuple[Tensor, None, None, None]:
        return _up(upon[0], *ctx.fixed), None, None, None


class Fitted(torch.autograd.Function):
    """Displacements (V, 3) -> patches (C, CUBIC, 3): `Patches.fitted`."""

    @staticmethod
    def forward(ctx: Any, fine: Tensor, *fixed: np.ndarray) -> Tensor:
        ctx.fixed = fixed
        return _up(fine, *fixed)

    @staticmethod
    def backward(ctx: Any, *upon: Tensor) -> tuple[Tensor, None, None, None]:
        return _down(upon[0], *ctx.fixed), None, None, None


class Carried(torch.autograd.Function):
    """Displacements (V, 3) of the frames `before`, in the frames `turn`: `Patches.carried`; its gradient goes back."""

    @staticmethod
    def forward(ctx: Any, fine: Tensor, *fixed: np.ndarray) -> Tensor:
        ctx.fixed = fixed
        out = np.zeros(fine.shape, np.float32)
        before, turn, corner, share = fixed
        carry_over(_array(fine), before, turn, corner, share, out)
        return torch.from_numpy(out)

    @staticmethod
    def backward(ctx: Any, *upon: Tensor) -> tuple[Tensor, None, None, None, None]:
        before, turn, corner, share = ctx.fixed
        out = np.zeros(upon[0].shape, np.float32)
        carry_over(_array(upon[0]), turn, before, corner, share, out)
        return torch.from_numpy(out), None, None, None, None


class EdgeGap(torch.autograd.Function):
    """Mean over edges (E, 2) of how far the two ends' errors, of (V, 3), are apart, over the edge's share of the mean
    length: what is wrong with normals and strain."""

    @staticmethod
    def forward(ctx: Any, errors: Tensor, edges: np.ndarray, weight: np.ndarray) -> Tensor:
        off = _array(errors)
        apart = off[edges[:, 0]] - off[edges[:, 1]]
        size = np.sqrt((apart * apart).sum(1) + 1e-6)
        slope = apart * (weight / size / len(edges))[:, None]
        gradient = np.zeros_like(off)
        for c in range(3):
            gradient[:, c] = np.bincount(edges[:, 0], slope[:, c], len(off))
            gradient[:, c] -= np.bincount(edges[:, 1], slope[:, c], len(off))
        ctx.gradient = torch.from_numpy(gradient)
        return torch.tensor(float((size * weight).mean()))

    @staticmethod
    def backward(ctx: Any, *upon: Tensor) -> tuple[Tensor, None, None]:
        return ctx.gradient * upon[0], None, None
