"""The way of the indicators as a figure: 25 on the left, twelve in the middle, those analysed on the right."""

from __future__ import annotations

from typing import Any

from survey.report.figures.svg import BLUE, INK, QUIET, RED, RULE, WIDTH, figure_of, style, svg_of
from survey.report.indicators import Way
from survey.report.words import Words, coefficient

__all__ = ["flow"]

ROW = 0.228  # [inch] from one indicator to the next
LEFT, MIDDLE, RIGHT = (
    (0.02, 2.2),
    (2.95, 4.75),
    (5.55, WIDTH - 0.02),
)  # [inch] from where to where a box reaches


def flow(way: Way, say: Words, name: str, title: str) -> str:
    """Curves join what was merged; what was deleted is struck; a pair of r ≥ .930 is bracketed."""
    order = [one for lane in way.lanes for one in way.primary if one.into == lane]
    order += [one for one in way.primary if one.into is None]
    row = {one.id: at for at, one in enumerate(order)}
    lane = {
        item: sum(at) / len(at)
        for item in way.lanes
        if (at := [row[one.id] for one in way.primary if one.into == item])
    }
    with style():
        height = ROW * len(order) + 0.34
        figure = figure_of(WIDTH, height)
        axes = figure.add_axes((0, 0, 1, 1))
        axes.set_xlim(0, WIDTH)
        axes.set_ylim(len(order) - 0.45, -1.05 - 0.34 / ROW + 1.0)
        axes.set_axis_off()
        _heads(axes, way, say)
        for number, one in enumerate(way.primary, 1):
            _box(axes, LEFT, row[one.id], f"{number}  {say.either(one.name)}", gone=one.into is None)
            if one.into is not None and one.into in lane:
                merges = sum(other.into == one.into for other in way.primary) > 1
                _curve(axes, LEFT[1], row[one.id], MIDDLE[0], lane[one.into], BLUE if merges else QUIET)
            elif one.why is not None:
                text = f"×  {say.either(one.why)}"
                axes.text(LEFT[1] + 0.1, row[one.id], text, fontsize=7.2, color=QUIET, va="center")
        for item, at in lane.items():
            _box(axes, MIDDLE, at, say.item(item), gone=item not in way.final)
            if item in way.final:
                _curve(axes, MIDDLE[1], at, RIGHT[0], at, QUIET)
                _box(axes, RIGHT, at, say.item(item), gone=False)
        for pair in way.pairs:
            if pair.items in way.close and pair.r is not None:
                _bracket(axes, lane[pair.items[0]], lane[pair.items[1]], pair.r)
        return svg_of(figure, name, title)


def _heads(axes: Any, way: Way, say: Words) -> None:
    counts = (len(way.primary), len(way.lanes), len(way.final))
    for (left, right), key, count in zip(
        (LEFT, MIDDLE, RIGHT), ("primary", "asked", "final"), counts, strict=True
    ):
        text = say(f"indicators_{key}", count=count)
        axes.text((left + right) / 2, -1.0, text, ha="center", va="center", fontsize=8.5, fontweight="bold")


def _box(axes: Any, across: tuple[float, float], at: float, text: str, *, gone: bool) -> None:
    from matplotlib.patches import Rectangle

    left, right = across
    box = Rectangle(
        (left, at - 0.39), right - left, 0.78, facecolor="#fdfcfa" if gone else "#eef2f7",
        edgecolor=RULE if gone else BLUE, linewidth=0.6, linestyle=(0, (3, 2)) if gone else "solid",
    )  # fmt: skip
    axes.add_patch(box)
    axes.text(left + 0.07, at, text, fontsize=7.8, color=QUIET if gone else INK, va="center")


def _curve(axes: Any, x0: float, y0: float, x1: float, y1: float, colour: str) -> None:
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path

    half = (x0 + x1) / 2
    path = Path([(x0, y0), (half, y0), (half, y1), (x1, y1)], [Path.MOVETO, *[Path.CURVE4] * 3])
    axes.add_patch(PathPatch(path, fill=False, edgecolor=colour, linewidth=1.0 if colour == BLUE else 0.7))


def _bracket(axes: Any, one: float, other: float, r: float) -> None:
    """Right of the middle: from the item that stays to the one beside it, r at the latter's height."""
    x = MIDDLE[1]
    axes.plot([x, x + 0.12, x + 0.12, x], [one, one, other, other], color=RED, linewidth=1.1)
    axes.text(x + 0.18, max(one, other), f"r = {coefficient(r)}", color=RED, fontsize=7.4, va="center")
