"""Questionnaire files: where they lie, reading them, and reading them again when they change."""

from __future__ import annotations

import importlib.util
import math
import os
import time
import tomllib
from collections.abc import Iterator, Mapping
from pathlib import Path

from pydantic import ValidationError

from survey.errors import ContentMissing, Problem, QuestionnaireError, SurveyError
from survey.questionnaire.definition import Questionnaire
from survey.questionnaire.keys import is_slug

__all__ = [
    "QuestionnaireFolder",
    "content_folder",
    "find_questionnaire_file",
    "problem_of",
    "read_questionnaire",
]

QUESTIONNAIRES = "questionnaires"


def content_folder(given: Path | None = None) -> Path:
    """The content folder: `given`, else ./assets, else the copy that ships with the hall.

    Raises ContentMissing. The hall is found without importing it: the survey must run where it is absent.
    """
    if given is not None:
        if not given.is_dir():
            raise ContentMissing(
                f"{given}: no such content folder – give --content a folder with {QUESTIONNAIRES}/"
            )
        return given
    candidates = [Path("assets")]
    hall = importlib.util.find_spec("hall_app")
    if hall is not None and hall.origin is not None:
        package = Path(hall.origin).parent
        candidates += [package / "assets", package.parent / "assets"]
    for folder in candidates:
        if (folder / QUESTIONNAIRES).is_dir():
            return folder
    raise ContentMissing(f"no content folder with {QUESTIONNAIRES}/ found – give one with --content")


def read_questionnaire(path: Path) -> Questionnaire:
    """Read one file. Raises QuestionnaireError with every problem, each naming file, key and remedy."""
    file = f"{path.parent.name}/{path.name}"
    try:
        data = tomllib.loads(path.read_text("utf-8-sig"))
    except OSError as error:
        raise QuestionnaireError(
            (Problem(file, "", f"cannot be read ({error.strerror})", "check it"),)
        ) from None
    except UnicodeDecodeError:
        raise QuestionnaireError((Problem(file, "", "is not UTF-8 text", "save it as UTF-8"),)) from None
    except tomllib.TOMLDecodeError as error:
        raise QuestionnaireError((Problem(file, "", f"is not TOML: {error}", "mend that line"),)) from None
    except (ValueError, RecursionError) as error:
        # A number of thousands of digits, thousands of brackets: nothing a questionnaire needs.
        what = f"cannot be read ({type(error).__name__})"
        raise QuestionnaireError((Problem(file, "", what, "shorten its numbers and lists"),)) from None
    try:
        questionnaire = Questionnaire.model_validate(data)
    except ValidationError as error:
        raise QuestionnaireError(tuple(problem_of(file, entry) for entry in error.errors())) from None
    if questionnaire.id != path.stem:
        what = f"{questionnaire.id!r} is not the file's name"
        raise QuestionnaireError((Problem(file, "id", what, f'write id = "{path.stem}" or rename the file'),))
    return questionnaire


def find_questionnaire_file(content: Path | None, key: str) -> Questionnaire:
    """The questionnaire of that id. Raises SurveyError naming those there are."""
    folder = content_folder(content) / QUESTIONNAIRES
    path = folder / f"{key}.toml"
    if not is_slug(key) or not path.is_file():
        known = ", ".join(found.stem for found in sorted(folder.glob("*.toml"))) or "none"
        raise SurveyError(f"{key[:60]}: no such questionnaire in {folder} – choose one of: {known}")
    return read_questionnaire(path)


def problem_of(file: str, entry: Mapping) -> Problem:
    """One pydantic error as a problem with a remedy."""
    key = ".".join(str(part) for part in entry["loc"])
    kind, value = entry["type"], repr(entry.get("input"))[:60]
    if kind == "extra_forbidden":
        return Problem(file, key, "unknown key", "remove it or correct its spelling")
    if kind == "missing":
        return Problem(file, key, "missing", "add it")
    if kind == "value_error":
        what, _, remedy = entry["msg"].removeprefix("Value error, ").partition("; ")
        return Problem(file, key, what, remedy or "keep one of the two")
    message = entry["msg"]
    return Problem(file, key, f"{message[0].lower()}{message[1:]}", f"change {value}")


def _marks(folder: Path) -> dict[str, tuple[int, int]]:
    """Time and size of each questionnaire file, by its name."""
    try:
        with os.scandir(folder) as entries:
            found = [entry for entry in entries if entry.name.endswith(".toml") and entry.is_file()]
            return {entry.name: ((stat := entry.stat()).st_mtime_ns, stat.st_size) for entry in found}
    except FileNotFoundError:  # no folder yet, or a file that went between the two looks
        return {}


class QuestionnaireFolder(Mapping[str, Questionnaire]):
    """The questionnaires of a content folder by id, sorted; a changed file shows on the next look.

    A faulty file is left out and named in `problems`; one that was good before stays as it was.
    patience: seconds for which the last look at the folder is good enough. Every look is several system calls, at
    each of which a busy service may have to wait for its other threads.
    """

    def __init__(self, content: Path, *, patience: float = 0.0) -> None:
        self.folder = content / QUESTIONNAIRES
        self._patience, self._looked = patience, -math.inf
        self._marks: dict[str, tuple[int, int]] | None = None
        self._seen: dict[Path, tuple[int, int]] = {}
        self._good: dict[Path, Questionnaire] = {}
        self._bad: dict[Path, tuple[Problem, ...]] = {}
        self.refresh()

    @property
    def problems(self) -> tuple[Problem, ...]:
        """What is wrong with the files now, in the order of their names."""
        self._looked = -math.inf
        self.refresh()
        return tuple(problem for path in sorted(self._bad) for problem in self._bad[path])

    def refresh(self) -> None:
        """Read the files that are new or changed; forget those that are gone."""
        if time.monotonic() - self._looked < self._patience:
            return
        marks = _marks(self.folder)
        self._looked = time.monotonic()
        if marks == self._marks:  # asked again and again, so the usual case is a single look at the folder
            return
        self._marks = marks
        paths = {self.folder / name: mark for name, mark in sorted(marks.items())}
        for path in set(self._seen) - set(paths):
            for table in (self._seen, self._good, self._bad):
                table.pop(path, None)
        for path, mark in paths.items():
            if self._seen.get(path) == mark:
                continue
            try:
                self._good[path] = read_questionnaire(path)
                self._bad.pop(path, None)
            except QuestionnaireError as error:
                self._bad[path] = error.problems
            self._seen[path] = mark

    def __getitem__(self, key: str) -> Questionnaire:
        self.refresh()
        return self._good[self.folder / f"{key}.toml"]

    def __iter__(self) -> Iterator[str]:
        self.refresh()
        return iter([self._good[path].id for path in sorted(self._good)])

    def __len__(self) -> int:
        return len(self._good)
