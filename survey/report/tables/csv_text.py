"""The report's tables as CSV: one figure a cell, so that a spreadsheet or R reads them back as numbers."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from survey.export import safe_cell
from survey.report.tables.table import Table

__all__ = ["as_csv", "matrix_csv"]

_FIGURE = r"(−?\d*\.\d+|–)"
# How the page writes a figure with its interval, and what the parts are.
_JOINED = (
    (re.compile(rf"{_FIGURE} \[{_FIGURE}, {_FIGURE}\]"), ("{name}", "{name}: {low}", "{name}: {high}")),
    (re.compile(rf"{_FIGURE} – {_FIGURE}"), ("{name}: {low}", "{name}: {high}")),
    (re.compile(rf"{_FIGURE} ± {_FIGURE}"), ("{name}", "{name}: ±")),
)


def as_csv(table: Table, bounds: tuple[str, str] = ("low", "high")) -> str:
    """UTF-8 with a byte order mark, cells safe against formulas. bounds: what an interval's ends are called."""
    titles = [title for title, span in table.groups for _ in range(span)] or [""] * len(table.head)
    head: list[str] = []
    columns: list[Sequence[str]] = []
    for at, (group, title) in enumerate(zip(titles, table.head, strict=True)):
        name = f"{group}: {title}" if group else title
        names, parts = _parted(name, [row[at] for row in table.body], bounds)
        head += names
        columns += parts
    return _written(head, zip(*columns, strict=True))


def matrix_csv(values: NDArray[np.float64], names: Sequence[str]) -> str:
    """A square matrix with its names, every digit of it. values: (p, p), NaN where undefined."""
    cells = [["" if np.isnan(value) else repr(value) for value in row] for row in values.tolist()]
    return _written(["", *names], ([name, *row] for name, row in zip(names, cells, strict=True)))


def _parted(
    name: str, cells: Sequence[str], bounds: tuple[str, str]
) -> tuple[list[str], list[Sequence[str]]]:
    """A column's names and cells, figure and interval apart where all its cells have both."""
    for pattern, names in _JOINED:
        found = [pattern.fullmatch(cell) for cell in cells]
        if found and all(found):
            parts = [match.groups() for match in found if match is not None]
            made = [part.format(name=name, low=bounds[0], high=bounds[1]) for part in names]
            return made, [*zip(*parts, strict=True)]
    return [name], [cells]


def _written(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    out = io.StringIO(newline="")
    out.write("\ufeff")
    writer = csv.writer(out)
    writer.writerow([safe_cell(cell) for cell in head])
    writer.writerows([[_cell(cell) for cell in row] for row in rows])
    return out.getvalue()


def _cell(cell: str) -> str:
    # A figure's minus is no formula: it goes back to the hyphen that a spreadsheet reads as a number.
    plain = cell.replace("−", "-")
    try:
        float(plain)
    except ValueError:
        return "" if cell == "–" else safe_cell(cell)
    return plain
