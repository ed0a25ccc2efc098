"""The report's other figures as SVG: scatter matrix, eigenvalues, loadings, means of modules and dimensions."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from survey.report.figures.svg import (
    BLUE,
    MARKERS,
    QUIET,
    RED,
    RULE,
    SERIES,
    WIDTH,
    figure_of,
    style,
    svg_of,
)
from survey.report.tables import MANY

__all__ = ["lines", "loadings", "scatter_matrix", "scree"]


def scatter_matrix(table: NDArray[np.float64], labels: Sequence[str], name: str, title: str) -> str:
    """Fig. 7: every pair of k items; whole scores lie on each other, so the area of a point counts them."""
    count = len(labels)
    low, high = np.nanmin(table), np.nanmax(table)
    margin = 0.12 * max(high - low, 1.0)
    with style():
        figure = figure_of(WIDTH, WIDTH * 0.92)
        grid = figure.subplots(count, count, squeeze=False, gridspec_kw={"wspace": 0.08, "hspace": 0.08})
        figure.subplots_adjust(left=0.04, right=0.995, top=0.995, bottom=0.04)
        for row in range(count):
            for col in range(count):
                axes = grid[row][col]
                axes.spines[:].set_visible(True)
                axes.set_xlim(low - margin, high + margin)
                if row == col:
                    _histogram(axes, table[:, col], labels[col], low, high)
                else:
                    axes.set_ylim(low - margin, high + 2.6 * margin)
                    _cloud(axes, table[:, col], table[:, row])
                ticks = _ticks(table)
                axes.set_xticks(ticks)
                axes.set_yticks([] if row == col else ticks)
                axes.tick_params(labelbottom=row == count - 1, labelleft=col == 0 and row > 0, length=2)
        return svg_of(figure, name, title)


def _ticks(table: NDArray[np.float64]) -> NDArray[np.float64]:
    """The points of a scale; of other scores about four round numbers."""
    from matplotlib.ticker import MaxNLocator

    low, high = float(np.nanmin(table)), float(np.nanmax(table))
    there = table[~np.isnan(table)]
    if high - low <= 10 and (there == np.rint(there)).all():
        return np.arange(low, high + 1)
    ticks = np.asarray(MaxNLocator(4).tick_values(low, high), dtype=np.float64)
    return ticks[(ticks >= low) & (ticks <= high)]


def _histogram(axes: Any, column: NDArray[np.float64], label: str, low: float, high: float) -> None:
    values = column[~np.isnan(column)]
    whole = bool((values == np.rint(values)).all())
    edges = np.arange(low - 0.5, high + 1.0) if whole else np.linspace(low, high, 9)
    axes.hist(values, bins=edges, color="#dfe6ee", edgecolor=BLUE, linewidth=0.6)
    axes.set_ylim(0, axes.get_ylim()[1] * 1.45)
    axes.text(
        0.5, 0.9, label, transform=axes.transAxes, ha="center", va="top", fontsize=8.5, fontweight="bold"
    )


def _cloud(axes: Any, x: NDArray[np.float64], y: NDArray[np.float64]) -> None:
    both = np.column_stack([x, y])[~np.isnan(x) & ~np.isnan(y)]
    points, counts = np.unique(both, axis=0, return_counts=True)
    size = 14.0 * counts * min(1.0, 60.0 / max(len(both), 1))
    axes.scatter(*points.T, s=np.maximum(size, 4.0), color=BLUE, alpha=0.75, linewidths=0)
    if len(points) > 1 and np.ptp(both[:, 0]) > 0:
        slope, level = np.polyfit(both[:, 0], both[:, 1], 1)
        ends = np.array([both[:, 0].min(), both[:, 0].max()])
        axes.plot(ends, level + slope * ends, color=RED, linewidth=0.9)
        r = np.atleast_2d(np.corrcoef(both, rowvar=False))[0, -1] if np.ptp(both[:, 1]) > 0 else np.nan
        axes.text(0.04, 0.95, f"r = {r:.3f}", transform=axes.transAxes, va="top", fontsize=7.5, color=RED)


def scree(
    values: NDArray[np.float64],
    chance: NDArray[np.float64] | None,
    interval: NDArray[np.float64] | None,
    say: Callable[[str], str],
    name: str,
    title: str,
) -> str:
    """Eigenvalues (p,) with their bootstrap interval (2, p), Kaiser's line and what chance reaches (p,)."""
    at = np.arange(1, len(values) + 1)
    with style():
        figure = figure_of(WIDTH, 3.3)
        axes = figure.add_axes((0.09, 0.16, 0.89, 0.8))
        axes.axhline(1.0, color=QUIET, linewidth=0.8, linestyle=(0, (4, 3)), label=say("kaiser_line"))
        if interval is not None:
            axes.fill_between(
                at, interval[0], interval[1], color=BLUE, alpha=0.13, linewidth=0, label=say("scree_interval")
            )
        if chance is not None:
            axes.plot(
                at, chance, color=RED, marker="s", markersize=3.2, linewidth=1.0, label=say("scree_chance")
            )
        axes.plot(
            at, values, color=BLUE, marker="o", markersize=4.5, linewidth=1.4, label=say("scree_values")
        )
        axes.set_xticks(at)
        axes.set_ylim(0, None)
        axes.set_xlabel(say("component"))
        axes.set_ylabel(say("eigenvalue"))
        axes.legend(frameon=False, loc="upper right")
        return svg_of(figure, name, title)


