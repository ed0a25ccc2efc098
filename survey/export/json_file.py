"""Answers as JSON: the questionnaire as it was asked, and every answer."""

from __future__ import annotations

import json
from collections.abc import Iterable

from survey.questionnaire import Questionnaire
from survey.store import Stored

__all__ = ["write_json"]


def write_json(questionnaire: Questionnaire, rows: Iterable[Stored]) -> str:
    """{"questionnaire": its document, "answers": [{submission, …, scores: {…}, suggestions: {…}}, …]}."""
    answers = [
        {
            "submission": row.answer.id,
            "version": row.answer.version,
            "language": row.answer.language,
            "exhibit": row.answer.exhibit,
            "received": row.received.strftime("%Y-%m-%dT%H:%M:%SZ"),
            "scores": dict(row.answer.scores),
            "suggestions": dict(row.answer.suggestions),
        }
        for row in rows
    ]
    told = {"questionnaire": questionnaire.document(), "answers": answers}
    return json.dumps(told, ensure_ascii=False, indent=1) + "\n"
