"""The questionnaire that a request means, in the version that it means."""

from __future__ import annotations

from collections.abc import Mapping

from survey.errors import AnswerError
from survey.questionnaire import Questionnaire
from survey.store import Store

__all__ = ["Questionnaires", "find_questionnaire", "find_version"]

Questionnaires = Mapping[str, Questionnaire]


def find_questionnaire(questionnaires: Questionnaires, key: str) -> Questionnaire:
    """The current version. Raises AnswerError 404."""
    try:
        return questionnaires[key]
    except KeyError:
        remedy = "choose one of " + (", ".join(questionnaires) or "none yet")
        raise AnswerError("questionnaire", "no such questionnaire", remedy, status=404) from None


def find_version(
    questionnaires: Questionnaires, store: Store, key: str, version: int | None
) -> Questionnaire:
    """A version as it was asked, the current one where None. Raises AnswerError 404.

    An earlier version is found in the store, also when the questionnaire has left the hall.
    """
    current = questionnaires.get(key)
    if version is None or (current is not None and version == current.version):
        return find_questionnaire(questionnaires, key)
    found = store.frozen(key, version)
    if found is None:
        known = ", ".join(map(str, store.versions(key)))
        remedy = f"choose one of {known}" if known else "leave it out for the current one"
        raise AnswerError("version", f"version {version} has no answers", remedy, status=404)
    return found
