"""What everybody may see: counts and means as the last step published them, in steps that tell of nobody."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from math import floor
from typing import Any

from survey.questionnaire import Questionnaire, Text
from survey.store import Public
from survey.store.publication import STEP, Figure, Reason, Shown

__all__ = ["LEAST", "public_results"]

LEAST = STEP  # answers, and scores of an item, from which on there are figures, and by which they move on

WHY: dict[Reason, Text] = {
    "few": Text(
        zh="新评分不足十个，暂不公布。", en="Fewer than ten new scores; the figure follows with more."
    ),
    "telling": Text(
        zh="此时公布会透露个别观众的评分，待更多回答后再公布。",
        en="A figure would tell what single visitors answered now; it follows with more answers.",
    ),
}


def public_results(questionnaire: Questionnaire, public: Public) -> dict[str, Any]:
    """n and the mean of each item and of each module, as of the last step; before the first one null.

    Each mean has the n that it is of, as many decimals as that n supports, and where it is null, `withheld`.
    A module's is made from what is public of its items, so it tells nothing that they do not.
    """
    shown = {item.id: public.items.get(item.id, Shown()) for item in questionnaire.items}
    items = [_row(item.id, item.label, *_seen(shown[item.id])) for item in questionnaire.items]
    modules = [
        _row(module.id, module.title, *_together(shown[item.id] for item in questionnaire.items_of(module)))
        for module in questionnaire.modules
    ]
    return {
        "questionnaire": questionnaire.id,
        "version": questionnaire.version,
        "n": public.n,
        "least": LEAST,
        "points": questionnaire.points,
        "items": items if public.step else None,
        "modules": modules if public.step else None,
    }


def _row(key: str, label: Text, figure: Figure | None, withheld: Reason | None) -> dict[str, Any]:
    return {
        "id": key,
        "label": label.model_dump(),
        "n": figure.n if figure else None,
        "mean": figure.mean if figure else None,
        "decimals": figure.decimals if figure else None,
        "withheld": {"reason": withheld, **WHY[withheld].model_dump()} if withheld else None,
    }


def _seen(shown: Shown) -> tuple[Figure | None, Reason | None]:
    return (None, shown.withheld) if shown.withheld else (shown.figure, None)


def _together(items: Iterable[Shown]) -> tuple[Figure | None, Reason | None]:
    """The mean of the items that have one, each by its n; none while one is held back as telling.

    An item that too few scored, or that is not asked here, is left out. n: of the item with the most scores.
    """
    seen = [_seen(item) for item in items]
    figures = [figure for figure, _ in seen if figure is not None]
    if any(reason == "telling" for _, reason in seen):
        return None, "telling"
    if not figures:
        return None, "few"
    decimals = min(figure.decimals for figure in figures)
    total = sum(figure.n * Fraction(figure.units, 10**figure.decimals) for figure in figures)
    mean = total / sum(figure.n for figure in figures)
    return Figure(
        max(figure.n for figure in figures), floor(mean * 10**decimals + Fraction(1, 2)), decimals
    ), None
