"""What `survey analyse` is asked for beyond the paper's procedure: --confirm and --compare."""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from survey.report.chapters.chapter import Further
    from survey.scores.csv_table import ScoreTable

__all__ = ["Beyond", "beyond_asked"]


@dataclass(frozen=True)
class Beyond:
    """summary: keys for --json. printed: texts for the terminal. chapters: of the report."""

    summary: dict[str, Any]
    printed: tuple[str, ...]
    chapters: tuple[Further, ...]


def beyond_asked(args: argparse.Namespace, table: ScoreTable) -> Beyond:
    """Both, where they are asked for. Raises what `confirm` and `compare` raise."""
    from survey.analysis.comparison.summary import comparison_printed, comparison_summary
    from survey.analysis.confirmatory import confirmation_summary
    from survey.analysis.confirmatory.summary import confirmation_printed
    from survey.commands.research.compare import compared
    from survey.commands.research.confirm import confirmed
    from survey.commands.research.sources import turned_source
    from survey.report.chapters.comparison import comparison_chapter
    from survey.report.chapters.confirmation import confirmation_chapter

    summary: dict[str, Any] = {}
    printed, chapters = [], []
    if args.confirm is not None:
        found = confirmed(turned_source(table, args), args, args.confirm)
        summary["confirmation"] = confirmation_summary(found)
        printed.append(confirmation_printed(found))
        chapters.append(partial(confirmation_chapter, found))
    if args.compare is not None:
        made = compared(table, args, args.compare)
        both = made.found  # the analysis tells of the table itself
        summary["comparison"] = comparison_summary(both)
        printed.append(comparison_printed(both))
        chapters.append(partial(comparison_chapter, both, made.names))
    return Beyond(summary, tuple(printed), tuple(chapters))
