"""Words of a text file and where each stands, so that a reader can say line and column of what is wrong."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from sim_core.errors import FileProblem
from sim_core.validation.files import shown

__all__ = ["Words"]

_WORD = re.compile(r"\S+")


@dataclass
class Words:
    """The words of a text, read one after the other; path: of the file, for errors."""

    path: Path
    text: str

    def __post_init__(self) -> None:
        if "\r" in self.text:  # lines that end as on Windows, or on an old Mac
            self.text = self.text.replace("\r\n", "\n").replace("\r", "\n")
        self._at = 0
        self.start = 0  # of the word read last

    def peek(self) -> str | None:
        """The next word, or None at the end of the text."""
        found = _WORD.search(self.text, self._at)
        return found.group() if found else None

    def next(self, wanted: str) -> str:
        """The next word; `wanted`: what should stand there. Raises FileProblem where the text ends."""
        found = _WORD.search(self.text, self._at)
        if found is None:
            self.start = len(self.text.rstrip())
            raise self.problem(f"the file ends where {wanted} should stand")
        self.start, self._at = found.start(), found.end()
        return found.group()

    def expect(self, *known: str) -> str:
        """The next word, one of those known whatever its case. Raises FileProblem for any other."""
        wanted = " or ".join(known)
        word = self.next(wanted)
        for one in known:
            if word.lower() == one.lower():
                return one
        raise self.problem(f"{shown(word)} where {wanted} should stand")

    def number(self, wanted: str) -> float:
        """The next word as a finite number."""
        return self.as_number(self.next(wanted), wanted)

    def as_number(self, word: str, wanted: str) -> float:
        """A word that was read, as a finite number."""
        try:
            value = float(word)
        except ValueError:
            value = float("nan")
        if not -1e12 < value < 1e12:
            raise self.problem(f"{shown(word)} is not a finite number – {wanted} is meant")
        return value

    def whole(self, wanted: str, most: int) -> int:
        """The next word as a whole number from 0 to `most`."""
        word = self.next(wanted)
        if not word.isdecimal() or len(word) > 12 or int(word) > most:
            raise self.problem(f"{shown(word)} – {wanted} is meant, a whole number from 0 to {most}")
        return int(word)

    def rest_of_line(self) -> str:
        """What is left of the line, or of it before a bracket, without blanks around it."""
        end = self.text.find("\n", self._at)
        end = len(self.text) if end < 0 else end
        bracket = self.text.find("{", self._at, end)
        end = end if bracket < 0 else bracket
        line = self.text[self._at : end]
        self.start, self._at = self._at + len(line) - len(line.lstrip()), end
        return line.strip()

    def rest(self) -> tuple[str, int]:
        """All that is left, and where it begins."""
        return self.text[self._at :], self._at

    def problem(self, what: str, at: int | None = None) -> FileProblem:
        """An error that names file, line and column of the word read last, or of the place `at`."""
        at = self.start if at is None else at
        line = self.text.count("\n", 0, at) + 1
        column = at - self.text.rfind("\n", 0, at)
        return FileProblem(f"{self.path}: line {line}, column {column}: {what}")
