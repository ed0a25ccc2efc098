"""What everybody may see: counts and means, and only where enough visitors answered."""

from __future__ import annotations

from typing import Any

from survey.questionnaire import Questionnaire, Text
from survey.store import Count, Tally

__all__ = ["LEAST", "public_results"]

LEAST = 5  # below this number of answers a mean could tell what a single visitor said


def public_results(questionnaire: Questionnaire, tally: Tally) -> dict[str, Any]:
    """n and, from five answers on, the mean of each item and of each module; null where fewer scored it."""
    enough = tally.n >= LEAST
    items = [_row(item.id, item.label, tally.items.get(item.id)) for item in questionnaire.items]
    modules = [
        _row(module.id, module.title, tally.modules.get(module.id)) for module in questionnaire.modules
    ]
    return {
        "questionnaire": questionnaire.id,
        "version": questionnaire.version,
        "n": tally.n,
        "least": LEAST,
        "points": questionnaire.points,
        "items": items if enough else None,
        "modules": modules if enough else None,
    }


def _row(key: str, label: Text, count: Count | None) -> dict[str, Any]:
    found = count or Count()
    mean = found.total / found.scores if found.answers >= LEAST else None
    return {"id": key, "label": label.model_dump(), "n": found.answers, "mean": mean}
