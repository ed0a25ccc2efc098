"""`Answer`: one submitted questionnaire, validated and immutable; and how a submission becomes one."""

from __future__ import annotations

import hashlib
import json
import uuid
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, get_args

from survey.errors import AnswerError
from survey.questionnaire.definition import Item, Language, Questionnaire
from survey.questionnaire.keys import is_slug

__all__ = ["TEXT_LIMIT", "Answer", "ever_asked"]

TEXT_LIMIT = 2000  # characters of one suggestion

_NOBODY = (str(uuid.UUID(int=0)), str(uuid.UUID(int=2**128 - 1)))  # RFC 9562 sets both apart

_FRESH = "make a fresh one, such as 0b2c7e7e-8f0e-4e1c-9d0a-3f5b6a7c8d9e"

_REQUIRED = ("id", "version", "language", "consent", "scores")
_OPTIONAL = ("suggestions", "exhibit")


@dataclass(frozen=True)
class Answer:
    """What one visitor answered.

    id: UUID made by the visitor's browser; it is the key against duplicates and the withdrawal code.
    scores: (item, point) in the order of the questionnaire; point 1 … points, or None for "not seen"; an item that
    was not asked is not among them.
    suggestions: (module, text) where something was written. exhibit: at which exhibit it was asked, or None.
    """

    id: str
    questionnaire: str
    version: int
    language: Language
    scores: tuple[tuple[str, int | None], ...]
    suggestions: tuple[tuple[str, str], ...] = ()
    exhibit: str | None = None

    @cached_property
    def digest(self) -> str:
        """SHA-256 of the whole content, hexadecimal: a replay has the same, another body has not."""
        text = json.dumps(vars(self), ensure_ascii=False, sort_keys=True, separators=(",", ":"))
        return hashlib.sha256(text.encode()).hexdigest()

    @classmethod
    def of(cls, questionnaire: Questionnaire, data: object) -> Answer:
        """Validate a submission's decoded JSON against the questionnaire. Raises AnswerError."""
        if not isinstance(data, dict):
            raise AnswerError(
                "", "the body is not a JSON object", "send an object with " + ", ".join(_REQUIRED)
            )
        _check_keys(data)
        _check_consent(data["consent"])
        return cls(
            id=submission_id(data["id"]),
            questionnaire=questionnaire.id,
            version=_version(questionnaire, data["version"]),
            language=_language(data["language"]),
            scores=_scores(questionnaire, _table("scores", data["scores"])),
            suggestions=_suggestions(questionnaire, _table("suggestions", data.get("suggestions", {}))),
            exhibit=_exhibit(data.get("exhibit")),
        )


def ever_asked(questionnaire: Questionnaire, answers: Iterable[Answer]) -> Questionnaire:
    """What of the questionnaire was asked in any of the answers; all of it where there are none."""
    items = {item for answer in answers for item, _ in answer.scores}
    return questionnaire.asked(items) if items else questionnaire


def _check_keys(data: dict[str, Any]) -> None:
    for key in data:
        if key not in _REQUIRED and key not in _OPTIONAL:
            raise AnswerError(_shown(key), "unknown field", "send only " + ", ".join(_REQUIRED + _OPTIONAL))
    for key in _REQUIRED:
        if key not in data:
            raise AnswerError(key, "missing", f"add {key}")


def submission_id(value: object) -> str:
    """A UUID in its usual spelling, lower case; neither of all zeros nor of all ones. Raises AnswerError."""
    try:
        known = str(uuid.UUID(value)) if isinstance(value, str) else None
    except ValueError:
        known = None
    if known is None or not isinstance(value, str) or known != value.lower():
        raise AnswerError("id", "not a UUID", _FRESH)
    if known in _NOBODY:
        # It is the withdrawal code, and this one everybody knows.
        raise AnswerError("id", "the UUID of all zeros or all ones is nobody's", _FRESH)
    return known


def _version(questionnaire: Questionnaire, value: object) -> int:
    whole = type(value) is int or type(value) is float  # 1.0 is an integer to JSON Schema, true is none
    if not whole or value != questionnaire.version:
        problem = f"version {_shown(value)} is not the current one ({questionnaire.version})"
        raise AnswerError("version", problem, "load the questionnaire again and answer its current version")
    return questionnaire.version


def _language(value: object) -> Language:
    for language in get_args(Language):
        if value == language:
            return language
    raise AnswerError("language", f"{_shown(value)} is not offered", 'send "zh" or "en"')


def _check_consent(value: object) -> None:
    if value is not True:
        raise AnswerError(
            "consent", "consent is not given", "send true once the visitor has agreed, else nothing"
        )


def _table(field: str, value: object) -> dict[str, object]:
    if not isinstance(value, dict):
        raise AnswerError(field, "not an object", f"send {field} as an object of key and value")
    return value


def _scores(questionnaire: Questionnaire, given: Mapping[str, object]) -> tuple[tuple[str, int | None], ...]:
    known = questionnaire.item_ids
    for key in given:
        if key not in known:
            raise AnswerError(f"scores.{_shown(key)}", "no such item", "send only items of this version")
    return tuple((item.id, _score(questionnaire, item, given)) for item in questionnaire.items)


def _score(questionnaire: Questionnaire, item: Item, given: Mapping[str, object]) -> int | None:
    field, points = f"scores.{item.id}", questionnaire.points
    allowed = f"an integer from 1 to {points}" + (
        ", or null for not seen" if questionnaire.scale.not_seen else ""
    )
    if item.id not in given:
        if item.required:
            raise AnswerError(field, "missing", f"answer with {allowed}")
        return None
    value = given[item.id]
    if value is None and (questionnaire.scale.not_seen or not item.required):
        return None
    # 3.0 is an integer to JSON Schema, so the document we publish admits it; true is an int only to Python.
    whole = type(value) is int or (type(value) is float and value.is_integer())
    if not whole or not 1 <= value <= points:  # type: ignore[operator]
        raise AnswerError(field, f"{_shown(value)} is not on the scale", f"answer with {allowed}")
    return int(value)  # type: ignore[arg-type]


def _suggestions(questionnaire: Questionnaire, given: Mapping[str, object]) -> tuple[tuple[str, str], ...]:
    open_modules = [module.id for module in questionnaire.modules if module.suggestion]
    for key in given:
        if key not in open_modules:
            raise AnswerError(
                f"suggestions.{_shown(key)}", "no such module", "send only modules of this version"
            )
    texts = ((key, _text(f"suggestions.{key}", given[key])) for key in open_modules if key in given)
    return tuple((key, text) for key, text in texts if text)


def _text(field: str, value: object) -> str:
    if not isinstance(value, str):
        raise AnswerError(field, "not a text", "send a string")
    if len(value) > TEXT_LIMIT:
        problem = f"{len(value)} characters are too many"
        raise AnswerError(field, problem, f"shorten it to {TEXT_LIMIT} characters")
    if "\0" in value:
        raise AnswerError(field, "a NUL character", "remove it")
    if any("\ud800" <= character <= "\udfff" for character in value):
        raise AnswerError(field, "half a surrogate pair, which is no character", "remove it")
    return value.replace("\r\n", "\n").strip()


def _exhibit(value: object) -> str | None:
    if value is None:
        return None
    if not isinstance(value, str) or not is_slug(value):
        raise AnswerError(
            "exhibit", f"{_shown(value)} is not an exhibit's id", "send the id of its folder, or nothing"
        )
    return value


def _shown(value: object) -> str:
    """A value from outside, short and printable, for a message."""
    return ascii(value)[1:-1][:40] if isinstance(value, str) else ascii(value)[:40]
