"""Synthetic samples for the statistics, and submissions for the doors. Nothing here was answered by a person."""

from __future__ import annotations

import copy
import uuid
from pathlib import Path
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray
from sqlalchemy import create_engine, text

from survey.demonstration import ALPHA, CHI2, KMO, TABLE_3, TABLE_3_ITEMS, drawn_sample, sample_file
from survey.scores import read_scores

__all__ = [
    "ALPHA",
    "ASSETS",
    "CHI2",
    "KMO",
    "TABLE_3",
    "TABLE_3_ITEMS",
    "given",
    "likert_sample",
    "looked_up",
    "paper_sample",
    "submission",
]

ASSETS = Path(__file__).parents[2] / "assets"


T = TypeVar("T")


def given(value: T | None) -> T:
    """What must be there: a step of the analysis that no note excuses."""
    assert value is not None
    return value


def paper_sample() -> tuple[NDArray[np.float64], tuple[str, ...]]:
    """Twelve items, 20 rows: Table 3's ten with the printed KMO, χ² and α, and the two static ones at .968, .930."""
    table = read_scores(sample_file("exact-20"))
    return table.scores, table.items


def likert_sample(n: int, seed: int) -> NDArray[np.float64]:
    """n rows of the ten items as whole scores 1–5, drawn from Table 3's population."""
    return drawn_sample(n, seed)[:, : len(TABLE_3)]


def submission(questionnaire, *, score: int | None = 4, **changes) -> dict:
    """A valid body for a questionnaire; `changes` replace its fields."""
    body = {
        "id": str(uuid.uuid4()),
        "version": questionnaire.version,
        "language": "zh",
        "consent": True,
        "scores": dict.fromkeys(questionnaire.item_ids, score),
        "suggestions": {},
    }
    return copy.deepcopy(body | changes)


def looked_up(where: Path | str, query: str) -> list[tuple]:
    """Rows of a store's database, read behind the product's back."""
    engine = create_engine(f"sqlite:///{where / 'survey.sqlite'}" if isinstance(where, Path) else where)
    try:
        with engine.connect() as connection:
            return [tuple(row) for row in connection.execute(text(query))]
    finally:
        engine.dispose()
