"""Sections of yarns of untwisted filaments: pressed where they cross, spread on floats until neighbours touch.

A bundle keeps its area. On a float nothing holds its filaments together, and they spread sideways as far as
`Yarn.spread` lets them; where it dives between neighbours that lie beside it, it is gathered between them. Two yarns
share a place where one lies high enough above the other: the same norm that stage B uses for its contacts,
(d / (a1 + a2))² + (z / (b1 + b2))² >= 1, with half widths a and half heights b. Yarns go on lying on those that they
cross: what is spread sinks, what is gathered rises.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sim_core.weave.yarns.geometry import Strands
from sim_core.weave.yarns.splines import eased

__all__ = ["relaxed_sections"]

GATHERED = 0.6  # of a yarn's half width: as narrow as neighbours press it, assumption
ROUNDS, GROWTH = 16, 0.06  # of spreading and pressing by turns; by how much of the half width at a time
BLENDED = 0.8  # of a yarn's width: how far along the yarn a change of its section takes, assumption


def relaxed_sections(system: Strands, above: np.ndarray, neighbours: int = 2) -> Strands:
    """The same yarns with their sections at rest.

    above: (yarns, crossings) bool, where the yarn lies on the one that it crosses.  neighbours: how many yarns on each
    side may touch one (more where several share a place).
    """
    yarn, step = system.yarn, system.length / system.side.shape[1]
    half, tall = yarn.width / 2, yarn.height / 2
    there = system.colour >= 0
    depth = (
        system.length / above.shape[1] * np.maximum(_depth_of_floats(above, system.side.shape[1]) - 0.5, 0.0)
    )
    free = half * (1.0 + yarn.spread * (1.0 - np.exp(-((depth / half) ** 2))))
    order = np.argsort(system.place, kind="stable")
    places = (system.place[:, None] + system.side)[order]
    crowd = _Crowd(places, system.height[order], there[order], system.across, half * tall, neighbours)
    left, right = _spread(free[order], half, crowd)
    reach = BLENDED * yarn.width / step
    left, right = crowd.apart(_blended(left, reach), _blended(right, reach), GATHERED * half)
    back = np.argsort(order)
    wide = (0.5 * (left + right))[back]
    heights = half * tall / wide
    side = eased(np.where(above, 1.0, -1.0), system.side.shape[1])  # 1 on top of what it crosses, -1 beneath
    return replace(
        system,
        side=system.side + (0.5 * (right - left))[back],
        height=system.height - side * (tall - heights),
        half_width=wide,
        half_height=heights,
    )


def _spread(free: np.ndarray, half: float, crowd: _Crowd) -> tuple[np.ndarray, np.ndarray]:
    """How far yarns reach to the left and to the right of their axes (yarns, n), each as wide as `free` (half) lets it
    where its neighbours leave it room, if only on one side."""
    left, right = (np.minimum(free, half) for _ in range(2))
    for _ in range(ROUNDS):
        left, right = left + GROWTH * half, right + GROWTH * half
        most = np.minimum(2.0 * free / (left + right), 1.0)
        left, right = crowd.apart(left * most, right * most, GATHERED * half)
    return left, right


@dataclass(frozen=True, eq=False)
class _Crowd:
    """Yarns in their order across: places and heights of their axes (yarns, n) [m], where they are, after how much the
    repeat begins anew, half width times half height of each section, and how many neighbours may touch."""

    places: np.ndarray
    heights: np.ndarray
    there: np.ndarray
    across: float
    area: float
    neighbours: int

    def apart(self, left: np.ndarray, right: np.ndarray, least: float) -> tuple[np.ndarray, np.ndarray]:
        """Reaches to both sides (yarns, n) [m], lessened by as much each where neighbours would overlap."""
        thick = 2.0 * self.area / (left + right)
        left, right = left.copy(), right.copy()
        for apart in range(1, min(self.neighbours, len(left) - 1) + 1):
            places, heights, thicks, there, lefts = (
                np.roll(values, -apart, axis=0)
                for values in (self.places, self.heights, thick, self.there, left)
            )
            gap = places - self.places
            gap -= self.across * np.floor(gap / self.across)
            lift = np.minimum(np.abs(heights - self.heights) / (thick + thicks), 1.0)
            room = gap / np.sqrt(np.maximum(1.0 - lift**2, 1e-6))
            over = np.where(there & self.there, np.maximum(right + lefts - room, 0.0), 0.0)
            right -= 0.5 * over
            left -= np.roll(0.5 * over, apart, axis=0)
        short = np.maximum(
            2.0 * least - (left + right), 0.0
        )  # never narrower than that: they overlap instead
        return left + 0.5 * short, right + 0.5 * short


def _depth_of_floats(above: np.ndarray, n: int) -> np.ndarray:
    """(yarns, n) crossings from each place to where its yarn last or next changes side, whichever is nearer."""
    crossings = above.shape[1]
    place = np.arange(n) * crossings / n
    found = np.full((len(above), n), float(crossings))
    changes = above != np.roll(above, -1, axis=1)  # between crossing k and the next
    for row in range(len(above)):
        at = np.flatnonzero(changes[row]) + 0.5
        if not at.size:
            continue
        lap = np.concatenate([[at[-1] - crossings], at, [at[0] + crossings]])
        after = np.searchsorted(lap, place, side="right")
        found[row] = np.minimum(place - lap[after - 1], lap[after] - place)
    return found


def _blended(values: np.ndarray, reach: float) -> np.ndarray:
    """Rows smoothed by a bell `reach` places wide, round the repeat."""
    frequency = np.fft.rfftfreq(values.shape[1])
    bell = np.exp(-2.0 * (np.pi * reach * frequency) ** 2)
    return np.fft.irfft(np.fft.rfft(values, axis=1) * bell, values.shape[1], axis=1)
