"""The report's matrix of correlations (the paper's Fig. 6) as SVG."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from survey.analysis.correlation import stars
from survey.report.figures.svg import BLUE, INK, QUIET, RED, WIDTH, figure_of, style, svg_of

__all__ = ["correlations"]


def correlations(
    r: NDArray[np.float64], p: NDArray[np.float64], labels: Sequence[str], name: str, title: str
) -> str:
    """Fig. 6: the lower triangle with stars, coloured by r. r, p: (p, p), NaN where undefined."""
    count = len(labels)
    margin = min(2.6, 0.25 + 0.072 * max(map(_columns_wide, labels)))
    side = WIDTH - margin - 0.05
    # Of many items two decimals stay legible where three do not.
    digits, size = (3, min(9.0, 118.0 / max(count, 8))) if count <= 14 else (2, 150.0 / count)
    with style():
        figure = figure_of(WIDTH, side + 0.3)
        axes = figure.add_axes((margin / WIDTH, 0.28 / (side + 0.3), side / WIDTH, side / (side + 0.3)))
        shown = np.where(np.tri(count, k=-1, dtype=bool), r, np.nan)
        colours, scale = _diverging(), _within_one()
        axes.imshow(np.ma.masked_invalid(shown), cmap=colours, norm=scale, aspect="equal")
        for row in range(count):
            axes.text(row, row, "1", ha="center", va="center", fontsize=size, color=QUIET)
            for col in range(row):
                value = float(r[row, col])
                text = "–" if np.isnan(value) else _coefficient(value, digits)
                mark = "" if np.isnan(value) else stars(float(p[row, col]))
                ink = INK if np.isnan(value) or _bright(colours(scale(value))) else "white"
                axes.text(col, row, text + mark, ha="center", va="center", fontsize=size, color=ink)
        axes.set_xticks(range(count), [str(at + 1) for at in range(count)])
        axes.set_yticks(range(count), [f"{label}  {at + 1}" for at, label in enumerate(labels)])
        if count > 14:
            axes.tick_params(labelsize=6.8)
        axes.tick_params(length=0)
        axes.spines[:].set_visible(False)
        return svg_of(figure, name, title)


def _columns_wide(text: str) -> int:
    """Width of a text in Latin letters; a Chinese character takes two."""
    return sum(2 if ord(character) > 0x2E7F else 1 for character in text)


def _coefficient(value: float, digits: int) -> str:
    text = f"{value:.{digits}f}".replace("-", "−")
    return text if abs(value) >= 1.0 else text.replace("0.", ".", 1)


def _within_one() -> Any:
    from matplotlib.colors import Normalize

    return Normalize(-1.0, 1.0)


def _bright(colour: Sequence[float]) -> bool:
    """Whether dark ink reads better on a colour (r, g, b, …) than white does, by its luminance (WCAG 2)."""
    linear = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in colour[:3]]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2] > 0.22


def _diverging() -> Any:
    from matplotlib.colors import LinearSegmentedColormap

    return LinearSegmentedColormap.from_list("survey", [RED, "#d9a79f", "#faf8f5", "#a9bdd3", BLUE])
