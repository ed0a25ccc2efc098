"""The formats of an export: which there are, what a file is called, and writing one."""

from __future__ import annotations

import io
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import BinaryIO

from survey.export.codebook import write_codebook
from survey.export.csv_file import put_csv
from survey.export.json_file import put_json
from survey.export.r_script import Replication, write_r
from survey.export.sheet import Sheet, of_rows
from survey.export.spss import put_sav
from survey.export.xlsx import put_xlsx
from survey.questionnaire import Questionnaire, ever_asked
from survey.store import Stored

__all__ = ["FORMATS", "exported", "file_name", "put"]

FORMATS = ("csv", "xlsx", "sav", "json", "codebook", "r")


def put(kind: str, sheet: Sheet, out: BinaryIO, folder: Path) -> None:
    """Write a file in one of FORMATS, row after row. Raises KeyError for another.

    out: seekable. folder: an empty one for what has to wait on the disk meanwhile. The R script is one for the items
    of the sheet's questionnaire.
    """
    asked, k = sheet.questionnaire, None if sheet.anonymity is None else sheet.anonymity.k
    if kind == "csv":
        put_csv(sheet, out)
    elif kind == "json":
        put_json(sheet, out)
    elif kind == "r":
        out.write(_script(asked, k).encode())
    elif kind == "codebook":
        out.write(write_codebook(asked, sheet.anonymity).encode())
    else:
        {"xlsx": put_xlsx, "sav": put_sav}[kind](sheet, out, folder)


def _script(asked: Questionnaire, k: int | None) -> str:
    modules = {
        f"module_{module.id}": [item.id for item in asked.items_of(module)] for module in asked.modules
    }
    return write_r(
        Replication(
            asked.item_ids,
            file=file_name("csv", asked, k),
            name=file_name("r", asked, k),
            reverse=asked.reverse_keyed,
            turn=asked.points + 1,
            scales=modules,
        )
    )


def exported(kind: str, questionnaire: Questionnaire, rows: Sequence[Stored]) -> bytes:
    """A file's bytes in one of FORMATS, of answers that are there as values. Raises KeyError for another."""
    asked = ever_asked(questionnaire, [row.answer for row in rows]) if kind == "r" else questionnaire
    out = io.BytesIO()
    with tempfile.TemporaryDirectory() as folder:
        put(kind, of_rows(asked, rows), out, Path(folder))
    return out.getvalue()


def file_name(kind: str, questionnaire: Questionnaire, k: int | None = None) -> str:
    """What a file in one of FORMATS is called, such as garment-v1.csv or garment-v1-k5.csv."""
    ending = {"codebook": "-codebook.csv", "r": ".R"}.get(kind, f".{kind}")
    hidden = "" if k is None else f"-k{k}"
    return f"{questionnaire.id}-v{questionnaire.version}{hidden}{ending}"
