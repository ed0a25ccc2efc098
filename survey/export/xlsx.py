"""Answers as an Excel workbook: the answers on one sheet, the codebook on another."""

from __future__ import annotations

import csv
import io
from pathlib import Path
from typing import Any, BinaryIO

from survey.export.cells import safe_cell
from survey.export.codebook import write_codebook
from survey.export.sheet import Sheet

__all__ = ["put_xlsx"]


def put_xlsx(sheet: Sheet, out: BinaryIO, folder: Path) -> None:
    """Write the workbook; out must be seekable. folder: where its parts wait on the disk, row after row.

    Texts are stored as texts, and guarded as in CSV, since a workbook is often saved as one.
    """
    import xlsxwriter
    from xlsxwriter.exceptions import FileCreateError

    options = {
        "constant_memory": True,
        "tmpdir": str(folder),
        "strings_to_formulas": False,
        "strings_to_urls": False,
        "strings_to_numbers": False,
    }
    book = xlsxwriter.Workbook(out, options)
    bold = book.add_format({"bold": True, "bottom": 1})
    answers = book.add_worksheet("answers")
    answers.freeze_panes(1, 1)
    answers.set_column(0, 0, 38)
    answers.set_column(1, len(sheet.columns) - 1, 14)
    for column, name in enumerate(sheet.columns):
        answers.write_string(0, column, name, bold)
    _fill(answers, sheet)
    codebook = book.add_worksheet("codebook")
    codebook.set_column(0, 9, 24)
    text = write_codebook(sheet.questionnaire, sheet.anonymity).removeprefix("\ufeff")
    for at, line in enumerate(csv.reader(io.StringIO(text, newline=""))):
        for column, cell in enumerate(line):
            codebook.write_string(at, column, cell, *([bold] if at == 0 else []))
    try:
        book.close()
    except FileCreateError as error:
        raise error.args[0] from None  # the OSError that it wraps


def _fill(answers: Any, sheet: Sheet) -> None:
    string, number = answers.write_string, answers.write_number
    for at, record in enumerate(sheet.records, 1):
        for column, cell in enumerate(record):
            if isinstance(cell, str):
                string(at, column, safe_cell(cell))
            elif cell is not None:
                number(at, column, cell)
