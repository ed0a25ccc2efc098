"""Answers as CSV: opens in Excel with its characters intact and without running anything."""

from __future__ import annotations

import csv
import io
from typing import BinaryIO

from survey.export.cells import safe_cell
from survey.export.sheet import Sheet

__all__ = ["ANONYMITY", "BOM", "put_csv"]

BOM = "\ufeff"  # by which Excel knows UTF-8
ANONYMITY = "_anonymity"  # column that says in every row what was made coarse; no item can be called so


def put_csv(sheet: Sheet, out: BinaryIO) -> None:
    """Write the table, beginning with the byte order mark. "Not seen" is an empty cell, "not asked" a point."""
    text = io.TextIOWrapper(out, "utf-8", newline="")
    text.write(BOM)
    table = csv.writer(text)
    last = [] if sheet.anonymity is None else [sheet.anonymity.told()]
    table.writerow([*sheet.columns, *([ANONYMITY] if last else [])])
    for record in sheet.records:
        cells = [
            "" if cell is None else safe_cell(cell) if isinstance(cell, str) else cell for cell in record
        ]
        table.writerow(cells + last)
    text.flush()
    text.detach()
