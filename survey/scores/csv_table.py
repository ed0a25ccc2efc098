"""Tables of scores from outside: our own export, or any CSV with one column per item."""

from __future__ import annotations

import csv
import io
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from survey.errors import SurveyError
from survey.questionnaire import META_COLUMNS, NOT_ASKED, SUGGESTION, Questionnaire, suggestion_column
from survey.scores.columns import Choice, no_items

__all__ = ["SECONDS", "ScoreTable", "read_column", "read_scores"]

SYNTHETIC = "synthetic-"  # how the ids begin in a sample that nobody answered
SECONDS = "seconds"  # column of the time an answer took
MISSING = {"", "NA", "."}  # how spreadsheets, R and SPSS write a missing score

SEPARATORS = ",;\t"  # also how Excel writes a CSV where the comma is the decimal point
DECIMAL_COMMA = re.compile(r"\s*[+-]?\d+,\d+\s*")

Lines = list[tuple[int, list[str]]]


@dataclass(frozen=True)
class ScoreTable:
    """scores: (n, p), NaN where missing. seconds: (n,) spent on each answer, or None.

    suggestions: (module, text) as they were written. source: where it all comes from, for a heading.
    synthetic: whether nobody gave these answers. beside: a sentence on answers to other versions, may be empty.
    unasked: in how many answers an item of the questionnaire was not asked; one that was asked in none is not in items.
    aside: column of a foreign table → why it was taken for no item ("name", "scale" or "text").
    labels: of stored answers, "language" and "exhibit" → (n,) of each, "" for none; empty where not asked for.
    """

    scores: NDArray[np.float64]
    items: tuple[str, ...]
    seconds: NDArray[np.float64] | None = None
    suggestions: tuple[tuple[str, str], ...] = ()
    questionnaire: Questionnaire | None = None
    source: str = ""
    synthetic: bool = False
    beside: str = ""
    unasked: Mapping[str, int] = field(default_factory=dict)
    aside: Mapping[str, str] = field(default_factory=dict)
    labels: Mapping[str, tuple[str, ...]] = field(default_factory=dict)


def read_scores(
    path: Path, questionnaire: Questionnaire | None = None, choice: Choice | None = None
) -> ScoreTable:
    """A CSV file's scores: the questionnaire's items, or without one every column of numbers that looks like an item.

    choice: which columns of a table without a questionnaire are items. Raises SurveyError naming file, line, column;
    of an infinite score NotFinite, which is one.
    """
    header, body = _lines(path)
    chosen = choice or Choice()
    chosen.check(header, path)
    unasked: dict[str, int] = {}
    if questionnaire is not None:
        unasked = _unasked(questionnaire, header, body)
        left = [item for item in questionnaire.item_ids if unasked.get(item, 0) < len(body)]
        questionnaire = questionnaire.asked(left) if left else questionnaire
    items = chosen.items or None if questionnaire is None else questionnaire.item_ids
    columns = _columns(path, header, body, items)
    scores = np.array([_numbers(path, line, columns, row) for row, line in body], dtype=np.float64)
    scores, aside = scores.reshape(len(body), len(columns)), {}
    if items is None:
        aside = no_items({name: scores[:, at] for at, (name, _) in enumerate(columns)}, chosen.keep)
        scores = scores[:, [name not in aside for name, _ in columns]]
        columns = [(name, at) for name, at in columns if name not in aside]
        items_here = {name for name, _ in columns}
        aside |= {name: "text" for name in header if _foreign(name) and name not in items_here | aside.keys()}
    _see_that_all_are_finite(path, body, columns, scores)
    seconds = None
    if SECONDS in header and SECONDS not in dict(columns):
        at = [(SECONDS, header.index(SECONDS))]
        seconds = np.array([_numbers(path, line, at, row)[0] for row, line in body], dtype=np.float64)
    table = ScoreTable(scores, tuple(name for name, _ in columns), seconds, source=path.name, aside=aside)
    return replace(
        table,
        questionnaire=questionnaire,
        suggestions=_written(header, body, questionnaire),
        synthetic=_synthetic(header, body),
        unasked=unasked,
    )


def read_column(path: Path, name: str) -> tuple[str, ...]:
    """What stands in a column of a CSV file, answer by answer, "" where nothing does.

    Raises SurveyError where there is no such column.
    """
    header, body = _lines(path)
    if name not in header:
        raise SurveyError(f"{path}: no column {name!r} – its columns are {', '.join(header)[:300]}")
    at = header.index(name)
    return tuple("" if (cell := line[at].strip()) in MISSING else cell for _, line in body)


def _lines(path: Path) -> tuple[list[str], Lines]:
    text = _text(path)
    try:
        head = [line for line in text if line.strip()]
        separator = max(SEPARATORS, key=lambda one: len(next(csv.reader(head, delimiter=one), [])))
        table = csv.reader(text, delimiter=separator)
        lines = [(table.line_num, line) for line in table if any(map(str.strip, line))]
    except csv.Error as error:
        raise SurveyError(f"{path}: is no CSV ({error}) – export it again") from None
    if separator != ",":
        lines = [(number, [_with_point(cell) for cell in line]) for number, line in lines]
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
    twice = sorted({name for name in header if name and header.count(name) > 1})
    if twice:
        raise SurveyError(f"{path}: column {twice[0]!r} stands twice – rename one")
    return header, body


