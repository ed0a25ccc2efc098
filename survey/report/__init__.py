"""The report: one self-contained page in both languages, its tables as CSV, its figures as SVG."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

from survey.analysis import Analysis
from survey.analysis.summary import descriptives, summary
from survey.errors import SurveyError
from survey.reading import ScoreTable
from survey.report.page import Part, Report, build

__all__ = ["Part", "Report", "build", "write_report"]


def write_report(folder: Path, table: ScoreTable, analysis: Analysis, beside: Sequence[Part] = ()) -> Path:
    """Write report.html, tables/, figures/ and analysis.json into a folder; returns the page.

    Raises SurveyError where the folder cannot be written.
    """
    report = build(table, analysis, beside)
    told = summary(analysis) | {"descriptives": descriptives(analysis)}
    files = {
        "report.html": report.html,
        "analysis.json": json.dumps(told, ensure_ascii=False, allow_nan=False, indent=1) + "\n",
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
