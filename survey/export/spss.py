"""Answers as SPSS .sav, with labels in both languages and "not seen" as a user-missing value."""

from __future__ import annotations

import tempfile
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from survey.export.codebook import variables
from survey.export.csv_file import columns, records
from survey.questionnaire import UNSEEN, Questionnaire
from survey.store import Stored

__all__ = ["write_sav"]

LABEL_BYTES, VALUE_BYTES = 250, 118  # SPSS cuts at 256 and 120


def write_sav(questionnaire: Questionnaire, rows: Iterable[Stored]) -> bytes:
    """The file's bytes. Column names, labels and value labels are those of the codebook."""
    import pandas
    import pyreadstat

    known = {one.column: one for one in variables(questionnaire)}
    scores = [column for column in columns(questionnaire) if known[column].kind == "score"]
    table = pandas.DataFrame(list(records(questionnaire, rows)), columns=columns(questionnaire))
    for column in table.columns:
        if column in scores:
            table[column] = table[column].fillna(UNSEEN).astype("float64")
        elif column == "version":
            table[column] = table[column].astype("float64")
        else:
            table[column] = table[column].fillna("").astype("str")
    values: dict[str, dict[int | float, str]] = {column: _values(known[column]) for column in scores}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "answers.sav"
        pyreadstat.write_sav(
            table,  # type: ignore[arg-type]  (its stubs name pandas' class by another path)
            str(path),
            file_label=_cut(questionnaire.title.en, 60),
            column_labels=[_cut(" / ".join(known[column].label), LABEL_BYTES) for column in table.columns],
            variable_value_labels=values,
            missing_ranges={column: [UNSEEN] for column in scores},
            variable_measure={
                column: "ordinal" if column in scores else "nominal" for column in table.columns
            },
        )
        return path.read_bytes()


def _values(one: Any) -> dict[int | float, str]:
    labels = {point: _cut(" / ".join(texts), VALUE_BYTES) for point, texts in enumerate(one.points, 1)}
    unseen = one.unseen or ("未作答", "Not answered")
    return {**labels, UNSEEN: _cut(" / ".join(unseen), VALUE_BYTES)}


def _cut(text: str, most: int) -> str:
    """At most so many bytes of UTF-8, without half a character."""
    return text.encode()[:most].decode(errors="ignore")
