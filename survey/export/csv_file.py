"""Answers as CSV: opens in Excel with its characters intact and without running anything."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Iterator

from survey.export.cells import safe_cell
from survey.questionnaire import META_COLUMNS, Questionnaire, suggestion_column
from survey.store import Stored

__all__ = ["columns", "records", "write_csv"]

BOM = "\ufeff"  # by which Excel knows UTF-8


def columns(questionnaire: Questionnaire) -> list[str]:
    """Columns in their order: what is known of the submission, the items, the suggestions."""
    return [*META_COLUMNS, *questionnaire.item_ids, *map(suggestion_column, _modules(questionnaire))]


def records(questionnaire: Questionnaire, rows: Iterable[Stored]) -> Iterator[list[str | int | None]]:
    """A list per answer in the order of `columns`; None: not seen. Times are UTC, ISO 8601. Texts as written."""
    modules = _modules(questionnaire)
    for row in rows:
        answer, texts, scores = row.answer, dict(row.answer.suggestions), dict(row.answer.scores)
        yield [
            answer.id,
            answer.version,
            answer.language,
            answer.exhibit or "",
            row.received.strftime("%Y-%m-%dT%H:%M:%SZ"),
            *(scores.get(item) for item in questionnaire.item_ids),
            *(texts.get(module, "") for module in modules),
        ]


def write_csv(questionnaire: Questionnaire, rows: Iterable[Stored]) -> str:
    """The table as text, beginning with the byte order mark. "Not seen" is an empty cell."""
    out = io.StringIO(newline="")
    out.write(BOM)
    table = csv.writer(out)
    table.writerow(columns(questionnaire))
    for record in records(questionnaire, rows):
        table.writerow(
            ["" if cell is None else safe_cell(cell) if isinstance(cell, str) else cell for cell in record]
        )
    return out.getvalue()


def _modules(questionnaire: Questionnaire) -> list[str]:
    return [module.id for module in questionnaire.modules if module.suggestion]
