"""What everybody may see: counts and means, and only where enough visitors answered."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from statistics import fmean
from typing import Any

from survey.answer import Answer
from survey.questionnaire import Item, Questionnaire

__all__ = ["LEAST", "public_results"]

LEAST = 5  # below this number of answers a mean could tell what a single visitor said


def public_results(questionnaire: Questionnaire, answers: Sequence[Answer]) -> dict[str, Any]:
    """n and, from five answers on, the mean of each item and of each module; null where fewer scored it."""
    enough = len(answers) >= LEAST
    scores = [dict(answer.scores) for answer in answers] if enough else []
    return {
        "questionnaire": questionnaire.id,
        "version": questionnaire.version,
        "n": len(answers),
        "least": LEAST,
        "points": questionnaire.points,
        "items": [_row(item.id, item, scores, [item]) for item in questionnaire.items] if enough else None,
        "modules": [
            _row(module.id, module, scores, questionnaire.items_of(module))
            for module in questionnaire.modules
        ]
        if enough
        else None,
    }


def _row(
    key: str, named: Any, scores: Iterable[dict[str, int | None]], items: Iterable[Item]
) -> dict[str, Any]:
    label = named.label if isinstance(named, Item) else named.title
    wanted = [item.id for item in items]
    given = [[score for item in wanted if (score := row.get(item)) is not None] for row in scores]
    given = [row for row in given if row]
    mean = fmean(score for row in given for score in row) if len(given) >= LEAST else None
    return {"id": key, "label": label.model_dump(), "n": len(given), "mean": mean}
