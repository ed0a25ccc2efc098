"""What was tracked, in figures: the keys that `simcore track --json` prints."""

from __future__ import annotations

from typing import Any

import numpy as np

from sim_core.track.tracker import Tracked

__all__ = ["summary"]


def summary(tracked: Tracked, seconds: float) -> dict[str, Any]:
    """frames, points; seconds_per_frame; rmse_mm, max_mm over all points of all frames whose truth is known (None
    without any); delta_mm, m: means of Eq. 16 and 17 over bones and frames; iterations: mean of a frame; flips:
    rotations by more than 90 degrees in a frame; lost: points of frames that were not seen; bone_error_m: the greatest.

    seconds: of the whole run, without what is done once.
    """
    errors = tracked.errors()
    known = np.isfinite(errors)
    return {
        "frames": len(tracked.time),
        "points": tracked.points.shape[1],
        "seconds_per_frame": seconds / len(tracked.time),
        "rmse_mm": float(np.sqrt(np.mean(errors[known] ** 2)) * 1e3) if known.any() else None,
        "max_mm": float(errors[known].max() * 1e3) if known.any() else None,
        "delta_mm": float(tracked.delta.mean() * 1e3),
        "m": float(tracked.m.mean()),
        "iterations": float(tracked.iterations.mean()),
        "flips": int(tracked.flips.sum()),
        "lost": int(tracked.lost.sum()),
        "bone_error_m": tracked.bone_error(),
    }
