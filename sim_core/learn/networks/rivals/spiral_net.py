"""Spiral convolution on the fine mesh, pooled once and brought up again: the paper's network, and mesh convolution.

Both are one U of convolutions (Ranjan et al. 2018): a layer on all vertices, two on those that pooling keeps, and a
last one on all, which sees the first as well. The paper's has spirals of L = 100 and keeps 60 % by Gauss curvature; the
other spirals of 9 and a quarter by quadric errors. Base, features and loss are the same, so that convolution and
pooling are what is compared.
"""

# pyright: reportMissingImports=false
# (torch is an extra)

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor, nn

from sim_core.learn.convolution import spirals
from sim_core.learn.networks.rivals.sheet import FEATURES, Frames, RivalSheet, rows
from sim_core.learn.pooling import Pooled
from sim_core.learn.upsampling import linear

__all__ = ["SpiralNet", "Spirals"]


@dataclass(frozen=True)
class Spirals:
    """Of a sheet that is pooled: near (V, L), and below (K, L) of those that are kept (K,); up (V, 3) and its weights
    (V, 3) lead from these to all."""

    near: Tensor
    below: Tensor
    kept: Tensor
    up: Tensor
    weights: Tensor

    @staticmethod
    def of(sheet: RivalSheet, pooled: Pooled, length: int) -> Spirals:
        rest, faces = sheet.ground.pair.fine.rest, sheet.ground.pair.fine.faces
        flat = rest[pooled.kept]
        matrix = linear(flat, pooled.faces, rest)
        up, weights = np.zeros((len(rest), 3), np.int64), np.zeros((len(rest), 3), np.float32)
        row = np.repeat(np.arange(len(rest)), np.diff(matrix.indptr))
        place = np.arange(len(row)) - matrix.indptr[row]
        up[row, place], weights[row, place] = matrix.indices, matrix.data
        arrays = (spirals(faces, length, rest), spirals(pooled.faces, length, flat), pooled.kept, up)
        near, below, kept, up = (
            torch.from_numpy(np.asarray(one, np.int64)).to(sheet.device) for one in arrays
        )
        return Spirals(near, below, kept, up, torch.from_numpy(weights).to(sheet.device))


class _Convolution(nn.Module):
    """Spiral convolution (Lim et al. 2018): one matrix over a spiral's features, one after the other."""

    def __init__(self, before: int, after: int, length: int) -> None:
        super().__init__()
        self.matrix = nn.Linear(before * length, after)

    def forward(self, x: Tensor, near: Tensor) -> Tensor:
        return self.matrix(rows(x, near).flatten(2))


class SpiralNet(nn.Module):
    """Displacements (B, V, 3) [m] from the base, zero at first."""

    def __init__(self, length: int, width: int) -> None:
        super().__init__()
        self.length = length
        self.first = _Convolution(FEATURES, width, length)
        self.down = _Convolution(width, 2 * width, length)
        self.deep = _Convolution(2 * width, 2 * width, length)
        self.last = _Convolution(3 * width, width, length)
        self.out = nn.Linear(width, 3)
        nn.init.zeros_(self.out.weight)
        nn.init.zeros_(self.out.bias)

    def forward(self, frames: Frames, sheet: RivalSheet, tables: Spirals) -> Tensor:
        act = nn.functional.silu
        fine = act(self.first(frames.features, tables.near))
        pooled = fine.index_select(1, tables.kept)
        deep = act(self.down(pooled, tables.below))
        deep = deep + act(self.deep(deep, tables.below))
        up = (rows(deep, tables.up) * tables.weights[..., None]).sum(2)
        last = act(self.last(torch.cat([fine, up], dim=2), tables.near))
        return sheet.unit * (frames.turn @ self.out(last)[..., None])[..., 0]
