"""Answers as SPSS .sav, with labels in both languages and "not seen" and "not asked" as user-missing values."""

from __future__ import annotations

import errno
import os
import shutil
from functools import partial
from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING, Any, BinaryIO

from survey.export.codebook import variables
from survey.export.sheet import Sheet
from survey.questionnaire import NOT_ASKED, UNASKED, UNSEEN

if TYPE_CHECKING:
    import pandas

__all__ = ["put_sav"]

LABEL_BYTES, VALUE_BYTES = 250, 118  # SPSS cuts at 256 and 120
NOTE_BYTES = 80  # of one line of a file's note
_UNWRITTEN = "Unable to write data"  # how readstat tells a write that failed


def put_sav(sheet: Sheet, out: BinaryIO, folder: Path) -> None:
    """Write the file. Column names, labels and value labels are those of the codebook.

    folder: where the file is made, because pyreadstat writes to a path alone. It also takes the whole table at once:
    a float64 for every score, and an object for every text.
    """
    import pyreadstat

    known = {one.column: one for one in variables(sheet.questionnaire)}
    scores = set(sheet.questionnaire.item_ids)
    table = _frame(sheet, scores)
    values: dict[str, dict[int | float, str]] = {
        column: _values(known[column]) for column in table.columns if column in scores
    }
    path = folder / "answers.sav"
    write = partial(
        pyreadstat.write_sav,
        table,  # type: ignore[arg-type]  (its stubs name pandas' class by another path)
        str(path),
        file_label=_cut(sheet.questionnaire.title.en, 60),
        column_labels=[_cut(" / ".join(known[column].label), LABEL_BYTES) for column in table.columns],
        variable_value_labels=values,
        missing_ranges={column: [UNASKED, UNSEEN] if known[column].needs else [UNSEEN] for column in values},
        variable_measure={column: "ordinal" if column in scores else "nominal" for column in table.columns},
        note=None if sheet.anonymity is None else wrap(sheet.anonymity.told(), NOTE_BYTES),
    )
    try:
        write()
    except pyreadstat.ReadstatError as error:
        if _UNWRITTEN not in str(error):
            raise
        # It keeps the reason to itself; of a file of ours in a folder of ours there is only one.
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC)) from None
    with path.open("rb") as made:
        path.unlink()
        shutil.copyfileobj(made, out)


def _frame(sheet: Sheet, scores: set[str]) -> pandas.DataFrame:
    import pandas

    table = pandas.DataFrame(list(sheet.records), columns=sheet.columns)
    for column in table.columns:
        if column in scores:
            table[column] = table[column].replace(NOT_ASKED, UNASKED).fillna(UNSEEN).astype("float64")
        elif column == "version":
            table[column] = table[column].astype("float64")
        else:
            table[column] = table[column].fillna("").astype("str")
    return table


def _values(one: Any) -> dict[int | float, str]:
    labels = {point: _cut(" / ".join(texts), VALUE_BYTES) for point, texts in enumerate(one.points, 1)}
    unseen = one.unseen or ("未作答", "Not answered")
    unasked = {UNASKED: "未询问 / Not asked"} if one.needs else {}
    return {**labels, **unasked, UNSEEN: _cut(" / ".join(unseen), VALUE_BYTES)}


def _cut(text: str, most: int) -> str:
    """At most so many bytes of UTF-8, without half a character."""
    return text.encode()[:most].decode(errors="ignore")
