"""Errors of the survey, each a single line that names what, where and the remedy; a full temporary folder is one."""

from __future__ import annotations

import errno
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path

__all__ = [
    "AnswerError",
    "ContentMissing",
    "Problem",
    "QuestionnaireError",
    "StoreError",
    "SurveyError",
    "is_full",
    "room_in",
]


class SurveyError(ValueError):
    """Whatever the survey can explain in one line."""


@dataclass(frozen=True, order=True)
class Problem:
    """One thing to put right in a questionnaire file; `key` may be empty."""

    file: str
    key: str
    what: str
    fix: str

    def __str__(self) -> str:
        where = f"{self.file}: {self.key}" if self.key else self.file
        return f"{where}: {self.what} – {self.fix}".replace("\n", " ")

    def as_json(self) -> dict[str, str]:
        return asdict(self)


class QuestionnaireError(SurveyError):
    """A questionnaire file cannot be used. Carries every problem found in it."""

    def __init__(self, problems: Iterable[Problem]) -> None:
        self.problems = tuple(problems)
        rest = len(self.problems) - 1
        more = f" (and {rest} more)" if rest else ""
        super().__init__(f"{self.problems[0]}{more}")


class ContentMissing(SurveyError):
    """No content folder, or no questionnaires in it."""


class AnswerError(SurveyError):
    """A submission that is refused: which field, what is wrong with it, what to do."""

    def __init__(self, field: str, problem: str, remedy: str, *, status: int = 422, wait: int = 0) -> None:
        self.field, self.problem, self.remedy, self.status = field, problem, remedy, status
        self.wait = wait  # seconds after which the same would be taken (429)
        super().__init__(f"{field}: {problem} – {remedy}" if field else f"{problem} – {remedy}")


class StoreError(SurveyError):
    """The database does not take or give anything now: locked, full, unreachable or of another make.

    place: the file or the URL without its password; it stands in the text for the operator, `problem` is for
    everybody.
    """

    def __init__(self, problem: str, place: str = "") -> None:
        self.problem, self.place = problem, place
        super().__init__(f"{place}: {problem}" if place else problem)


_FULL = {errno.ENOSPC, getattr(errno, "EDQUOT", errno.ENOSPC)}  # the disk, or its user's share of it


def is_full(error: OSError) -> bool:
    """Whether it says that there is no room."""
    return error.errno in _FULL


@contextmanager
def room_in(folder: Path | str) -> Iterator[None]:
    """Raises StoreError where what is written into a temporary folder finds no room there."""
    try:
        yield
    except OSError as error:
        if not is_full(error):
            raise
        # The folder is named to whoever asks as well: he has a token, and passes it on to whoever can free some.
        problem = f"no room in the temporary folder {folder} – free some, or set TMPDIR"
        raise StoreError(problem) from None
