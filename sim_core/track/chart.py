"""How well a recording was followed, over time, as one picture."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from sim_core.track.tracker import Tracked
from sim_core.validation.files import written_whole

__all__ = ["save_chart"]

TORSO, LIMBS, GREY = "#b5382d", "#3a7d44", "#6b6b6b"  # the paper's red and green


def save_chart(path: Path, tracked: Tracked) -> None:
    """Draws a PNG: errors of torso and limbs against the truth, where it is known, delta and M, and points lost.

    Raises FileProblem where it cannot be written.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.0, 7.0), dpi=100, layout="constrained")
    FigureCanvasAgg(figure)
    error, delta, ratio, lost = figure.subplots(4, 1, sharex=True)
    time = tracked.time
    _errors(error, tracked)
    delta.plot(time, tracked.delta.mean(1) * 1e3, color=GREY, label="mean")
    delta.plot(time, tracked.delta.max(1) * 1e3, color=GREY, alpha=0.5, linewidth=0.8, label="greatest")
    delta.set_ylabel("Δ [mm]")
    ratio.plot(time, tracked.m.mean(1), color=GREY, label="mean")
    ratio.plot(time, tracked.m.max(1), color=GREY, alpha=0.5, linewidth=0.8, label="greatest")
    ratio.set_ylabel("M")
    lost.step(time, tracked.lost.sum(1), color=GREY, where="mid")
    lost.set_ylim(bottom=0.0)
    lost.set_ylabel("points lost")
    lost.set_xlabel("time [s]")
    for axes in (delta, ratio):
        axes.legend(loc="upper right", frameon=False, fontsize="small")
    with written_whole(path) as stream:
        figure.savefig(stream, format="png")


def _errors(axes: Any, tracked: Tracked) -> None:
    found = tracked.errors() * 1e3
    torso = tracked.feature_points.torso
    for name, chosen, colour in (("torso", torso, TORSO), ("limbs", ~torso, LIMBS)):
        squares = np.where(np.isfinite(found[:, chosen]), found[:, chosen], 0.0) ** 2
        count = np.isfinite(found[:, chosen]).sum(1)
        mean = np.sqrt(squares.sum(1) / np.maximum(count, 1))
        axes.plot(tracked.time, np.where(count > 0, mean, np.nan), color=colour, label=name)
    axes.set_ylabel("error, RMS [mm]")
    axes.legend(loc="upper right", frameon=False, fontsize="small")
    if tracked.truth is None:
        axes.set_title("the truth is not known", fontsize="small")
