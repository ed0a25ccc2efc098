"""How far frames are from their reference."""

from sim_core.learn.evaluation.errors import ErrorSummary, FrameErrors, frame_errors, summary, two_sided

__all__ = ["ErrorSummary", "FrameErrors", "frame_errors", "summary", "two_sided"]
