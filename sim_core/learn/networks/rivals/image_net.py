"""Geometry images: MFSR, multi-feature super-resolution (Chen, Ye and Zhang 2021).

Sheets are rectangles, so an image of one loses nothing that its grid does not: pixels are places at rest. Positions,
normals and velocities of the coarse sheet are nine channels; a trunk of residual blocks, three heads that double the
resolution (Lim et al. 2017; Shi et al. 2016), of which displacement, from the same base as all, is used.
"""

# pyright: reportMissingImports=false
# (torch is an extra)

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor, nn

from sim_core.learn.networks.rivals.sheet import Frames, RivalSheet
from sim_core.learn.upsampling.location import located

__all__ = ["ImageNet", "Images"]

CHANNELS = 9


@dataclass(frozen=True)
class Images:
    """Of a sheet: pixel (P, 3) and share (P, 3), the corners and weights of fine faces in which pixels of the coarse
    image of height and width lie; place (V, 2), where vertices lie in an image, from -1 to 1."""

    height: int
    width: int
    pixel: Tensor
    share: Tensor
    place: Tensor

    @staticmethod
    def of(sheet: RivalSheet) -> Images:
        fine, coarse = sheet.ground.pair.fine, sheet.ground.pair.coarse
        low, size = fine.rest.min(0), np.ptp(fine.rest, axis=0)
        step = float(np.sqrt(np.prod(size) / len(coarse.rest)))
        width, height = (int(np.ceil(side / step)) + 1 for side in size)
        grid = np.stack(np.meshgrid(np.linspace(0, 1, width), np.linspace(0, 1, height)), axis=-1).reshape(
            -1, 2
        )
        face, share = located(fine.rest, fine.faces, low + size * grid)
        place = 2.0 * (fine.rest - low) / size - 1.0
        tensors = (
            torch.from_numpy(np.ascontiguousarray(fine.faces[face], np.int64)),
            torch.from_numpy(share.astype(np.float32)),
            torch.from_numpy(place.astype(np.float32)),
        )
        return Images(height, width, *(one.to(sheet.device) for one in tensors))

    def image(self, values: Tensor) -> Tensor:
        """(B, K, height, width) of values (B, V, K)."""
        corner = values.index_select(1, self.pixel.flatten()).view(len(values), *self.pixel.shape, -1)
        flat = (corner * self.share[..., None]).sum(2)
        return flat.transpose(1, 2).reshape(len(values), -1, self.height, self.width)


class _Block(nn.Module):
    def __init__(self, width: int) -> None:
        super().__init__()
        self.one, self.two = (nn.Conv2d(width, width, 3, padding=1) for _ in range(2))

    def forward(self, x: Tensor) -> Tensor:
        return x + self.two(nn.functional.relu(self.one(x)))


class ImageNet(nn.Module):
    """Displacements (B, V, 3) [m] from the base, in the world's axes as the published one, zero at first."""

    def __init__(self, width: int = 48, blocks: int = 3) -> None:
        super().__init__()
        self.begin = nn.Conv2d(CHANNELS, width, 3, padding=1)
        self.trunk = nn.Sequential(*(_Block(width) for _ in range(blocks)))
        self.heads = nn.ModuleList(
            nn.Sequential(
                nn.Conv2d(width, 4 * 16, 3, padding=1), nn.PixelShuffle(2), nn.Conv2d(16, 3, 3, padding=1)
            )
            for _ in range(3)
        )
        for head in self.heads:
            nn.init.zeros_(head[2].weight)
            nn.init.zeros_(head[2].bias)

    def forward(self, frames: Frames, sheet: RivalSheet, tables: Images) -> Tensor:
        return self.every(frames, sheet, tables)[0]

    def every(self, frames: Frames, sheet: RivalSheet, tables: Images) -> tuple[Tensor, Tensor, Tensor]:
        """Displacement and speed (B, V, 3) [m, m a frame] from the base's, and the normal's change (B, V, 3)."""
        middle = frames.base - frames.base.mean(1, keepdim=True)
        local = frames.features[:, :, 3:6]
        speed = (frames.turn @ local[..., None])[..., 0]
        told = torch.cat([middle / (20.0 * sheet.unit), frames.turn[..., 2], speed], dim=2)
        x = self.begin(tables.image(told))
        x = x + self.trunk(x)
        grid = tables.place[None, :, None].expand(len(x), -1, -1, -1)
        made = (
            nn.functional.grid_sample(head(x), grid, align_corners=True)[..., 0].transpose(1, 2)
            for head in self.heads
        )
        off, normal, fast = made
        return sheet.unit * off, normal, sheet.unit * fast
