"""Tables of scores from outside: our own export, or any CSV with one column per item."""

from __future__ import annotations

import csv
import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from survey.answer import Answer
from survey.errors import SurveyError
from survey.questionnaire import META_COLUMNS, SUGGESTION

__all__ = ["read_scores", "scores_of"]


def read_scores(
    path: Path, items: Sequence[str] | None = None
) -> tuple[NDArray[np.float64], tuple[str, ...]]:
    """Scores (n, p) of a CSV file, NaN where a cell is empty, and the items' names.

    items: the columns to take; None takes every column that holds numbers only.
    Raises SurveyError naming file, line and column.
    """
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            table = csv.reader(file)
            lines = [(table.line_num, line) for line in table if any(cell.strip() for cell in line)]
    except OSError as error:
        raise SurveyError(f"{path}: cannot be read ({error.strerror}) – check the file") from None
    except (UnicodeDecodeError, csv.Error) as error:
        raise SurveyError(f"{path}: is no CSV in UTF-8 ({error}) – export it again") from None
    if len(lines) < 2:
        raise SurveyError(
            f"{path}: no rows – the first line names the columns, each further line is an answer"
        )
    header, body = [cell.strip() for cell in lines[0][1]], lines[1:]
    for number, line in body:
        if len(line) != len(header):
            raise SurveyError(
                f"{path}: line {number} has {len(line)} cells, the header {len(header)} – mend it"
            )
    columns = _columns(path, header, body, items)
    cells = [[_number(path, line[at], name, row) for name, at in columns] for row, line in body]
    return np.array(cells, dtype=np.float64), tuple(name for name, _ in columns)


def scores_of(answers: Sequence[Answer], items: Sequence[str]) -> NDArray[np.float64]:
    """Scores (n, p) of answers, NaN for "not seen"."""
    rows = [dict(answer.scores) for answer in answers]
    table = [
        [math.nan if (score := row.get(item)) is None else float(score) for item in items] for row in rows
    ]
    return np.array(table, dtype=np.float64).reshape(len(rows), len(items))


def _columns(
    path: Path, header: list[str], body: list[tuple[int, list[str]]], items: Sequence[str] | None
) -> list[tuple[str, int]]:
    twice = sorted({name for name in header if name and header.count(name) > 1})
    if twice:
        raise SurveyError(f"{path}: column {twice[0]!r} stands twice – rename one")
    if items is not None:
        missing = [item for item in items if item not in header]
        if missing:
            raise SurveyError(
                f"{path}: no column {missing[0]!r} – the questionnaire asks it; add it or name another"
            )
        return [(item, header.index(item)) for item in items]
    found = [
        (name, at)
        for at, name in enumerate(header)
        if name and name not in META_COLUMNS and not name.startswith(SUGGESTION) and _meant(body, at)
    ]
    if not found:
        raise SurveyError(f"{path}: no column of numbers – name the items in the first line")
    return found


def _meant(body: list[tuple[int, list[str]]], at: int) -> bool:
    """Whether a column is meant as numbers: most of what it holds are some. A slip among them is then named."""
    filled = [line[at] for _, line in body if line[at].strip()]
    return 2 * sum(map(_is_number, filled)) > len(filled)


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


def _number(path: Path, cell: str, name: str, line: int) -> float:
    try:
        return float(cell) if cell.strip() else math.nan
    except ValueError:
        raise SurveyError(f"{path}: line {line}, {name}: {cell[:30]!r} is no number – correct it") from None
