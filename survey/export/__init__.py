"""Answers for researchers: CSV, XLSX, SPSS, JSON, the codebook, and a script that repeats the analysis in R.

A `sheet` is what a file is made of, made coarse by `anonymity` where asked; `formats` says which files there are and
writes one. Making coarse needs numpy, so its names are handed out late (PEP 562).
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

from survey.export.cells import safe_cell
from survey.export.codebook import variables, write_codebook
from survey.export.formats import FORMATS, exported, file_name, put
from survey.export.json_file import put_rows, put_suggestions
from survey.export.r_script import Replication, write_r
from survey.export.sheet import Sheet, anonymous, of_columns, of_rows, pseudonym, stored_sheet
from survey.export.sheet import columns as csv_columns

if TYPE_CHECKING:
    from survey.export.anonymity import LEFT_OUT, LEVELS, TooFew, hide

__all__ = [
    "FORMATS",
    "LEFT_OUT",
    "LEVELS",
    "Replication",
    "Sheet",
    "TooFew",
    "anonymous",
    "csv_columns",
    "exported",
    "file_name",
    "hide",
    "of_columns",
    "of_rows",
    "pseudonym",
    "put",
    "put_rows",
    "put_suggestions",
    "safe_cell",
    "stored_sheet",
    "variables",
    "write_codebook",
    "write_r",
]

_LATE = {"LEFT_OUT": "anonymity", "LEVELS": "anonymity", "TooFew": "anonymity", "hide": "anonymity"}


def __getattr__(name: str) -> object:
    if name not in _LATE:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_LATE[name]}"), name)
