"""The report's figures as SVG, drawn by matplotlib with the browser's fonts.

Text stays text (svg.fonttype none), so Chinese needs no font on the server; matplotlib then measures it with a font
that lacks the characters and says so for every glyph, which is silenced here and nowhere else.
"""

from __future__ import annotations

import io
import re
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np
from numpy.typing import NDArray

from survey.analysis.correlation import stars

__all__ = ["correlations", "lines", "loadings", "scatter_matrix", "scree"]

INK, QUIET, RULE = "#1c1a18", "#6f6a64", "#d8d2ca"
RED, BLUE = "#9d2f2a", "#2b5077"
SERIES = ("#2b5077", "#9d2f2a", "#4c7a51", "#b5812f", "#6b4c86", "#3f8a92")
MARKERS = "osD^vP"
FONT = "'Source Sans 3', 'Helvetica Neue', Arial, 'Noto Sans CJK SC', 'Source Han Sans SC', sans-serif"
WIDTH = 7.2  # [inch] of the text column


@contextmanager
def _style() -> Iterator[None]:
    import matplotlib

    settings: dict[Any, Any] = {
        "svg.fonttype": "none", "svg.hashsalt": "survey", "font.family": "sans-serif", "font.size": 8.5,
        "font.sans-serif": ["DejaVu Sans"], "axes.edgecolor": QUIET, "axes.labelcolor": INK, "text.color": INK,
        "xtick.color": QUIET, "ytick.color": QUIET, "xtick.labelcolor": INK, "ytick.labelcolor": INK,
        "axes.linewidth": 0.6, "xtick.major.width": 0.6, "ytick.major.width": 0.6, "axes.spines.top": False,
        "axes.spines.right": False, "axes.unicode_minus": True, "path.simplify": False,
    }  # fmt: skip
    with matplotlib.rc_context(settings), warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Glyph .* missing", category=UserWarning)
        yield


def _figure(width: float, height: float) -> Any:
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height))
    FigureCanvasSVG(figure)
    return figure


def _svg(figure: Any, name: str, title: str) -> str:
    """The <svg> element alone, ids made unique to `name`, scaled by the page."""
    file = io.StringIO()
    figure.savefig(file, format="svg", transparent=True, metadata={"Date": None, "Creator": None})
    text = file.getvalue()
    text = text[text.index("<svg") :]
    text = re.sub(r"<metadata>.*?</metadata>", "", text, flags=re.DOTALL)
    text = re.sub(r'(\bid="|url\(#|href="#)', rf"\g<1>{name}-", text)
    text = re.sub(r"'DejaVu Sans'(, sans-serif)?", FONT, text)
    text = re.sub(
        r'<svg [^>]*?viewBox="([^"]*)"[^>]*>',
        r'<svg viewBox="\1" role="img" xmlns="http://www.w3.org/2000/svg"'
        r' xmlns:xlink="http://www.w3.org/1999/xlink">',
        text,
        count=1,
    )
    label = title.replace("&", "&amp;").replace("<", "&lt;")
    return text.replace(">", f"><title>{label}</title>", 1)


def correlations(
    r: NDArray[np.float64], p: NDArray[np.float64], labels: Sequence[str], name: str, title: str
) -> str:
    """Fig. 6: the lower triangle with stars, coloured by r. r, p: (p, p), NaN where undefined."""
    count = len(labels)
    with _style():
        side = WIDTH - 1.75
        size = min(9.0, 118.0 / max(count, 8))
        figure = _figure(WIDTH, side + 0.3)
        axes = figure.add_axes((1.7 / WIDTH, 0.28 / (side + 0.3), side / WIDTH, side / (side + 0.3)))
        shown = np.where(np.tri(count, k=-1, dtype=bool), r, np.nan)
        axes.imshow(np.ma.masked_invalid(shown), cmap=_diverging(), vmin=-1, vmax=1, aspect="equal")
        for row in range(count):
            for col in range(row):
                value = r[row, col]
                text = "–" if np.isnan(value) else f"{value:.3f}".replace("0.", ".").replace("-", "−")
                mark = "" if np.isnan(value) else stars(float(p[row, col]))
                light = abs(value) > 0.6
                axes.text(col, row, text + mark, ha="center", va="center", fontsize=size,
                          color="white" if light else INK)  # fmt: skip
        axes.set_xticks(range(count), [str(at + 1) for at in range(count)])
        axes.set_yticks(range(count), [f"{label}  {at + 1}" for at, label in enumerate(labels)])
        axes.tick_params(length=0)
        axes.spines[:].set_visible(False)
        return _svg(figure, name, title)