def _text(path: Path) -> list[str]:
    """The file's lines, in UTF-8, or as Excel writes them in Chinese (GB 18030) or as Unicode text (UTF-16)."""
    try:
        data = path.read_bytes()
    except OSError as error:
        raise SurveyError(f"{path}: cannot be read ({error.strerror}) – check the file") from None
    wide = data[:2] in (b"\xff\xfe", b"\xfe\xff")
    reason = ""
    for encoding in ("utf-16",) if wide else ("utf-8-sig", "gb18030"):
        try:
            return [*io.StringIO(data.decode(encoding), newline="")]
        except UnicodeDecodeError as error:
            reason = reason or str(error)
    raise SurveyError(f"{path}: is no CSV in UTF-8, UTF-16 or GB 18030 ({reason}) – export it again")


def _with_point(cell: str) -> str:
    return cell.replace(",", ".") if DECIMAL_COMMA.fullmatch(cell) else cell


def _columns(
    path: Path, header: list[str], body: Lines, items: Sequence[str] | None
) -> list[tuple[str, int]]:
    if items is not None:
        missing = [item for item in items if item not in header]
        if missing:
            raise SurveyError(
                f"{path}: no column {missing[0]!r} – the questionnaire asks it; add it or name another"
            )
        return [(item, header.index(item)) for item in items]
    found = [(name, at) for at, name in enumerate(header) if _foreign(name) and _meant(body, at)]
    if not found:
        raise SurveyError(f"{path}: no column of numbers – name the items in the first line")
    return found


def _foreign(name: str) -> bool:
    """Whether a column has a name, and none that our own export gives to what is no item."""
    return bool(name) and name not in (*META_COLUMNS, SECONDS) and not name.startswith(SUGGESTION)


def _unasked(questionnaire: Questionnaire, header: list[str], body: Lines) -> dict[str, int]:
    """Item → answers in which it was not asked: its column is not there, or holds our mark for that.

    Only of items that a place may be without; the column of any other must be there.
    """
    counts = {}
    for module in questionnaire.modules:
        for item in questionnaire.items_of(module):
            if not (item.needs or module.needs):
                continue
            at = header.index(item.id) if item.id in header else None
            gone = len(body) if at is None else sum(line[at].strip() == NOT_ASKED for _, line in body)
            if gone:
                counts[item.id] = gone
    return counts


def _meant(body: Lines, at: int) -> bool:
    """Whether a column is meant as numbers: most of what it holds are some. A slip among them is then named.

    A column of nothing but gaps is meant so too: an item that nobody answered must be named, not overlooked.
    """
    written = [text for _, line in body if (text := line[at].strip()) not in MISSING]
    return 2 * sum(map(_is_number, written)) > len(written) or not written


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return "_" not in cell


def _numbers(path: Path, line: list[str], columns: list[tuple[str, int]], row: int) -> list[float]:
    try:
        if "_" not in "".join(line):  # Python reads 1_0 as 10
            return [float(line[at]) for _, at in columns]
    except ValueError:  # a gap, or a slip to name
        pass
    return [_number(path, line[at].strip(), name, row) for name, at in columns]


def _number(path: Path, cell: str, name: str, line: int) -> float:
    if cell in MISSING:
        return math.nan
    if not _is_number(cell):
        raise SurveyError(f"{path}: line {line}, {name}: {cell[:30]!r} is no number – correct it")
    return float(cell)


def _see_that_all_are_finite(
    path: Path, body: Lines, columns: list[tuple[str, int]], scores: NDArray[np.float64]
) -> None:
    """Raises NotFinite naming the first cell such as "inf" or 1e999 in a column that counts."""
    found = np.argwhere(np.isinf(scores))
    if len(found):
        from survey.analysis import NotFinite

        (line, cells), (name, at) = body[found[0, 0]], columns[found[0, 1]]
        where = f"{path}: line {line}, {name}"
        raise NotFinite(f"{where}: {cells[at].strip()[:30]!r} is infinite – correct it", (name,))


def _synthetic(header: list[str], body: Lines) -> bool:
    """Whether every row says of itself that nobody gave it."""
    if META_COLUMNS[0] not in header:
        return False
    at = header.index(META_COLUMNS[0])
    return all(line[at].startswith(SYNTHETIC) for _, line in body)


def _written(
    header: list[str], body: Lines, questionnaire: Questionnaire | None
) -> tuple[tuple[str, str], ...]:
    modules = [] if questionnaire is None else [module.id for module in questionnaire.modules]
    places = [
        (key, header.index(suggestion_column(key))) for key in modules if suggestion_column(key) in header
    ]
    # The apostrophe that the export puts before what a spreadsheet would run is no part of what was written.
    return tuple(
        (key, text.removeprefix("'")) for key, at in places for _, line in body if (text := line[at].strip())
    )
