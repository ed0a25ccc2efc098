"""Questionnaires as visitors are asked them: a version stands as it was at its first answer."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from survey.questionnaire.definition import Questionnaire
from survey.store import Store

__all__ = ["Published"]


class Published(Mapping[str, Questionnaire]):
    """The questionnaires of `files` by id; one that was edited without raising its version stays as it was asked.

    Answers to it can so be given, counted and exported; that the file differs is told among the problems.
    """

    def __init__(self, files: Mapping[str, Questionnaire], store: Store) -> None:
        self._files, self._store = files, store
        self._same: set[tuple[str, int, str]] = set()  # versions seen to be frozen as their file reads

    def __getitem__(self, key: str) -> Questionnaire:
        return self.as_asked(self._files[key])

    def __iter__(self) -> Iterator[str]:
        return iter(self._files)

    def __len__(self) -> int:
        return len(self._files)

    def as_asked(self, current: Questionnaire) -> Questionnaire:
        """The frozen form of the file's version, else the file's."""
        name = (current.id, current.version, current.digest)
        if name in self._same:
            return current
        frozen = self._store.frozen(current.id, current.version)
        if frozen is None:
            return current
        if frozen.digest == current.digest:
            self._same.add(name)
        return frozen
