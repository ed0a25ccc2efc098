"""What a finding is made of as plain data for JSON: no NaN, matrices as {rows, cols, values}, notes as warnings."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from survey.analysis.screening import Note

__all__ = ["matrix", "number", "warnings"]


def number(value: float) -> float | None:
    """JSON knows no NaN."""
    return float(value) if np.isfinite(value) else None


def matrix(rows: Sequence[str], cols: Sequence[str], values: np.ndarray) -> dict[str, Any]:
    """values: (rows, cols), NaN where undefined."""
    return {
        "rows": list(rows),
        "cols": list(cols),
        "values": [[number(value) for value in row] for row in values],
    }


def warnings(notes: Iterable[Note]) -> list[dict[str, Any]]:
    """Each note's code, items and message."""
    return [{"code": note.code, "items": list(note.items), "message": note.message} for note in notes]
