"""The mass of a sheet shared out so that no vertex is lighter than the time step of the others can bear.

An explicit step is limited by the largest of stiffness over mass of any vertex. Lumped by thirds of their faces, a few
vertices at borders, held by two right-angled faces instead of three or six, are light for how stiffly they are held,
and make every vertex take shorter steps: on a coat, two dozen of six thousand set a step a fifth shorter.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sim_core.cloth.sheet.sheet import Sheet


def evened(sheet: Sheet, density: np.ndarray, *, own: int | None = None) -> Sheet:
    """The sheet with light vertices as heavy as their stiffness asks, all others lighter by what that takes.

    density: (F,) of each face, in any unit; stiffness is taken to go with it, as of cloth laid double. "As heavy": that
    stiffness over mass is at most the median of all vertices. The mass of the first `own` vertices (None: of all)
    stays what it is.
    """
    corner, faces, count = sheet.corner, sheet.faces, len(sheet.mass)
    stiff, light = np.zeros((2, count))
    a, b = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    area = 0.5 * np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
    for k in range(3):
        opposite2 = ((corner[:, (k + 1) % 3] - corner[:, (k + 2) % 3]) ** 2).sum(1)
        # A times the squared gradient of the vertex's share in the face, which is one over its height there.
        stiff += np.bincount(faces[:, k], density * opposite2 / (4 * area), count)
        light += np.bincount(faces[:, k], density * area / 3, count)
    ratio = stiff / light
    mass = sheet.mass * np.maximum(1.0, ratio / np.median(ratio))
    mass *= sheet.mass[:own].sum() / mass[:own].sum()
    return replace(sheet, mass=mass, stencil=sheet.stencil._replace(inverse_mass=1 / mass))
