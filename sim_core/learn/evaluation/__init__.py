"""How far frames are from their reference, in numbers and side by side: as a picture, and as a clip."""

from sim_core.learn.evaluation.errors import ErrorSummary, FrameErrors, frame_errors, summary, two_sided
from sim_core.learn.evaluation.side_by_side import Shown, draw_side_by_side
from sim_core.learn.evaluation.side_by_side_clip import Side, side_by_side_clip

__all__ = [
    "ErrorSummary",
    "FrameErrors",
    "Shown",
    "Side",
    "draw_side_by_side",
    "frame_errors",
    "side_by_side_clip",
    "summary",
    "two_sided",
]