def loadings(
    values: NDArray[np.float64],
    interval: NDArray[np.float64] | None,
    labels: Sequence[str],
    columns: Sequence[str],
    name: str,
    title: str,
) -> str:
    """Loadings (p, k), one panel a component, with bootstrap intervals (2, p, k)."""
    p, k = values.shape
    height = 0.24 * p + 0.75
    home = np.abs(values).argmax(axis=1)
    with style():
        figure = figure_of(WIDTH, height)
        panels = figure.subplots(1, k, sharey=True, squeeze=False)[0]
        figure.subplots_adjust(
            left=0.235, right=0.985, top=1 - 0.35 / height, bottom=0.4 / height, wspace=0.12
        )
        rows = np.arange(p)
        for column, axes in enumerate(panels):
            axes.axvline(0, color=QUIET, linewidth=0.6)
            axes.hlines(rows, -1, 1, color=RULE, linewidth=0.4, zorder=0)
            for row in rows:
                colour = BLUE if home[row] == column else "#a9a39b"
                if interval is not None:
                    axes.plot(
                        interval[:, row, column],
                        [row, row],
                        color=colour,
                        linewidth=1.6,
                        solid_capstyle="butt",
                    )
                axes.plot(values[row, column], row, "o", color=colour, markersize=4.6)
            axes.set_xlim(-1.02, 1.02)
            if k <= MANY:
                axes.set_xticks([-1, -0.5, 0, 0.5, 1], ["−1", "−.5", "0", ".5", "1"])
            else:
                axes.set_xticks([-0.5, 0.5], ["−.5", ".5"])
            # The names of many components do not fit beside each other; the table above has them.
            axes.set_title(
                columns[column] if k <= MANY else str(column + 1), fontsize=8.5, fontweight="bold", pad=5
            )
            axes.spines["left"].set_visible(False)
            axes.tick_params(axis="y", length=0)
        panels[0].set_yticks(rows, labels)
        panels[0].set_ylim(p - 0.4, -0.6)
        return svg_of(figure, name, title)


def lines(
    mean: NDArray[np.float64],
    half: NDArray[np.float64],
    modules: Sequence[str],
    dimensions: Sequence[str],
    limits: tuple[float, float],
    name: str,
    title: str,
) -> str:
    """Fig. 8 and 9: mean ± half (m, d), modules from left to right, a line per dimension; limits of the scale."""
    m, d = mean.shape
    with style():
        figure = figure_of(WIDTH, 3.7)
        axes = figure.add_axes((0.075, 0.27, 0.905, 0.7))
        for side in range(d):
            x, colour = np.arange(m) + (side - (d - 1) / 2) * 0.085, SERIES[side % 6]
            axes.vlines(x, *(mean[:, side] + np.outer((-1, 1), np.nan_to_num(half[:, side]))), color=colour,
                        linewidth=2.6, alpha=0.28)  # fmt: skip
            axes.plot(x, mean[:, side], color=colour, marker=MARKERS[side % 6], markersize=4.8, linewidth=1.2,
                      label=dimensions[side])  # fmt: skip
        axes.set_xticks(range(m), modules)
        axes.set_xlim(-0.4, m - 0.6)
        axes.set_ylim(max(1.0, np.floor(2 * limits[0]) / 2 - 0.05), limits[1] + 0.05)
        axes.grid(axis="y", color=RULE, linewidth=0.5)
        axes.set_axisbelow(True)
        axes.legend(
            frameon=False, loc="upper center", bbox_to_anchor=(0.5, -0.12), ncols=min(d, 3), columnspacing=2.5
        )
        return svg_of(figure, name, title)
