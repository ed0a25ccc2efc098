"""The table as a file: CSV in UTF-8 with a mark in front, so that spreadsheets show Chinese; read in any usual form."""

from __future__ import annotations

import csv
import difflib
import io
import re
from collections.abc import Iterable
from dataclasses import dataclass

from hall_app.content.folder import Exhibit
from hall_app.web.collection.record import LANGUAGES
from hall_app.web.collection.table.cells import guarded, unguarded
from hall_app.web.collection.table.columns import ID, column_names, most_lines, pair, places

__all__ = ["Fault", "Row", "Sheet", "read_sheet", "table"]

MOST_BYTES = 50 << 20
MOST_LINES = 100  # further lines of one record
_DELIMITERS = ",;\t"
_LINE = re.compile(r"record\.line\[([1-9]\d{0,3})\]\.(?:label|value)\.(?:zh|en)")


@dataclass(frozen=True)
class Fault:
    """What is wrong in the table. row: as a spreadsheet counts them, the head is 1; column: its name."""

    row: int
    column: str
    what: str
    fix: str
    value: str | None = None

    def __str__(self) -> str:
        where = f"row {self.row}" + (f", column {self.column}" if self.column else "")
        shown = self.value if self.value is None or len(self.value) < 60 else self.value[:57] + "…"
        got = f" (got {shown!r})" if shown else ""
        return f"{where}: {self.what}{got} – {self.fix}"


@dataclass(frozen=True)
class Row:
    """An exhibit's row. number: as a spreadsheet counts them; cells: column -> text."""

    number: int
    id: str
    cells: dict[str, str]


@dataclass(frozen=True)
class Sheet:
    """A table that was read. lines: how many further lines of a record its columns speak of."""

    rows: tuple[Row, ...]
    lines: int
    faults: tuple[Fault, ...]


def table(exhibits: Iterable[Exhibit]) -> bytes:
    """The catalogue of these exhibits: a row each, every text in both languages."""
    exhibits = tuple(exhibits)
    lines = most_lines(exhibit.file for exhibit in exhibits)
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\r\n")
    writer.writerow(column_names(lines))
    for exhibit in exhibits:
        pairs = (pair(exhibit.file, place.path) for place in places(lines))
        texts = [getattr(found, language) if found else "" for found in pairs for language in LANGUAGES]
        writer.writerow([guarded(cell) for cell in (exhibit.id, *texts, exhibit.file.licence)])
    return text.getvalue().encode("utf-8-sig")


def read_sheet(data: bytes) -> Sheet:
    """The table in `data`, separated by commas, semicolons or tabs; columns may be left out, and in any order."""
    try:
        text = _text(data)
        rows = list(csv.reader(io.StringIO(text, newline=""), delimiter=_delimiter(text), strict=True))
    except UnicodeDecodeError as error:
        fault = Fault(1, "", f"the file is not UTF-8 at byte {error.start}", "save it as CSV UTF-8")
        return Sheet((), 0, (fault,))
    except (csv.Error, ValueError) as error:
        return Sheet((), 0, (Fault(1, "", f"the file is no CSV ({error})", "export it again as CSV"),))
    if not rows:
        return Sheet(
            (), 0, (Fault(1, "", "the file is empty", "begin with what hall collection export writes"),)
        )
    head = [name.strip() for name in rows[0]]
    lines, faults = _head(head)
    found: list[Row] = []
    if not faults:
        for number, cells in enumerate(rows[1:], 2):
            if any(cell.strip() for cell in cells):
                faults += _row(number, head, cells, found)
    return Sheet(tuple(found), lines, tuple(faults))


def _text(data: bytes) -> str:
    if len(data) > MOST_BYTES:
        raise ValueError(f"it has more than {MOST_BYTES >> 20} MB")
    return data.decode("utf-8-sig")


def _delimiter(text: str) -> str:
    """The sign that stands most often in the head: where a comma is the decimal sign, spreadsheets write semicolons."""
    head = text.splitlines()[0] if text else ""
    return max(_DELIMITERS, key=head.count)


def _head(head: list[str]) -> tuple[int, list[Fault]]:
    """How many further lines of a record there are columns of, and what is wrong with the names."""
    numbers = [int(match[1]) for name in head if (match := _LINE.fullmatch(name))]
    known = column_names(min(max(numbers, default=0), MOST_LINES))
    faults = []
    if ID not in head:
        faults.append(Fault(1, ID, "there is no such column", "add it: it says of which exhibit a row is"))
    for place, name in enumerate(head):
        if not name:
            faults.append(Fault(1, f"number {place + 1}", "the column has no name", "name it, or delete it"))
        elif name not in known:
            close = difflib.get_close_matches(name, known, n=1)
            fix = (
                f"did you mean {close[0]}?"
                if close
                else "delete it: hall collection export writes all there are"
            )
            faults.append(Fault(1, name, "there is no such key in exhibit.toml", fix))
        elif name in head[:place]:
            faults.append(Fault(1, name, "the column is there twice", "delete one of them"))
    return max(numbers, default=0), faults


def _row(number: int, head: list[str], cells: list[str], found: list[Row]) -> list[Fault]:
    """Add a row to `found`; or say what is wrong with it."""
    if len(cells) > len(head) and any(cells[len(head) :]):
        what = f"the row has {len(cells)} cells, the head {len(head)}"
        return [Fault(number, "", what, "put texts that hold the separator between quotation marks")]
    told = {name: unguarded(cell) for name, cell in zip(head, cells, strict=False)}
    identity = told.pop(ID, "").strip()
    if not identity:
        return [Fault(number, ID, "the cell is empty", "write the name of the exhibit's folder")]
    if earlier := next((row for row in found if row.id == identity), None):
        return [
            Fault(
                number, ID, f"row {earlier.number} is of this exhibit already", "delete one of them", identity
            )
        ]
    found.append(Row(number, identity, told))
    return []
