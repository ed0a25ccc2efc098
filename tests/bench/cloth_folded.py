"""A sheet folded over a bar onto itself: the scene in which layers are compared with peers, because it has a limit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sim_core.cloth import Capsule, Contact, Phase, Sheet
from sim_core.cloth.scenes import GF_CM, Scene, equilateral_sheet

WIDTH, LENGTH, BENEATH = (
    0.1,
    0.5,
    0.245,
)  # [m] of the sheet, and what of it lies below the bar's outermost place
QUARTER, ABOVE = 4, 3  # rows to a quarter round the bar, and those that lie on it above
THICKNESS = 0.004  # [m] that layers keep; from the bar the cloth keeps half of it, as MuJoCo's radius has it
SKIN = 0.004  # [m] that we look further than that
DAMPING = 8.0  # [1/s] of mass: brings it to rest within a second
FROM_BAR = 0.1  # [m] that the bar stands out on either side


def profile(rows: int, held: int, row: float) -> tuple[np.ndarray, float]:
    """Places (rows, 2) [m], outwards and up, of the rows of a sheet around a bar, and the radius [m] they lie at.

    held: the row at the bar's outermost place; below, the cloth leaves the bar after a quarter, level; above after
    ABOVE rows, rising. Every chord is as long as the rows are apart: the sheet is not strained.
    """
    turn = np.pi / 2 / QUARTER
    radius = row / 2 / np.sin(turn / 2)

    def side(count: int, round_bar: int) -> np.ndarray:
        angle = turn * np.arange(round_bar + 1)
        arc = radius * np.column_stack([np.cos(angle), np.sin(angle)])
        along = np.array([-np.sin(angle[-1]), np.cos(angle[-1])])
        return np.concatenate([arc, arc[-1] + row * np.arange(1, count - round_bar + 1)[:, None] * along])

    below = side(held, QUARTER) * [1.0, -1.0]
    return np.concatenate([below[::-1], side(rows - 1 - held, ABOVE)[1:]]), radius


def folded(edge: float = 0.01, *, seconds: float = 1.0) -> Scene:
    """A sheet of 0.1 x 0.5 m that lies around a bar, one end and the row at the bar's outermost place held.

    Below the bar it is a hammock; the free half above it falls on it and comes to rest there. No friction, which is
    another law in every engine; the preset's damping of stiffness, and as much of mass as brings it to rest.
    """
    rest, faces = equilateral_sheet(WIDTH, LENGTH, edge)
    heights = np.unique(rest[:, 1])
    row, at = heights[1] - heights[0], np.searchsorted(heights, rest[:, 1] - 1e-9)
    held = round(BENEATH / row)
    places, radius = profile(len(heights), held, row)
    start = np.column_stack([rest[:, 0] - WIDTH / 2, places[at, 1], places[at, 0]])
    cloth = replace(GF_CM, friction=0.0, mass_damping=DAMPING)
    contact = Contact(
        clearance=THICKNESS / 2, sample_clearance=0.0, thickness=THICKNESS, skin=SKIN, self_friction=0.0
    )
    half = WIDTH / 2 + FROM_BAR
    bar = Capsule((-half, 0.0, 0.0), (half, 0.0, 0.0), radius - THICKNESS / 2)
    pins = tuple(np.flatnonzero((at == 0) | (at == held)).tolist())
    sheet, phases = Sheet.of(rest, faces, cloth), (Phase(seconds, label="folded"),)
    return Scene("folded", sheet, start, phases, pins=pins, collider=bar, contact=contact)
