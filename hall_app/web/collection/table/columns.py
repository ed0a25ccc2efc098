"""Columns of the table: their names are the keys of exhibit.toml, as `hall check` names them, and their language."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from hall_app.content.schema.exhibit import ExhibitFile, Record
from hall_app.content.schema.values import Bilingual
from hall_app.web.collection.record import LANGUAGES

__all__ = ["ID", "LICENCE", "Path", "Place", "column_names", "key", "most_lines", "pair", "places"]

ID, LICENCE = "id", "licence"
Path = tuple[str | int, ...]  # from the top of exhibit.toml; a list's entries count from 0

_FIXED = tuple(name for name in Record.model_fields if name != "line")
_LINE = ("label", "value")


@dataclass(frozen=True)
class Place:
    """Where a text of both languages stands. needed: it cannot be left out; line: of which further line (from 0)."""

    path: Path
    needed: bool = False
    line: int | None = None


def places(lines: int) -> Iterator[Place]:
    """All texts of both languages, in the table's order. lines: further lines of the record."""
    yield Place(("title",), needed=True)
    yield Place(("caption",))
    for name in _FIXED:
        yield Place(("record", name))
    for line in range(lines):
        for part in _LINE:
            yield Place(("record", "line", line, part), line=line)


def column_names(lines: int) -> list[str]:
    """The table's head. lines: the most further lines that one exhibit has."""
    texts = [f"{key(place.path)}.{language}" for place in places(lines) for language in LANGUAGES]
    return [ID, *texts, LICENCE]


def key(path: Path) -> str:
    """The path as a curator reads it: record.line[1].label is of the first line."""
    name = ""
    for part in path:
        name += f"[{part + 1}]" if isinstance(part, int) else f".{part}" if name else part
    return name


def pair(file: ExhibitFile, path: Path) -> Bilingual | None:
    """The text at `path`, None where there is none."""
    found: object = file
    for part in path:
        if isinstance(part, int):
            found = found[part] if isinstance(found, tuple) and part < len(found) else None
        else:
            found = getattr(found, part, None)
    return found if isinstance(found, Bilingual) else None


def most_lines(files: Iterable[ExhibitFile]) -> int:
    """How many further lines the exhibit has that has most."""
    return max((len(file.record.line) for file in files), default=0)
