"""What a table would change in the exhibits' files: texts that differ, and nothing else."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from hall_app.content.folder import Exhibit
from hall_app.content.schema.values import Bilingual
from hall_app.web.collection.record import LANGUAGES
from hall_app.web.collection.table.columns import LICENCE, Path, Place, key, pair, places
from hall_app.web.collection.table.sheet import Fault, Row, Sheet

__all__ = ["Change", "changes"]

Changes = dict[str, tuple["Change", ...]]


@dataclass(frozen=True)
class Change:
    """A value that becomes another one: both languages, a plain value or list, or None where there is none."""

    path: Path
    before: Any
    value: Any

    def __str__(self) -> str:
        told = [
            f"{language} {_shown(self.before, language)} → {_shown(self.value, language)}"
            for language in self._of
        ]
        return f"{key(self.path)}: {'; '.join(told)}"

    @property
    def _of(self) -> tuple[str, ...]:
        """The languages that change."""
        return tuple(x for x in LANGUAGES if _part(self.before, x) != _part(self.value, x))


def _part(text: Bilingual | str | None, language: str) -> str | None:
    return getattr(text, language) if isinstance(text, Bilingual) else text


def _shown(text: Bilingual | str | None, language: str) -> str:
    part = _part(text, language)
    return "nothing" if part is None else f"“{part}”"


def changes(sheet: Sheet, exhibits: Iterable[Exhibit]) -> tuple[Changes, list[Fault]]:
    """Exhibit -> what changes there, and what is wrong with the table. Exhibits without a row, and texts without a
    column, stay as they are."""
    known = {exhibit.id: exhibit for exhibit in exhibits}
    found: Changes = {}
    faults = list(sheet.faults)
    for row in sheet.rows:
        exhibit = known.get(row.id)
        if exhibit is None:
            what = "there is no such exhibit, or hall check has something to say about it"
            fix = f"make its folder exhibits/{row.id} first, or put right what hall check names"
            faults.append(Fault(row.number, "id", what, fix, row.id))
            continue
        changed, wrong = _of_row(row, exhibit, sheet.lines)
        faults += wrong
        if changed:
            found[row.id] = tuple(changed)
    return found, faults


def _of_row(row: Row, exhibit: Exhibit, lines: int) -> tuple[list[Change], list[Fault]]:
    found: list[Change] = []
    faults: list[Fault] = []
    added: dict[int, list[Change]] = {}  # further lines that the record does not have yet
    there = len(exhibit.file.record.line)
    for place in places(lines):
        before = pair(exhibit.file, place.path)
        texts = {x: _cell(row, place, x, _part(before, x)) for x in LANGUAGES}
        new = Bilingual(**texts) if all(texts.values()) else None
        if (fault := _blank(row, place, texts, there)) is not None:
            faults.append(fault)
        elif new != before:
            change = Change(place.path, before, new)
            (found if place.line is None or place.line < there else added.setdefault(place.line, [])).append(
                change
            )
    for line, changed in sorted(added.items()):
        if line != there or len(changed) != 2:
            column = f"record.line[{line + 1}].label.zh"
            what = f"a new line needs label and value, and {there} {'is' if there == 1 else 'are'} there before it"
            faults.append(Fault(row.number, column, what, f"fill all of record.line[{there + 1}] first"))
            break
        found += changed
        there += 1
    licence, before = row.cells.get(LICENCE, exhibit.file.licence), exhibit.file.licence
    if not licence.strip():
        faults.append(Fault(row.number, LICENCE, "the cell is empty", "write the licence, e.g. CC0-1.0"))
    elif not _same(licence, before):
        found.append(Change((LICENCE,), before, licence))
    return found, faults


def _cell(row: Row, place: Place, language: str, before: str | None) -> str:
    """The text of that language: the cell's, or what it was where there is no such column; "" where there is none."""
    cell = row.cells.get(f"{key(place.path)}.{language}")
    if cell is None or (before is not None and _same(cell, before)):
        return before or ""
    return cell.replace("\r\n", "\n") if cell.strip() else ""


def _same(cell: str, text: str) -> bool:
    """Whether they say the same: spreadsheets write line breaks in their own way."""
    return _lines(cell) == _lines(text)


def _lines(text: str) -> str:
    return text.replace("\r\n", "\n").replace("\r", "\n")


def _blank(row: Row, place: Place, texts: Mapping[str, str], there: int) -> Fault | None:
    """Why the texts cannot be so empty."""
    empty = [language for language in LANGUAGES if not texts[language]]
    if not empty:
        return None
    column = f"{key(place.path)}.{empty[0]}"
    if len(empty) == 1:
        given = next(language for language in LANGUAGES if language not in empty)
        fix = "write it in both languages, or empty both cells"
        return Fault(row.number, column, f"the cell is empty, while {given} is not", fix)
    if place.needed:
        return Fault(row.number, column, "the cell is empty", "write it in both languages")
    if place.line is not None and place.line < there:
        fix = f"remove its [[record.line]] in exhibits/{row.id}/exhibit.toml"
        return Fault(row.number, column, "a line cannot be removed by the table", fix)
    return None
