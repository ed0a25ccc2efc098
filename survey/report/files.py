"""The report as files in a folder: the page, tables, figures, and what repeats them in R."""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Sequence
from pathlib import Path

from survey.analysis import Analysis
from survey.analysis.procedure import descriptives, summary
from survey.errors import SurveyError
from survey.export import Replication, safe_cell, write_r
from survey.report.chapters import Further
from survey.report.page import Part, build
from survey.scores import ScoreTable

__all__ = ["write_report"]


def write_report(
    folder: Path,
    table: ScoreTable,
    analysis: Analysis,
    beside: Sequence[Part] = (),
    further: Sequence[Further] = (),
) -> Path:
    """Write report.html, tables/, figures/ and analysis.json into a folder; returns the page.

    further: chapters of other analyses, such as `confirmation_chapter` of one.

    Raises SurveyError where the folder cannot be written.
    """
    report = build(table, analysis, beside, further)
    told = summary(analysis) | {"descriptives": descriptives(analysis)}
    files = {
        "report.html": report.html,
        "analysis.json": json.dumps(told, ensure_ascii=False, allow_nan=False, indent=1) + "\n",
        "scores.csv": _scores(table),
        "analysis.R": _repeated(analysis),
        **{f"tables/{name}": text for name, text in report.tables.items()},
        **{f"figures/{name}": text for name, text in report.drawings.items()},
    }
    try:
        for name, text in files.items():
            path = folder / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, "utf-8", newline="")
    except OSError as error:
        raise SurveyError(f"{folder}: cannot be written ({error.strerror}) – give another --report") from None
    return folder / "report.html"


def _scores(table: ScoreTable) -> str:
    """What was analysed, for the R script beside it, which knows the guarded names; scores are bare figures."""
    out = io.StringIO(newline="")
    out.write("\ufeff")
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow([safe_cell(item) for item in table.items])
    for row in table.scores.tolist():
        writer.writerow(["" if math.isnan(score) else f"{score:.17g}" for score in row])
    return out.getvalue()


def _repeated(analysis: Analysis) -> str:
    chosen = analysis.settings
    return write_r(
        Replication(
            analysis.items,
            file="scores.csv",
            dropped=analysis.dropped,
            rotation=chosen.rotation,
            factors=chosen.factors,
            missing=chosen.missing,
            method=chosen.method,
            reverse=analysis.turned.items,
            turn=analysis.turned.total,
            scales={
                f"{scale.kind}_{scale.key}": scale.items
                for scale in analysis.scales
                if scale.kind != "component"
            },
        )
    )
