"""Figures with their intervals, one a line: standardised loadings, effect sizes."""

from __future__ import annotations

from collections.abc import Sequence
from unicodedata import east_asian_width

import numpy as np
from numpy.typing import NDArray

from survey.report.figures.svg import BLUE, MARKERS, QUIET, RULE, SERIES, WIDTH, figure_of, style, svg_of

__all__ = ["intervals"]

BELOW = 0.45  # [inch] of the axis and its numbers
KEYS = 3  # of a legend in a line
WIDEST = 0.46  # of the figure, for the labels


def intervals(
    values: NDArray[np.float64],
    labels: Sequence[str],
    groups: Sequence[str],
    reach: tuple[float, float],
    name: str,
    title: str,
) -> str:
    """values (m, 3): figure, low, high, NaN where there is no interval. groups (m,): lines of one stand together and
    share a colour. reach: least extent of the axis."""
    low, high = min(reach[0], float(np.nanmin(values))), max(reach[1], float(np.nanmax(values)))
    seen = list(dict.fromkeys(groups))
    with style():
        keys = -(-len(seen) // KEYS) if len(seen) > 1 else 0  # lines of the legend, above what it explains
        body, above = 0.1 + 0.24 * len(values), 0.15 + 0.2 * keys
        height = BELOW + body + above
        left = _room(labels)
        figure = figure_of(WIDTH, height)
        axes = figure.add_axes((left, BELOW / height, 0.98 - left, body / height))
        axes.axvline(0.0, color=QUIET, linewidth=0.8)
        for at, group in enumerate(seen):
            lines = [line for line, own in enumerate(groups) if own == group]
            colour = SERIES[at % len(SERIES)] if len(seen) > 1 else BLUE
            for line in lines:
                axes.plot(values[line, 1:], [line, line], color=colour, linewidth=1.4, solid_capstyle="butt")
            axes.plot(
                values[lines, 0], lines, linestyle="none", marker=MARKERS[at % len(MARKERS)], color=colour,
                markersize=4.5, label=group,
            )  # fmt: skip
            if at:
                axes.axhline(lines[0] - 0.5, color=RULE, linewidth=0.6)
        axes.set_yticks(range(len(values)), labels)
        axes.set_ylim(len(values) - 0.4, -0.6)
        axes.set_xlim(low - 0.03 * (high - low), high + 0.03 * (high - low))
        if len(seen) > 1:
            axes.legend(
                frameon=False, loc="lower left", bbox_to_anchor=(-0.01, 1.0), ncols=KEYS, fontsize=7.5,
                borderpad=0.2,
            )  # fmt: skip
        return svg_of(figure, name, title)


def _room(labels: Sequence[str]) -> float:
    """The share of the figure's width that the labels need; a Chinese character is as wide as two others."""
    wide = max(sum(1 + (east_asian_width(sign) in "WF") for sign in label) for label in labels)
    return min(0.04 + 0.0095 * wide, WIDEST)
