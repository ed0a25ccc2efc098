"""How far frames are from their reference, in numbers and as a picture."""

from sim_core.learn.evaluation.errors import ErrorSummary, FrameErrors, frame_errors, summary, two_sided
from sim_core.learn.evaluation.side_by_side import Shown, draw_side_by_side

__all__ = [
    "ErrorSummary",
    "FrameErrors",
    "Shown",
    "draw_side_by_side",
    "frame_errors",
    "summary",
    "two_sided",
]
