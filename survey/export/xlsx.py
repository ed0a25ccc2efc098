"""Answers as an Excel workbook: the answers on one sheet, the codebook on another."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable

from survey.export.cells import safe_cell
from survey.export.codebook import write_codebook
from survey.export.csv_file import columns, records
from survey.questionnaire import Questionnaire
from survey.store import Stored

__all__ = ["write_xlsx"]


def write_xlsx(questionnaire: Questionnaire, rows: Iterable[Stored]) -> bytes:
    """The file's bytes. Texts are stored as texts, and guarded as in CSV, since a workbook is often saved as one."""
    import xlsxwriter

    out = io.BytesIO()
    options = {
        "in_memory": True,
        "strings_to_formulas": False,
        "strings_to_urls": False,
        "strings_to_numbers": False,
    }
    book = xlsxwriter.Workbook(out, options)
    bold = book.add_format({"bold": True, "bottom": 1})
    answers = book.add_worksheet("answers")
    head = columns(questionnaire)
    answers.write_row(0, 0, head, bold)
    answers.freeze_panes(1, 1)
    answers.set_column(0, 0, 38)
    answers.set_column(1, len(head) - 1, 14)
    for at, record in enumerate(records(questionnaire, rows), 1):
        for column, cell in enumerate(record):
            if isinstance(cell, str):
                answers.write_string(at, column, safe_cell(cell))
            elif cell is not None:
                answers.write_number(at, column, cell)
    sheet = book.add_worksheet("codebook")
    sheet.set_column(0, 9, 24)
    for at, line in enumerate(
        csv.reader(io.StringIO(write_codebook(questionnaire).removeprefix("\ufeff"), newline=""))
    ):
        for column, cell in enumerate(line):
            sheet.write_string(at, column, cell, *([bold] if at == 0 else []))
    book.close()
    return out.getvalue()
