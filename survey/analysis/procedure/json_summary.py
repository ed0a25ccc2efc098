"""An `Analysis` as plain data for --json and the API: no NaN, matrices as {rows, cols, values}."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from survey.analysis.components import Adequacy, Average, Bootstrap, Components, Parallel
from survey.analysis.plain_data import matrix, number, warnings
from survey.analysis.procedure.pipeline import Analysis
from survey.analysis.procedure.scales import Scale

__all__ = ["KEYS", "column_names", "descriptives", "summary"]

KEYS = (
    "n", "items", "dropped", "correlation", "p", "kmo", "kmo_per_item", "bartlett", "eigenvalues", "variance",
    "loadings", "rotation", "alpha", "alpha_if_deleted", "item_total", "omega", "scales", "reversed", "parallel", "map",
    "bootstrap", "warnings",
)  # fmt: skip


def summary(analysis: Analysis) -> dict[str, Any]:
    """The keys of KEYS in their order, always all; what could not be computed is null and explained in `warnings`."""
    found, alpha, kept = analysis.correlation, analysis.reliability, analysis.factored
    deleted = None if alpha is None else alpha.if_deleted
    return {
        "n": analysis.n,
        "items": list(analysis.items),
        "dropped": list(analysis.dropped),
        "correlation": None if found is None else matrix(analysis.items, analysis.items, found.r),
        "p": None if found is None else matrix(analysis.items, analysis.items, found.p),
        **_adequacy(kept, analysis.adequacy),
        **_components(analysis),
        "alpha": None if alpha is None else alpha.alpha,
        "alpha_if_deleted": None if deleted is None else _by_item(kept, deleted),
        "item_total": None if alpha is None else _by_item(kept, alpha.item_total),
        "omega": None if analysis.omega is None else analysis.omega.omega,
        "scales": [_scale(scale) for scale in analysis.scales],
        "reversed": list(analysis.turned.items),
        "parallel": None if analysis.parallel is None else _parallel(analysis.parallel),
        "map": None if analysis.average is None else _map(analysis.average),
        "bootstrap": None if analysis.bootstrap is None else _bootstrap(analysis, analysis.bootstrap),
        "warnings": warnings(analysis.notes),
    }


def descriptives(analysis: Analysis) -> list[dict[str, Any]]:
    """Per item: how many answered, mean and standard deviation."""
    rows = zip(analysis.items, analysis.answered, analysis.mean, analysis.sd, strict=True)
    return [{"item": a, "answered": int(b), "mean": number(c), "sd": number(d)} for a, b, c, d in rows]


def _scale(scale: Scale) -> dict[str, Any]:
    alpha = scale.reliability
    deleted = None if alpha is None else alpha.if_deleted
    return {
        "kind": scale.kind,
        "key": scale.key,
        "items": list(scale.items),
        "n": scale.n,
        "alpha": None if alpha is None else alpha.alpha,
        "alpha_standardised": None if alpha is None else alpha.standardised,
        "omega": None if scale.omega is None else scale.omega.omega,
        "item_total": None if alpha is None else _by_item(scale.items, alpha.item_total),
        "alpha_if_deleted": None if deleted is None else _by_item(scale.items, deleted),
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


def _components(analysis: Analysis) -> dict[str, Any]:
    found, items = analysis.components, analysis.factored
    values = None if analysis.eigenvalues is None else analysis.eigenvalues.tolist()
    if found is None:
        return {"eigenvalues": values, "variance": None, "loadings": None, "rotation": None}
    order = found.sorted_items()
    columns = column_names(found)
    return {
        "eigenvalues": values,
        "variance": {
            "initial": _variance(found.eigenvalues, len(items)),
            "rotated": _variance(found.rotated, len(items)),
        },
        "loadings": matrix([items[row] for row in order], columns, found.loadings[order]),
        "rotation": {
            "method": found.rotation,
            "normalisation": None if found.rotation == "none" else "kaiser",
            "matrix": matrix(columns, columns, found.transformation),
            "correlation": matrix(columns, columns, found.correlation),
        },
    }


def column_names(found: Components) -> list[str]:
    """component_1, component_2, …"""
    return [f"component_{at + 1}" for at in range(found.kept)]


def _variance(squares: np.ndarray, p: int) -> list[dict[str, float]]:
    share = 100.0 * squares / p
    rows = zip(squares, share, np.cumsum(share), strict=True)
    return [{"total": float(a), "percent": float(b), "cumulative": float(c)} for a, b, c in rows]


def _parallel(found: Parallel) -> dict[str, Any]:
    return {
        "draws": found.draws,
        "quantile": found.level,
        "mean": found.mean.tolist(),
        "upper": found.upper.tolist(),
        "keep": found.kept,
        "factors": {
            "eigenvalues": None if found.factors is None else found.factors.tolist(),
            "upper": found.factors_upper.tolist(),
            "keep": found.factors_kept,
        },
    }


def _map(found: Average) -> dict[str, Any]:
    return {
        "average_squared": found.squared.tolist(),
        "average_fourth": found.fourth.tolist(),
        "keep": found.kept,
        "keep_fourth": found.kept_fourth,
    }


def _bootstrap(analysis: Analysis, found: Bootstrap) -> dict[str, Any]:
    means = {
        item: {"mean": number(mean), "low": number(low), "high": number(high)}
        for item, mean, low, high in zip(analysis.items, analysis.mean, *found.means, strict=True)
    }
    alpha = None if found.alpha is None else {"low": float(found.alpha[0]), "high": float(found.alpha[1])}
    values = found.eigenvalues
    loadings = None
    if found.loadings is not None and analysis.components is not None:
        order, columns = analysis.components.sorted_items(), column_names(analysis.components)
        rows = [analysis.factored[row] for row in order]
        loadings = {
            side: matrix(rows, columns, edge[order])
            for side, edge in zip(("low", "high"), found.loadings, strict=True)
        }
    return {
        "draws": found.draws,
        "used": found.used,
        "level": found.level,
        "seed": analysis.settings.seed,
        "means": means,
        "alpha": alpha,
        "eigenvalues": None if values is None else {"low": values[0].tolist(), "high": values[1].tolist()},
        "loadings": loadings,
        "kaiser": None
        if found.kaiser is None
        else {str(k): float(x) for k, x in enumerate(found.kaiser) if x},
    }


def _by_item(items: Sequence[str], values: np.ndarray) -> dict[str, float | None]:
    return {item: number(value) for item, value in zip(items, values, strict=True)}
