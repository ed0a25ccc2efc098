"""The sums of `compiled` by torch's own gathers, for a GPU; there their order, and the last bits, are not fixed."""

# pyright: reportMissingImports=false
# (torch is an extra)

from __future__ import annotations

import torch
from torch import Tensor

from sim_core.learn.data import STIFFNESS
from sim_core.learn.inference.ground import FURTHEST_WAY
from sim_core.learn.networks.moment import Moment
from sim_core.learn.networks.sheets import Sheets
from sim_core.learn.patches import SAG

__all__ = ["Gathered"]


class Gathered:
    """Of sheets, glued."""

    def __init__(self, sheets: Sheets) -> None:
        self.sheets = sheets

    def mixed(self, features: Tensor, weights: Tensor) -> Tensor:
        """`depthwise`: features (C, W), weights (L, W) -> (C, W)."""
        return (_rows(features, self.sheets.near) * weights).sum(1)

    def displaced(self, patches: Tensor, turn: Tensor) -> Tensor:
        """Patches (C, CUBIC, 3) -> displacements (V, 3): `Patches.displaced`."""
        corner, lift = self.sheets.corner, self.sheets.lift
        own = (lift[..., None] * _rows(patches, corner)).sum(2)
        return (_rows(turn, corner) * own[:, :, None]).sum((1, 3))

    def fitted(self, fine: Tensor, turn: Tensor) -> Tensor:
        """Displacements (V, 3) -> patches (C, CUBIC, 3): `Patches.fitted`."""
        corner, fit = self.sheets.corner, self.sheets.fit
        own = (_rows(turn, corner) * fine[:, None, :, None]).sum(2)
        parts = fit[..., None] * own[:, :, None]
        out = torch.zeros(len(turn), *parts.shape[2:], dtype=fine.dtype, device=fine.device)
        return out.index_add(0, corner.flatten(), parts.flatten(0, 1))

    def carried(self, fine: Tensor, before: Tensor, turn: Tensor) -> Tensor:
        """Displacements (V, 3) of the frames `before`, in the frames `turn` (C, 3, 3): `Patches.carried`."""
        corner, share = self.sheets.corner, self.sheets.share
        own = (_rows(before, corner) * fine[:, None, :, None]).sum(2)
        return (_rows(turn, corner) * (share[..., None] * own)[:, :, None]).sum((1, 3))

    def edge_gap(self, errors: Tensor) -> Tensor:
        """Mean over edges of how far the two ends' errors, of (V, 3), are apart, over the edge's share of the mean
        length: what is wrong with normals and strain."""
        ends = _rows(errors, self.sheets.edges)
        apart = ends[:, 0] - ends[:, 1]
        return ((apart.square().sum(1) + 1e-6).sqrt() * self.sheets.edge_weight).mean()

    def lacking(self, moment: Moment, off: Tensor) -> tuple[Tensor, Tensor]:
        """What balance lacks where the fine sheet is off (V, 3), in units: `Imbalance.ways`; not differentiated."""
        with torch.no_grad():
            sheets = self.sheets
            fine = (moment.base + sheets.unit * off).double()
            missing = self._accelerations(fine) - moment.shared
            missing = missing - sheets.led * self._spread(self._mean(fine - self._spread(moment.coarse)))
            means = self._mean(torch.where(sheets.ease > 0.0, missing, 0.0)) / STIFFNESS
            ways = _limited(sheets.ease * missing / sheets.unit, FURTHEST_WAY)
            turned = (moment.turn * (_limited(means, SAG) / sheets.unit_coarse)[:, :, None]).sum(1)
            return ways.float(), turned.float()

    def _mean(self, fine: Tensor) -> Tensor:
        sheets = self.sheets
        parts = (sheets.share * sheets.mass)[..., None] * fine[:, None]
        out = torch.zeros(len(sheets.about), 3, dtype=fine.dtype, device=fine.device)
        return out.index_add(0, sheets.corner.flatten(), parts.flatten(0, 1)) / sheets.about

    def _spread(self, coarse: Tensor) -> Tensor:
        return (self.sheets.share[..., None] * _rows(coarse, self.sheets.corner)).sum(1)

    def _accelerations(self, fine: Tensor) -> Tensor:
        """By stretch and bending, as `sheet/energies.py` has them."""
        sheets = self.sheets
        ends, bent = _rows(fine, sheets.edges), _rows(fine, sheets.bent)
        apart = ends[:, 1] - ends[:, 0]
        strain = apart.square().sum(1) - sheets.length2
        tension = 2.0 * (sheets.own * strain + (sheets.coupling * _rows(strain, sheets.around)).sum(1))
        pull = tension[:, None] * apart
        force = torch.zeros_like(fine).index_add(0, sheets.edges[:, 0], pull)
        force = force.index_add(0, sheets.edges[:, 1], -pull)
        force = force.index_add(0, sheets.bent[:, 0], -sheets.bend[:, None] * (bent[:, 1] - bent[:, 0]))
        return force / sheets.mass


def _rows(values: Tensor, numbers: Tensor) -> Tensor:
    """values (N, ...) at numbers (...)."""
    return values.index_select(0, numbers.flatten()).view(*numbers.shape, *values.shape[1:])


def _limited(vectors: Tensor, most: float) -> Tensor:
    size = vectors.norm(dim=1, keepdim=True)
    return vectors * (most / size.clamp(min=1e-300)).clamp(max=1.0)
