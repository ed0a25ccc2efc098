"""`confirm`: scores and a model in, estimates and fit out; every input that it cannot take is told by name."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from survey.analysis.checks import finite_scores
from survey.analysis.confirmatory.confirmation import (
    Confirmation,
    Parameter,
    parameters_of,
    standardised,
)
from survey.analysis.confirmatory.covariance_structure import Structure
from survey.analysis.confirmatory.maximum_likelihood import Likelihood, likelihood
from survey.analysis.confirmatory.measurement_model import Measurement, require_identified
from survey.analysis.confirmatory.weighted_least_squares import Weighted, weighted
from survey.analysis.errors import GapsLeft, NotFinite, NotIdentified
from survey.analysis.screening import Note, named

__all__ = ["Estimator", "Gaps", "confirm"]

Estimator = Literal["ml", "dwls"]
Gaps = Literal["fiml", "listwise"]
FEW = {"ml": 100, "fiml": 100, "dwls": 200}  # answers below which the estimator's χ² and errors are rough
RARE = 5  # answers in a category below which its threshold is a guess


def confirm(
    scores: ArrayLike,
    items: Sequence[str],
    model: Measurement,
    *,
    estimator: Estimator = "ml",
    missing: Gaps | None = None,
    points: int | None = None,
    progress: Callable[[str], object] | None = None,
) -> Confirmation:
    """Fit a measurement model to scores (n, p), NaN a missing score.

    estimator: "ml" takes the scores as amounts, "dwls" as ordered categories. missing: of answers with gaps to the
    model's items "fiml" takes what they have (ML only), "listwise" leaves them out; None: fiml for ml, listwise for
    dwls. points: of the scale 1, 2, …, to name the categories that nobody chose. progress: called with
    what an estimation by likelihood does next.
    Raises UnknownItem, NotIdentified, NotFinite, TooFewRows, ConstantItem, DependentItems, TooManyScores,
    GapsLeft (fiml with dwls), NotConverged.
    """
    require_identified(model, items)
    table, names = _chosen(scores, items, model)
    if estimator == "dwls" and missing == "fiml":
        raise GapsLeft("fiml is a likelihood of amounts, and dwls has none – take listwise, or estimator ml")
    rows = len(table)
    notes = _told_before(model)
    gaps = np.isnan(table).any(axis=1)
    whole = estimator == "dwls" or missing == "listwise"
    if gaps.any():
        notes.append(_gaps(rows, int(gaps.sum()), int(np.isnan(table).all(axis=1).sum()), whole))
        table = table[~gaps] if whole else table
    if estimator == "dwls":
        return _of_categories(weighted(table, names, model), model, rows, points, notes)
    return _of_amounts(likelihood(table, names, model, progress), model, rows, notes)


def _chosen(scores: ArrayLike, items: Sequence[str], model: Measurement):
    table = np.asarray(scores, dtype=np.float64)
    finite_scores(np.nan_to_num(table, nan=0.0, posinf=0.0, neginf=0.0), items, rows=0)
    table = table[:, [list(items).index(item) for item in model.items]]
    infinite = named(model.items, np.asarray(np.isinf(table).any(axis=0)))
    if infinite:
        raise NotFinite(f"{', '.join(infinite)}: infinite scores – correct them", infinite)
    return table, model.items


def _of_amounts(found: Likelihood, model: Measurement, rows: int, notes: list[Note]) -> Confirmation:
    structure, theta = found.structure, found.theta
    kind = "ml" if found.seen.whole else "fiml"
    parameters = parameters_of(structure, theta, found.variance)
    if kind == "fiml":
        errors = np.sqrt(np.diag(found.mean_variance))
        for item, mean, error in zip(model.items, found.mean, errors, strict=True):
            parameters.append(Parameter(item, "~1", "", float(mean), float(error)))
    _require_told(structure, theta, found.variance)
    observed = found.free.covariance
    spread = np.sqrt(np.diag(observed))
    residual = observed / np.outer(spread, spread) - _correlations(structure, theta)
    notes = _few(found.seen.n, kind, structure) + notes + _improper(structure, theta)
    loads, factors, _ = standardised(structure, theta)
    return Confirmation(
        model=model, estimator=kind, n=found.seen.n, rows=rows, fit=found.fit, parameters=tuple(parameters),
        loadings=loads, factors=factors, residual=residual, hints=found.hints,
        notes=tuple(notes + _freedom(found.fit.df)),
    )  # fmt: skip


def _of_categories(
    found: Weighted, model: Measurement, rows: int, points: int | None, notes: list[Note]
) -> Confirmation:
    structure, theta, seen = found.structure, found.theta, found.seen
    parameters = parameters_of(structure, theta, found.variance)
    for at, item in enumerate(model.items):
        for cut in range(1, len(seen.seen.levels[at])):
            value, error = float(seen.thresholds[at, cut]), float(seen.threshold_error[at, cut])
            parameters.append(Parameter(item, "|", f"t{cut}", value, error))
    _require_told(structure, theta, found.variance)
    notes = _few(seen.n, "dwls", structure) + notes + _categories(found, model, points)
    notes += _improper(structure, theta)
    if np.linalg.eigvalsh(seen.r)[0] <= 0.0:
        text = (
            "the polychoric correlations contradict each other (not positive definite); DWLS goes on without"
        )
        notes.append(Note("indefinite", (), text, {}))
    loads, factors, _ = standardised(structure, theta)
    return Confirmation(
        model=model, estimator="dwls", n=seen.n, rows=rows, fit=found.fit, parameters=tuple(parameters),
        loadings=loads, factors=factors, residual=seen.r - _correlations(structure, theta), hints=found.hints,
        notes=tuple(notes + _freedom(found.fit.df)), scaled=found.scaled, factor=found.factor, shift=found.shift,
    )  # fmt: skip


def _correlations(structure: Structure, theta: NDArray[np.float64]) -> NDArray[np.float64]:
    sigma = structure.implied(theta)
    spread = np.sqrt(np.diag(sigma))
    return sigma / np.outer(spread, spread)


def _require_told(structure: Structure, theta: NDArray[np.float64], variance: NDArray[np.float64]) -> None:
    """Raises NotIdentified where the counts allow the model and the data cannot tell its parameters apart."""
    slopes = structure.slopes(theta)
    if structure.ordinal:
        slopes = slopes * (1.0 - np.eye(len(structure.items)))
    flat = slopes.reshape(structure.size, -1)
    size = np.linalg.norm(flat, axis=1)
    flat = flat / np.where(size > 0.0, size, 1.0)[:, None]
    values = np.linalg.svd(flat, compute_uv=False)
    if values[-1] < 1e-7 * values[0] or not np.isfinite(variance).all():
        raise NotIdentified(
            "the data cannot tell the parameters apart: a factor is hardly correlated with anything beside it"
            " – join factors, or give it three items",
            structure.items,
        )


def _told_before(model: Measurement) -> list[Note]:
    if not model.shared:
        return []
    text = "measures more than one factor (allowed; its loadings are those beside the other factors)"
    return [Note("cross_loading", model.shared, text, {})]


def _gaps(rows: int, some: int, none: int, whole: bool) -> Note:
    if whole:
        text = f"{some} of {rows} answers have gaps and are left out whole (listwise)"
        return Note("missing", (), text, {"all": rows, "left": some})
    text = (
        f"{some} of {rows} answers have gaps; each says what it has (full information), which holds where the gaps"
        f" depend on nothing but what was answered"
    )
    if none:
        text += f"; {none} without any score are left out"
    return Note("missing", (), text, {"some": some, "all": rows, "none": none}, "fiml")


def _few(n: int, kind: str, structure: Structure) -> list[Note]:
    free = structure.size
    least = max(FEW[kind], 5 * free)
    if n >= least:
        return []
    text = f"{n} answers for {free} parameters: χ² and standard errors are rough below about {least}"
    return [Note("few_for_model", (), text, {"n": n, "free": free, "least": least})]


def _freedom(df: int) -> list[Note]:
    if df:
        return []
    return [Note("saturated", (), "no degree of freedom is left: this model fits whatever the answers", {})]


def _improper(structure: Structure, theta: NDArray[np.float64]) -> list[Note]:
    """Variances below 0 and factors that no answers could have."""
    _, spread, own = structure.matrices(theta)
    notes = []
    beyond = named(structure.items, np.diag(own) < 0.0)
    if beyond:
        text = "a residual variance below 0 (Heywood case): too few answers or items, or the wrong model"
        notes.append(Note("heywood", beyond, text, {}, "confirm"))
    if np.linalg.eigvalsh(spread)[0] < -1e-10 * max(np.abs(spread).max(), 1e-300):
        text = "the factors' covariances contradict each other (a correlation beyond 1): join factors"
        notes.append(Note("improper_factors", (), text, {}))
    return notes


def _categories(found: Weighted, model: Measurement, points: int | None) -> list[Note]:
    seen, notes = found.seen.seen, []
    if points is not None:
        short = [len(levels) < points for levels in seen.levels]
        empty = named(model.items, np.array(short))
        if empty:
            text = f"not every category of 1 to {points} was chosen; its thresholds join those beside it"
            notes.append(Note("empty_category", empty, text, {"points": points}))
    often = [np.bincount(column).min() < RARE for column in seen.codes.T]
    rare = named(model.items, np.array(often))
    if rare:
        text = f"a category was chosen by fewer than {RARE}; DWLS leans on it – consider joining categories"
        notes.append(Note("rare_category", rare, text, {"least": RARE}))
    return notes
