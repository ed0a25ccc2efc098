"""Patches as arrays: what the light is computed on, and where each patch lies in them."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hall_app.room.patch import Patch
from hall_app.room.surface.palette import MATERIALS, linear

if TYPE_CHECKING:
    from hall_app.light.model import Surfaces

__all__ = ["Charts", "charts_of", "surfaces"]

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Charts:
    """chart: (P,) of each patch; flat: (V, 2) [m] of all patches' vertices in their charts, smallest 0; density: (C,)
    texels per metre; two_sided: (C,)."""

    chart: NDArray[np.int32]
    flat: tuple[Floats, ...]
    density: Floats
    two_sided: NDArray[np.bool_]


def charts_of(patches: Sequence[Patch]) -> Charts:
    """One chart per patch, or per group of patches with one key, which lie in one plane."""
    numbers: dict[Hashable, int] = {}
    chart = []
    for index, patch in enumerate(patches):
        key = ("own", index) if patch.chart is None else ("joint", patch.chart)
        chart.append(numbers.setdefault(key, len(numbers)))
    low = np.full((len(numbers), 2), np.inf)
    density, two_sided = np.zeros(len(numbers)), np.zeros(len(numbers), bool)
    for number, patch in zip(chart, patches, strict=True):
        low[number] = np.minimum(low[number], patch.flat.min(0))
        density[number] = patch.density or MATERIALS[patch.material].density
        two_sided[number] |= patch.two_sided
    flat = tuple(patch.flat - low[number] for number, patch in zip(chart, patches, strict=True))
    return Charts(np.array(chart, np.int32), flat, density, two_sided)


def surfaces(
    patches: Sequence[Patch], occluders: Sequence[tuple[Floats, NDArray[np.int32]]] = ()
) -> Surfaces:
    """The room for the light: every patch with its chart, albedo and glow; `occluders` (vertices, faces) have none."""
    from hall_app.light.model import Surfaces

    charts = charts_of(patches)
    counts = [len(patch.faces) for patch in patches]
    starts = np.cumsum([0, *(len(patch.vertices) for patch in patches)])
    faces = [patch.faces + start for patch, start in zip(patches, starts, strict=False)]
    chart_uv = [flat[patch.faces] for patch, flat in zip(patches, charts.flat, strict=True)]
    vertices = [patch.vertices for patch in patches]
    albedo = [_albedo(patch.material) for patch in patches]
    glow = [_glow(patch.material) for patch in patches]
    total, count = int(starts[-1]), 0
    for points, triangles in occluders:
        vertices.append(points)
        faces.append(triangles + total)
        total, count = total + len(points), count + len(triangles)
    return Surfaces(
        vertices=np.concatenate(vertices),
        faces=np.concatenate(faces).astype(np.int32),
        chart=np.r_[np.repeat(charts.chart, counts), np.full(count, -1)].astype(np.int32),
        chart_uv=np.concatenate([*chart_uv, np.zeros((count, 3, 2))]),
        density=charts.density,
        albedo=np.r_[np.repeat(albedo, counts, axis=0), np.full((count, 3), 0.25)].astype(np.float32),
        emission=np.r_[np.repeat(glow, counts, axis=0), np.zeros((count, 3))].astype(np.float32),
        two_sided=charts.two_sided,
    )


def _albedo(material: str) -> Floats:
    """Mean reflectance; a lamp's paper lets most light through, whatever colour it is drawn in."""
    look = MATERIALS[material]
    return linear(look.colour) * (0.6 if look.glow else 1.0)


def _glow(material: str) -> Floats:
    shine = MATERIALS[material]
    return shine.glow * linear(shine.tint)
