"""The paper's indicators: 25 primary ones, what became of each of them, and the twelve that were asked."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

__all__ = ["Primary", "intermediate", "merged", "primary", "questionnaire_id", "sample_name"]


@dataclass(frozen=True)
class Primary:
    """name: (zh, en). into: the item that it became, None where it was deleted; why: (zh, en) then."""

    id: str
    name: tuple[str, str]
    into: str | None
    why: tuple[str, str] | None


@lru_cache(maxsize=1)
def _told() -> dict:
    return tomllib.loads((Path(__file__).parent / "indicators.toml").read_text("utf-8"))


def questionnaire_id() -> str:
    """Of the questionnaire that asks the intermediate indicators."""
    return _told()["questionnaire"]


def sample_name() -> str:
    """Of the synthetic sample that has a score for every primary indicator."""
    return _told()["sample"]


@lru_cache(maxsize=1)
def primary() -> tuple[Primary, ...]:
    """All 25, in the paper's order."""
    return tuple(
        Primary(
            one["id"],
            _both(one["name"]),
            one.get("into"),
            _both(one["deleted"]) if "deleted" in one else None,
        )
        for one in _told()["primary"]
    )


def intermediate() -> dict[str, tuple[str, ...]]:
    """Item → the primary indicators that became it, in the paper's order."""
    parts: dict[str, tuple[str, ...]] = {}
    for one in primary():
        if one.into is not None:
            parts[one.into] = (*parts.get(one.into, ()), one.id)
    return parts


def merged(scores: NDArray[np.float64], names: Sequence[str], items: Sequence[str]) -> NDArray[np.float64]:
    """(n, p) of the intermediate indicators `items`: each the mean of its parts among scores (n, 25), named `names`."""
    parts = intermediate()
    return np.column_stack(
        [scores[:, [names.index(part) for part in parts[item]]].mean(axis=1) for item in items]
    )


def _both(text: dict[str, str]) -> tuple[str, str]:
    return text["zh"], text["en"]
