"""The compiled loops that also infer, as operators that torch differentiates, on the CPU."""

# pyright: reportMissingImports=false
# (torch is an extra)

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import torch
from torch import Tensor

from sim_core.learn.convolution import depthwise, depthwise_gradients
from sim_core.learn.inference import Ground
from sim_core.learn.networks.moment import Moment
from sim_core.learn.networks.sheets import Sheets
from sim_core.learn.patches import CUBIC
from sim_core.learn.patches.kernels import add_up, carry_over, draw_down
from sim_core.learn.topology import unsigned

__all__ = ["Compiled"]


class Compiled:
    """Of sheets, glued from these grounds."""

    def __init__(self, grounds: Sequence[Ground], sheets: Sheets) -> None:
        self.grounds, self.sheets = tuple(grounds), sheets
        arrays = {name: getattr(sheets, name).numpy() for name in ("near", "corner", "share", "lift", "fit")}
        self._near, self._corner, self._share, self._lift, self._fit = arrays.values()
        self._coarse = np.cumsum([0, *(one.patches.count for one in grounds)])
        self._fine = np.cumsum([0, *(len(one.pair.fine.rest) for one in grounds)])

    def mixed(self, features: Tensor, weights: Tensor) -> Tensor:
        """`depthwise`: features (C, W), weights (L, W) -> (C, W)."""
        return _Mixed.apply(features, weights, self._near)

    def displaced(self, patches: Tensor, turn: Tensor) -> Tensor:
        """Patches (C, CUBIC, 3) -> displacements (V, 3): `Patches.displaced`."""
        return _Displaced.apply(patches, turn.numpy(), self._corner, self._lift)

    def fitted(self, fine: Tensor, turn: Tensor) -> Tensor:
        """Displacements (V, 3) -> patches (C, CUBIC, 3): `Patches.fitted`."""
        return _Fitted.apply(fine, turn.numpy(), self._corner, self._fit)

    def carried(self, fine: Tensor, before: Tensor, turn: Tensor) -> Tensor:
        """Displacements (V, 3) of the frames `before`, in the frames `turn` (C, 3, 3): `Patches.carried`."""
        return _Carried.apply(fine, before.numpy(), turn.numpy(), self._corner, self._share)

    def edge_gap(self, errors: Tensor) -> Tensor:
        """Mean over edges of how far the two ends' errors, of (V, 3), are apart, over the edge's share of the mean
        length: what is wrong with normals and strain."""
        return _EdgeGap.apply(errors, self.sheets.edges.numpy(), self.sheets.edge_weight.numpy())

    def lacking(self, moment: Moment, off: Tensor) -> tuple[Tensor, Tensor]:
        """What balance lacks where the fine sheet is off (V, 3), in units: `Imbalance.ways`; not differentiated."""
        ways, means, now = [], [], off.detach().numpy()
        turn, base, coarse, shared = (
            getattr(moment, name).numpy() for name in ("turn", "base", "coarse", "shared")
        )
        for k, ground in enumerate(self.grounds):
            above, below = (slice(a[k], a[k + 1]) for a in (self._coarse, self._fine))
            fine = base[below] + ground.unit * now[below]
            way, mean = ground.lacking(fine, coarse[above], shared[below], turn[above])
            ways.append(way)
            means.append(mean)
        return tuple(torch.from_numpy(np.concatenate(one).astype(np.float32)) for one in (ways, means))


def _array(tensor: Tensor) -> np.ndarray:
    return tensor.detach().contiguous().numpy()


class _Mixed(torch.autograd.Function):
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
    draw_down(_array(patches), turn, unsigned(corner), weights, out)
    return torch.from_numpy(out)


def _up(fine: Tensor, turn: np.ndarray, corner: np.ndarray, weights: np.ndarray) -> Tensor:
    out = np.zeros((len(turn), CUBIC, 3), np.float32)
    add_up(_array(fine), turn, unsigned(corner), weights, out)
    return torch.from_numpy(out)


class _Displaced(torch.autograd.Function):
    """Patches (C, CUBIC, 3) -> displacements (V, 3): `Patches.displaced`."""

    @staticmethod
    def forward(ctx: Any, patches: Tensor, *fixed: np.ndarray) -> Tensor:
        ctx.fixed = fixed
        return _down(patches, *fixed)

    @staticmethod
    def backward(ctx: Any, *upon: Tensor) -> tuple[Tensor, None, None, None]:
        return _up(upon[0], *ctx.fixed), None, None, None


class _Fitted(torch.autograd.Function):
    """Displacements (V, 3) -> patches (C, CUBIC, 3): `Patches.fitted`."""

    @staticmethod
    def forward(ctx: Any, fine: Tensor, *fixed: np.ndarray) -> Tensor:
        ctx.fixed = fixed
        return _up(fine, *fixed)

    @staticmethod
    def backward(ctx: Any, *upon: Tensor) -> tuple[Tensor, None, None, None]:
        return _down(upon[0], *ctx.fixed), None, None, None


class _Carried(torch.autograd.Function):
    """Displacements (V, 3) of the frames `before`, in the frames `turn`: `Patches.carried`; its gradient goes back."""

    @staticmethod
    def forward(ctx: Any, fine: Tensor, *fixed: np.ndarray) -> Tensor:
        ctx.fixed = fixed
        out = np.zeros(fine.shape, np.float32)
        before, turn, corner, share = fixed
        carry_over(_array(fine), before, turn, unsigned(corner), share, out)
        return torch.from_numpy(out)

    @staticmethod
    def backward(ctx: Any, *upon: Tensor) -> tuple[Tensor, None, None, None, None]:
        before, turn, corner, share = ctx.fixed
        out = np.zeros(upon[0].shape, np.float32)
        carry_over(_array(upon[0]), turn, before, unsigned(corner), share, out)
        return torch.from_numpy(out), None, None, None, None


class _EdgeGap(torch.autograd.Function):
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
