"""What networks that see one frame at a time are given of a sheet: features of the base, in its own tangent frames."""

# pyright: reportMissingImports=false
# (torch is an extra)

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch
from scipy.sparse import csr_array
from torch import Tensor

from sim_core.learn.inference import Ground
from sim_core.learn.topology import border_vertices, edges
from sim_core.learn.upsampling import tangent_frames

__all__ = ["FEATURES", "Frames", "RivalSheet", "rows"]

FEATURES = 15  # numbers of a vertex
USUAL = 0.007  # [m] a unit; what its logarithm is told against


def rows(values: Tensor, numbers: Tensor) -> Tensor:
    """values (B, N, ...) at numbers (...), for each of B."""
    flat = values.index_select(1, numbers.flatten())
    return flat.view(len(values), *numbers.shape, *values.shape[2:])


@dataclass(frozen=True)
class Frames:
    """A batch of B frames of one sheet: base (B, V, 3) [m], its tangent frames `turn` (B, V, 3, 3) and features
    (B, V, FEATURES)."""

    base: Tensor
    turn: Tensor
    features: Tensor


class RivalSheet:
    """A ground as tensors of a device. ring (V, R), along, across, mean (V, R): sums over a vertex and its neighbours
    that give derivatives and the neighbours' mean; known (V, 3): pinned, on the border, and the sheet's size; faces."""

    def __init__(self, ground: Ground, device: torch.device) -> None:
        sheet, pins = ground.pair.fine, ground.pair.pins[1]
        count, unit = len(sheet.rest), ground.unit
        frames = tangent_frames(sheet.rest, sheet.faces)
        a, b = edges(sheet.faces).T
        links = csr_array((np.ones(2 * len(a)), (np.r_[a, b], np.r_[b, a])), shape=(count, count))
        mean = csr_array(links / np.asarray(links.sum(axis=1)).ravel()[:, None])
        most = int(np.diff(links.indptr).max()) + 1
        ring, weights = np.zeros((count, most), np.int64), np.zeros((3, count, most))
        for v in range(count):
            near = np.r_[v, links.indices[links.indptr[v] : links.indptr[v + 1]]]
            ring[v, : len(near)] = near
            for k, matrix in enumerate((frames.along, frames.across, mean)):
                row = slice(matrix.indptr[v], matrix.indptr[v + 1])
                own = dict(zip(matrix.indices[row].tolist(), matrix.data[row].tolist(), strict=True))
                weights[k, v, : len(near)] = [own.get(n, 0.0) for n in near.tolist()]
        known = np.zeros((count, 3))
        known[list(pins), 0] = 1.0
        known[:, 1] = border_vertices(sheet.faces, count)
        known[:, 2] = np.log(unit / USUAL)
        self.ground, self.unit, self.device = ground, unit, device
        self.ring = torch.from_numpy(ring).to(device)
        self.along, self.across, self.mean = (
            torch.from_numpy(one.astype(np.float32)).to(device) for one in weights
        )
        self.known = torch.from_numpy(known.astype(np.float32)).to(device)
        self.faces = torch.from_numpy(sheet.faces.astype(np.int64)).to(device)

    def frames(self, base: Tensor) -> Frames:
        """Of bases (B, 3, V, 3) [m]: now, a frame ago and two."""
        now = base[:, 0]
        around = rows(now, self.ring)  # (B, V, R, 3)
        first, second = ((one[..., None] * around).sum(2) for one in (self.along, self.across))
        first = torch.nn.functional.normalize(first, dim=2)
        normal = torch.nn.functional.normalize(torch.cross(first, second, dim=2), dim=2)
        turn = torch.stack([first, torch.cross(normal, first, dim=2), normal], dim=3)
        bent = (self.mean[..., None] * around).sum(2) - now
        speed, change = now - base[:, 1], now - 2.0 * base[:, 1] + base[:, 2]
        ways = torch.stack([bent, 0.1 * speed, 0.3 * change], dim=2) / self.unit
        local = (ways @ turn).flatten(2)
        told = torch.cat([local, -turn[:, :, 1], self.known.expand(len(now), -1, -1)], dim=2)
        return Frames(now, turn, told)

    def normals(self, places: Tensor) -> Tensor:
        """Unit normals (B, F, 3) of faces, at places (B, V, 3)."""
        corner = rows(places, self.faces)
        across = torch.cross(corner[:, :, 1] - corner[:, :, 0], corner[:, :, 2] - corner[:, :, 0], dim=2)
        return torch.nn.functional.normalize(across, dim=2, eps=1e-20)
