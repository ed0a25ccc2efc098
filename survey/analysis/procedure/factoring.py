"""The steps over the items that are kept: adequacy, components, retention, reliability."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, TypeVar

import numpy as np
from numpy.typing import NDArray

from survey.analysis.components import (
    Adequacy,
    Average,
    Components,
    Parallel,
    Rotation,
    adequacy,
    adequacy_of,
    eigenvalues,
    kaiser_count,
    minimum_average_partial,
    parallel_analysis,
    principal_components,
)
from survey.analysis.consistency import HEYWOOD, Omega, Reliability, omega_of, reliability, reliability_of
from survey.analysis.correlation import (
    Correlation,
    correlate,
    correlate_likely,
    correlate_pairwise,
    covariance_pairwise,
    polychoric,
)
from survey.analysis.errors import AnalysisError, GapsLeft, NoComponents
from survey.analysis.screening import Note, Prepared, named

__all__ = ["Factored", "Method", "Missing", "Settings", "correlation_of", "covariance_of", "factor", "step"]

Method = Literal["pearson", "polychoric"]
Factors = int | Literal["kaiser", "parallel"]
Missing = Literal["listwise", "pairwise", "fiml"]
Part = TypeVar("Part")


@dataclass(frozen=True)
class Settings:
    """How to analyse. factors: a number, "kaiser" or "parallel"; bootstrap, draws: 0 leaves that step out.

    reverse: items whose scores are turned to low + high − score before everything else.
    """

    drop: tuple[str, ...] = ()
    factors: Factors = "kaiser"
    rotation: Rotation = "varimax"
    missing: Missing = "listwise"
    method: Method = "pearson"
    bootstrap: int = 0
    draws: int = 1000
    seed: int = 0
    reverse: tuple[str, ...] = ()


@dataclass(frozen=True)
class Factored:
    """What could be computed over the items `names` from n answers; None where a note says why not."""

    n: int
    names: tuple[str, ...]
    eigenvalues: NDArray[np.float64] | None = None
    adequacy: Adequacy | None = None
    components: Components | None = None
    reliability: Reliability | None = None
    omega: Omega | None = None
    parallel: Parallel | None = None
    average: Average | None = None
    correlation: Correlation | None = None


def factor(ready: Prepared, chosen: Settings, notes: list[Note]) -> Factored:
    """All steps over the factored items, a note for each that fails."""
    method, draws = chosen.method, chosen.draws
    names, table = named(ready.names, ready.factored), ready.rows_of(ready.factored)
    n, p = table.shape
    if p < 2:
        notes.append(Note("too_few_items", names, "fewer than two items are left; nothing to factor", {}))
        return Factored(n, names)
    found = step(notes, lambda: correlation_of(table, names, method, ready))
    if found is not None:
        n = found.n
    pearson = found if method == "pearson" else None
    alpha = step(notes, lambda: _alpha(table, names, pearson, ready.pairwise))
    if n <= p:
        text = f"{n} answers for {p} items: no KMO, Bartlett or components"
        notes.append(Note("too_few_rows", (), text, {"n": n, "p": p}))
    if found is None or n <= p:
        return Factored(n, names, reliability=alpha, correlation=found)
    if n == p + 1:
        text = f"{n} answers for {p} items: KMO, Bartlett and the components mean next to nothing here"
        notes.append(Note("barely_enough_rows", (), text, {"n": n, "p": p}))
    plain = method == "pearson" and not ready.pairwise
    fit = step(notes, lambda: adequacy(table, names) if plain else adequacy_of(found.r, n, names))
    rng = np.random.default_rng(chosen.seed)
    parallel = step(notes, lambda: parallel_analysis(found.r, n, rng, draws=draws)) if draws else None
    components = step(notes, lambda: _components(found, names, chosen, parallel, notes))
    omega = step(notes, lambda: omega_of(found.r, np.nanstd(table, axis=0, ddof=1), n, names))
    if omega is not None and (omega.uniqueness < HEYWOOD + 1e-9).any():
        over = named(names, omega.uniqueness < HEYWOOD + 1e-9)
        notes.append(
            Note(
                "heywood",
                over,
                "the common factor behind ω leaves nothing of the item (Heywood case)",
                {},
                "omega",
            )
        )
    average = minimum_average_partial(found.r)
    _disagreement(found, parallel, average, notes)
    return Factored(
        n, names, eigenvalues=eigenvalues(found.r), adequacy=fit, components=components, reliability=alpha, omega=omega,
        parallel=parallel, average=average, correlation=found,
    )  # fmt: skip


def _alpha(
    table: NDArray[np.float64], names: tuple[str, ...], pearson: Correlation | None, pairwise: bool
) -> Reliability:
    if not pairwise:
        return reliability(table, names)
    return reliability_of(covariance_of(table, names, pearson, pairwise=True), names)


def covariance_of(
    table: NDArray[np.float64], names: tuple[str, ...], pearson: Correlation | None, *, pairwise: bool
) -> NDArray[np.float64]:
    """(p, p) of the raw scores, whatever correlation is factored. pearson: theirs, where it is known already."""
    if not pairwise:
        return np.atleast_2d(np.cov(table, rowvar=False))
    own = correlate_pairwise(table, names) if pearson is None else pearson
    return covariance_pairwise(table, own)


def _components(
    found: Correlation,
    names: tuple[str, ...],
    chosen: Settings,
    parallel: Parallel | None,
    notes: list[Note],
) -> Components:
    keep = chosen.factors if isinstance(chosen.factors, int) else None
    if chosen.factors == "parallel":
        if parallel is None or parallel.kept < 1:
            raise NoComponents("parallel analysis keeps no component – give a number of factors, or kaiser")
        keep = parallel.kept
    components = principal_components(found.r, keep=keep, rotation=chosen.rotation)
    if components.kept < len(names) and (components.communalities >= 1.0 - 1e-9).any():
        over = named(names, components.communalities >= 1.0 - 1e-9)
        notes.append(
            Note("heywood", over, "a communality of 1: the components leave nothing of the item", {})
        )
    return components


def _disagreement(found: Correlation, parallel: Parallel | None, average: Average, notes: list[Note]) -> None:
    kaiser = kaiser_count(eigenvalues(found.r))
    counts = {"Kaiser": kaiser, "MAP": average.kept}
    if parallel is not None:
        counts["parallel analysis"] = parallel.kept
    if len(set(counts.values())) > 1:
        told = ", ".join(f"{name} {count}" for name, count in counts.items())
        text = f"the criteria keep different numbers of components: {told}"
        form = "parallel" if parallel is not None else ""
        values = {"kaiser": kaiser, "map": average.kept, "parallel": counts.get("parallel analysis")}
        notes.append(Note("retention", (), text, values, form))


def correlation_of(
    table: NDArray[np.float64], names: tuple[str, ...], method: Method, ready: Prepared
) -> Correlation:
    """The matrix of the chosen kind, of scores (n, p); ready: how gaps are to be taken."""
    if method == "polychoric":
        if np.isnan(table).any():
            raise GapsLeft(
                "polychoric correlations need whole answers – leave out those with gaps (listwise)"
            )
        return polychoric(table, names)
    if ready.likely:
        return correlate_likely(table, names)
    return correlate_pairwise(table, names) if ready.pairwise else correlate(table, names)


def step(notes: list[Note], compute: Callable[[], Part]) -> Part | None:
    """The result of one step, or None and a note that says why there is none."""
    try:
        return compute()
    except AnalysisError as error:
        note = Note(error.code, error.items, str(error))
        if note not in notes:
            notes.append(note)
        return None
