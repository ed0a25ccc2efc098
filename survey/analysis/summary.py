"""An `Analysis` as plain data for --json and the API: no NaN, matrices as {rows, cols, values}."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from survey.analysis.adequacy import Adequacy
from survey.analysis.components import Components
from survey.analysis.pipeline import Analysis

__all__ = ["summary"]


def summary(analysis: Analysis) -> dict[str, Any]:
    """Every key is always there; what could not be computed is null and explained in `warnings`."""
    found, alpha = analysis.correlation, analysis.reliability
    deleted = None if alpha is None or alpha.if_deleted is None else alpha.if_deleted
    return {
        "n": analysis.n,
        "items": list(analysis.items),
        "dropped": list(analysis.dropped),
        "mean": _by_item(analysis.items, analysis.mean),
        "sd": _by_item(analysis.items, analysis.sd),
        "answered": {item: int(count) for item, count in zip(analysis.items, analysis.answered, strict=True)},
        "correlation": None if found is None else _matrix(analysis.correlated, analysis.correlated, found.r),
        "p": None if found is None else _matrix(analysis.correlated, analysis.correlated, found.p),
        **_adequacy(analysis.factored, analysis.adequacy),
        **_components(analysis.factored, analysis.components),
        "alpha": None if alpha is None else alpha.alpha,
        "alpha_standardised": None if alpha is None else alpha.standardised,
        "alpha_if_deleted": None if deleted is None else _by_item(analysis.factored, deleted),
        "warnings": [
            {"code": note.code, "items": list(note.items), "message": note.message} for note in analysis.notes
        ],
    }


def _adequacy(items: Sequence[str], fit: Adequacy | None) -> dict[str, Any]:
    if fit is None:
        return {"kmo": None, "kmo_per_item": None, "bartlett": None}
    test = fit.bartlett
    return {
        "kmo": fit.kmo,
        "kmo_per_item": _by_item(items, fit.kmo_per_item),
        "bartlett": {"chi2": test.chi2, "df": test.df, "p": test.p},
    }


def _components(items: Sequence[str], found: Components | None) -> dict[str, Any]:
    if found is None:
        return {"eigenvalues": None, "variance": None, "loadings": None, "rotation": None}
    order = found.sorted_items()
    columns = [f"component_{number + 1}" for number in range(found.kept)]
    return {
        "eigenvalues": found.eigenvalues.tolist(),
        "variance": {
            "initial": _variance(found.eigenvalues, len(items)),
            "rotated": _variance(found.rotated, len(items)),
        },
        "loadings": _matrix([items[row] for row in order], columns, found.loadings[order]),
        "rotation": "varimax, Kaiser normalisation",
    }


def _variance(squares: np.ndarray, p: int) -> list[dict[str, float]]:
    share = 100.0 * squares / p
    rows = zip(squares, share, np.cumsum(share), strict=True)
    return [{"total": float(a), "percent": float(b), "cumulative": float(c)} for a, b, c in rows]


def _by_item(items: Sequence[str], values: np.ndarray) -> dict[str, float]:
    return {item: float(value) for item, value in zip(items, values, strict=True)}


def _matrix(rows: Sequence[str], cols: Sequence[str], values: np.ndarray) -> dict[str, Any]:
    return {"rows": list(rows), "cols": list(cols), "values": values.tolist()}
