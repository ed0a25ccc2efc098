"""Answers for researchers: CSV, XLSX, SPSS, JSON, the codebook, and a script that repeats the analysis in R."""

from __future__ import annotations

from collections.abc import Sequence

from survey.export.cells import safe_cell
from survey.export.codebook import write_codebook
from survey.export.csv_file import columns as csv_columns
from survey.export.csv_file import write_csv
from survey.export.json_file import write_json
from survey.export.r_script import write_r
from survey.export.spss import write_sav
from survey.export.xlsx import write_xlsx
from survey.questionnaire import Questionnaire
from survey.store import Stored

__all__ = [
    "FORMATS",
    "csv_columns",
    "exported",
    "file_name",
    "safe_cell",
    "write_codebook",
    "write_csv",
    "write_json",
    "write_r",
    "write_sav",
    "write_xlsx",
]

FORMATS = ("csv", "xlsx", "sav", "json", "codebook", "r")


def exported(kind: str, questionnaire: Questionnaire, rows: Sequence[Stored]) -> bytes:
    """A file's bytes in one of FORMATS. Raises KeyError for another."""
    if kind in ("xlsx", "sav"):
        return (write_xlsx if kind == "xlsx" else write_sav)(questionnaire, rows)
    text = {
        "csv": lambda: write_csv(questionnaire, rows),
        "json": lambda: write_json(questionnaire, rows),
        "codebook": lambda: write_codebook(questionnaire),
        "r": lambda: write_r(
            questionnaire.item_ids,
            file=file_name("csv", questionnaire),
            name=file_name("r", questionnaire),
        ),
    }[kind]()
    return text.encode()


def file_name(kind: str, questionnaire: Questionnaire) -> str:
    """What a file in one of FORMATS is called, such as garment-v1.csv."""
    ending = {"codebook": "-codebook.csv", "r": ".R"}.get(kind, f".{kind}")
    return f"{questionnaire.id}-v{questionnaire.version}{ending}"
