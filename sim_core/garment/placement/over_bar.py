"""How a strip is held before it is let go: gathered to soft folds, in an arch over the bar."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sim_core.errors import SimCoreError
from sim_core.garment.pattern import Cloth, Pattern
from sim_core.garment.placement.ground import Ground

__all__ = ["OverBar"]


@dataclass(frozen=True)
class OverBar:
    """A strip's start over a bar. Lengths in metres.

    front: cloth in front of the bar's axis; at_bar, at_end: gathered width there and at the free ends;
    folds: waves across the width; arch: radius of the start's arch; drop: its height above the bar;
    skew: turn about +y [rad]; spread: relative variation of the folds' widths.
    """

    front: float = 1.27
    at_bar: float = 0.14
    at_end: float = 0.25
    folds: float = 5.0
    arch: float = 0.09
    drop: float = 0.03
    skew: float = 0.10
    spread: float = 0.35

    halves = False  # `start` takes the whole of a mirrored pattern

    def hanging(self, cloth: Cloth) -> float:
        """The longest free length [m]."""
        return max(self.front, float(np.ptp(cloth.vertices[:, 1])) - self.front)

    def start(self, pattern: Pattern, cloth: Cloth, ground: Ground, rng: np.random.Generator) -> np.ndarray:
        """Positions (P, 3) [m]; raises SimCoreError where the cloth does not fit the stand."""
        stand = ground.bar()
        width, length = (float(c) for c in np.ptp(cloth.vertices, axis=0))
        gathering = self.resolved(width, ground.edge)
        longest = max(self.front, length - self.front)
        if not 0.1 < self.front < length - 0.1:
            raise SimCoreError(
                f"pattern {pattern.name}: {length:.2f} m long – needs more than front {self.front} + 0.1 m"
            )
        if longest > stand.height - 0.05:
            raise SimCoreError(
                f"pattern {pattern.name}: an end of {longest:.2f} m touches the floor – raise the stand's bar"
            )
        if max(gathering.at_bar, gathering.at_end) > stand.span - 0.1 or gathering.at_end > width:
            raise SimCoreError(
                f"pattern {pattern.name}: gathered to {gathering.at_end} m – between stand and cloth width"
            )
        return gathered_strip(cloth.vertices, stand.height, gathering, rng)

    def resolved(self, width: float, edge: float) -> OverBar:
        """As many folds as a mesh of step `edge` [m] shows, four edges to a fold; fewer folds are gathered less."""
        folds = min(self.folds, width / (4 * edge))
        loose = (1 - folds / self.folds) * 0.85
        at_bar = self.at_bar + loose * max(0.75 * width - self.at_bar, 0.0)
        at_end = self.at_end + loose * max(0.85 * width - self.at_end, 0.0)
        return replace(self, folds=folds, at_bar=at_bar, at_end=at_end)


def gathered_strip(
    rest: np.ndarray, bar_height: float, gathering: OverBar, rng: np.random.Generator
) -> np.ndarray:
    """Start positions (V, 3) of a strip rest (V, 2): x across, y along it (y = 0 hangs in front).

    Every cross-section is a wave whose arc length is the cloth's width, so that the cloth is hardly
    stretched across; along the strip the arch strains the folds' crests, which relaxes at once.
    """
    g = gathering
    width, length = np.ptp(rest, axis=0)
    # Counted from the right, so that the cloth's face, not its back, is turned to the visitor.
    across, along = rest[:, 0].max() - rest[:, 0], g.front - (rest[:, 1] - rest[:, 1].min())
    ends = np.array([g.front - length, g.front])
    phase, lean, wander = 2 * np.pi * rng.random(), rng.uniform(-0.5, 0.5), rng.uniform(-1, 1, 4)
    lateral, offset = np.zeros(len(rest)), np.zeros(len(rest))
    stations = np.linspace(ends[0], ends[1], 241)
    sections = [_section(s, ends, width, g, phase, lean, wander) for s in stations]
    t = (along - ends[0]) / (ends[1] - ends[0]) * (len(stations) - 1)
    low = np.clip(t.astype(int), 0, len(stations) - 2)
    for k in np.unique(low):
        here = low == k
        b = t[here] - k
        for out, column in ((lateral, 1), (offset, 2)):
            near, far = sections[k], sections[k + 1]
            first = np.interp(across[here], near[0], near[column])
            out[here] = (1 - b) * first + b * np.interp(across[here], far[0], far[column])
    return _arched(along, lateral, offset, bar_height, g)


def _section(
    s: float,
    ends: np.ndarray,
    width: float,
    g: OverBar,
    phase: float,
    lean: float,
    wander: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """One cross-section at arc length s: cloth coordinate 0..width, lateral place and offset (outwards)."""
    far = abs(s) / max(abs(ends[0]), abs(ends[1]))
    extent = g.at_bar + (g.at_end - g.at_bar) * far**0.8
    u = np.linspace(0, 1, 400)
    # The folds differ in width and wander a little down the cloth; the amplitude follows from the length.
    warp = u + g.spread * 0.5 / g.folds * (
        np.sin(2 * np.pi * u + phase) + 0.6 * np.sin(4 * np.pi * u + 2 * phase)
    )
    turn = 2 * np.pi * (g.folds * warp + 0.25 * wander[0] * np.sin(2.1 * s + wander[1])) + phase
    shape = np.cos(turn) * (1 + 0.3 * wander[2] * np.cos(np.pi * u + wander[3]))
    lateral = extent * (u - 0.5) + lean * 0.03 * s

    def length_of(amplitude: float) -> np.ndarray:
        steps = np.hypot(np.diff(lateral), amplitude * np.diff(shape))
        return np.r_[0.0, np.cumsum(steps)]

    low, high = 0.0, width
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if length_of(middle)[-1] < width else (low, middle)
    arc = length_of(low)
    return arc * (width / arc[-1]), lateral, low * shape


def _arched(
    along: np.ndarray, lateral: np.ndarray, offset: np.ndarray, bar_height: float, g: OverBar
) -> np.ndarray:
    """Bends the strip over an arch whose top is `drop` above the bar, straight down on both sides."""
    quarter = g.arch * np.pi / 2
    angle = np.clip(along / g.arch, -np.pi / 2, np.pi / 2)
    radius = g.arch + offset
    hanging = np.maximum(np.abs(along) - quarter, 0.0)
    z = radius * np.sin(angle)
    y = bar_height + g.drop + radius * np.cos(angle) - hanging
    c, s = np.cos(g.skew), np.sin(g.skew)
    return np.stack([c * lateral + s * z, y, -s * lateral + c * z], axis=1)
