"""Answers as CSV: opens in Excel with its characters intact and without running anything."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable

from survey.questionnaire import META_COLUMNS, Questionnaire, suggestion_column
from survey.store import Stored

__all__ = ["csv_columns", "safe_cell", "write_csv"]

# What a spreadsheet takes for the beginning of a formula, the full-width forms of Chinese keyboards included.
_FORMULA = ("=", "+", "-", "@", "＝", "＋", "－", "＠", "\t", "\r", "\n")


def safe_cell(text: str) -> str:
    """The text, with an apostrophe in front where a spreadsheet would run it as a formula."""
    return "'" + text if text.startswith(_FORMULA) or text.lstrip().startswith(_FORMULA) else text


def csv_columns(questionnaire: Questionnaire) -> list[str]:
    """Columns in their order: what is known of the submission, the items, the suggestions."""
    modules = [module.id for module in questionnaire.modules if module.suggestion]
    return [*META_COLUMNS, *questionnaire.item_ids, *map(suggestion_column, modules)]


def write_csv(questionnaire: Questionnaire, rows: Iterable[Stored]) -> str:
    """The table as text, beginning with the byte order mark by which Excel knows UTF-8.

    "Not seen" is an empty cell. Times are UTC, ISO 8601.
    """
    out = io.StringIO(newline="")
    out.write("\ufeff")
    table = csv.writer(out)
    table.writerow(csv_columns(questionnaire))
    modules = [module.id for module in questionnaire.modules if module.suggestion]
    for row in rows:
        answer, texts, scores = row.answer, dict(row.answer.suggestions), dict(row.answer.scores)
        table.writerow(
            [
                answer.id,
                answer.version,
                answer.language,
                answer.exhibit or "",
                row.received.strftime("%Y-%m-%dT%H:%M:%SZ"),
                *("" if (score := scores.get(item)) is None else score for item in questionnaire.item_ids),
                *(safe_cell(texts.get(module, "")) for module in modules),
            ]
        )
    return out.getvalue()