def _diverging() -> Any:
    from matplotlib.colors import LinearSegmentedColormap

    return LinearSegmentedColormap.from_list("survey", [RED, "#d9a79f", "#faf8f5", "#a9bdd3", BLUE])


def scatter_matrix(table: NDArray[np.float64], labels: Sequence[str], name: str, title: str) -> str:
    """Fig. 7: every pair of k items; whole scores lie on each other, so the area of a point counts them."""
    count = len(labels)
    low, high = np.nanmin(table), np.nanmax(table)
    margin = 0.12 * max(high - low, 1.0)
    with _style():
        figure = _figure(WIDTH, WIDTH * 0.92)
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
                axes.tick_params(labelbottom=row == count - 1, labelleft=col == 0 and row > 0, length=2)
        return _svg(figure, name, title)


def _histogram(axes: Any, column: NDArray[np.float64], label: str, low: float, high: float) -> None:
    values = column[~np.isnan(column)]
    whole = bool((values == np.rint(values)).all())
    edges = np.arange(low - 0.5, high + 1.0) if whole else np.linspace(low, high, 9)
    axes.hist(values, bins=edges, color="#dfe6ee", edgecolor=BLUE, linewidth=0.6)
    axes.set_ylim(0, axes.get_ylim()[1] * 1.45)
    axes.set_yticks([])
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
    with _style():
        figure = _figure(WIDTH, 3.3)
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
        return _svg(figure, name, title)


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
    with _style():
        figure = _figure(WIDTH, height)
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
            axes.set_xticks([-1, -0.5, 0, 0.5, 1], ["−1", "−.5", "0", ".5", "1"])
            axes.set_title(columns[column], fontsize=8.5, fontweight="bold", pad=5)
            axes.spines["left"].set_visible(False)
            axes.tick_params(axis="y", length=0)
        panels[0].set_yticks(rows, labels)
        panels[0].set_ylim(p - 0.4, -0.6)
        return _svg(figure, name, title)


def lines(
    mean: NDArray[np.float64],
    half: NDArray[np.float64],
    modules: Sequence[str],
    dimensions: Sequence[str],
    points: int,
    name: str,
    title: str,
) -> str:
    """Fig. 8 and 9: mean ± half (m, d), modules from left to right, a line per dimension."""
    m, d = mean.shape
    with _style():
        figure = _figure(WIDTH, 3.7)
        axes = figure.add_axes((0.075, 0.27, 0.905, 0.7))
        lowest = np.nanmin(mean - np.nan_to_num(half)) if np.isfinite(mean).any() else 1.0
        for side in range(d):
            x = np.arange(m) + (side - (d - 1) / 2) * 0.07
            axes.errorbar(
                x, mean[:, side], yerr=np.nan_to_num(half[:, side]), color=SERIES[side % 6], marker=MARKERS[side % 6],
                markersize=4.5, linewidth=1.3, elinewidth=0.8, capsize=2, label=dimensions[side],
            )  # fmt: skip
        axes.set_xticks(range(m), modules)
        axes.set_xlim(-0.4, m - 0.6)
        axes.set_ylim(max(1.0, np.floor(2 * lowest) / 2 - 0.05), points + 0.05)
        axes.grid(axis="y", color=RULE, linewidth=0.5)
        axes.set_axisbelow(True)
        axes.legend(
            frameon=False, loc="upper center", bbox_to_anchor=(0.5, -0.12), ncols=min(d, 3), columnspacing=2.5
        )
        return _svg(figure, name, title)
