"""What training knows of its sheets, as tensors: that of several sheets is that of one, glued."""

# pyright: reportMissingImports=false
# (torch is an extra)

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
import torch
from torch import Tensor

from sim_core.learn.inference import Ground

__all__ = ["Sheets"]

COARSE, FINE, EDGE = "coarse", "fine", "edge"
COUNTED = {  # what the numbers in an array count
    "near": COARSE, "corner": COARSE, "edges": FINE, "around": EDGE, "bent": FINE,
}  # fmt: skip


@dataclass(frozen=True)
class Sheets:
    """Of C coarse and V fine vertices, E edges and B entries of the bending matrix, one sheet or several.

    near (C, L), corner (V, 3), share (V, 3), lift, fit (V, 3, CUBIC): of `Surroundings` and `Patches`; edges (E, 2),
    length2, own, around, coupling: of the fine `Stencil`; bent (B, 2), bend (B,): its bending, from which vertex to
    which; edge_weight (E,): the mean length of a sheet's edges over each one's; mass, ease, led, unit (V, 1) and
    unit_coarse (C, 1): of `Imbalance` and `Ground`; about (C, 1): mass about a coarse vertex. Floats single, numbers
    int32.
    """

    near: Tensor
    corner: Tensor
    share: Tensor
    lift: Tensor
    fit: Tensor
    edges: Tensor
    length2: Tensor
    own: Tensor
    around: Tensor
    coupling: Tensor
    bent: Tensor
    bend: Tensor
    edge_weight: Tensor
    mass: Tensor
    ease: Tensor
    led: Tensor
    unit: Tensor
    unit_coarse: Tensor
    about: Tensor

    @staticmethod
    def of(ground: Ground, device: torch.device) -> Sheets:
        """Those of a ground."""
        stencil, patches, mass = ground.pair.fine.stencil, ground.patches, ground.pair.fine.mass
        lengths = np.sqrt(stencil.length2)
        begins = np.repeat(np.arange(len(mass)), np.diff(stencil.rows))
        about = np.zeros(patches.count)
        np.add.at(about, patches.corner, patches.share * mass[:, None])
        arrays = {
            "near": ground.surroundings.near,
            **{name: getattr(patches, name) for name in ("corner", "share", "lift", "fit")},
            **{
                name: getattr(stencil, name)
                for name in ("edges", "length2", "own", "around", "coupling", "bend")
            },
            "bent": np.column_stack([begins, stencil.neighbour]),
            "edge_weight": lengths.mean() / lengths,
            "mass": mass[:, None],
            "ease": ground.imbalance.ease,
            "led": np.full((len(mass), 1), ground.imbalance.led),
            "unit": np.full((len(mass), 1), ground.unit),
            "unit_coarse": np.full((patches.count, 1), ground.unit),
            "about": about[:, None],
        }
        kinds = {name: np.int32 if name in COUNTED else np.float32 for name in arrays}
        return Sheets(
            **{
                name: torch.from_numpy(np.array(array, kinds[name])).to(device)
                for name, array in arrays.items()
            }
        )

    @staticmethod
    def glued(sheets: Sequence[Sheets]) -> Sheets:
        """Several as one, whose vertices and edges come one after the other."""
        begins: dict[str, int] = dict.fromkeys((COARSE, FINE, EDGE), 0)
        parts: dict[str, list[Tensor]] = {field.name: [] for field in fields(Sheets)}
        for one in sheets:
            for name, found in parts.items():
                array = getattr(one, name)
                found.append(array + begins[COUNTED[name]] if name in COUNTED else array)
            begins = {
                COARSE: begins[COARSE] + len(one.near),
                FINE: begins[FINE] + len(one.corner),
                EDGE: begins[EDGE] + len(one.edges),
            }
        return Sheets(**{name: torch.cat(found) for name, found in parts.items()})
