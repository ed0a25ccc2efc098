"""The paper's procedure in its order, and what it lacks, from a table of scores to one `Analysis`."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from survey.analysis.components import Adequacy, Average, Bootstrap, Components, Parallel, bootstrap
from survey.analysis.consistency import Omega, Reliability
from survey.analysis.correlation import Correlation
from survey.analysis.procedure.factoring import (
    Factored,
    Settings,
    correlation_of,
    covariance_of,
    factor,
    step,
)
from survey.analysis.procedure.scales import Group, Scale, grouped, running_against, scales_of
from survey.analysis.screening import (
    Flags,
    Note,
    Prepared,
    Turned,
    asking,
    flagged,
    left_out,
    likely_gaps,
    named,
    off_scale,
    prepare,
    turned,
)

__all__ = ["Analysis", "Context", "analyse"]

PAIR_R, PAIR_P = 0.93, 0.01  # the paper's second pair stands at exactly .930, so r ≥ .93 at three decimals
SMALL = 50


@dataclass(frozen=True)
class Context:
    """What is known of scores (n, p) beside them.

    seconds: (n,) spent on each answer, NaN unknown. points: of the scale 1, 2, …; a score beside it becomes a note;
    None: any number is a score. unasked: item → in how many answers it was not asked, that the analysis may tell of it.
    groups: items that the questionnaire states to belong together. aside: column of the table → why it is no item.
    """

    seconds: ArrayLike | None = None
    points: int | None = None
    unasked: Mapping[str, int] = field(default_factory=dict)
    groups: Sequence[Group] = ()
    aside: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Analysis:
    """Everything that was computed; a part that could not be is None, and a note says why.

    mean, sd, answered: (p,) over all items, from every score that is there. correlation: (p, p) over all items, NaN
    in the rows of one that does not vary. The rest over the items `factored`, from n answers; eigenvalues: (p,)
    largest first, also where no component can be kept. table: (n, p) as given, but for the scores that are `turned`.
    scales: of the components kept, then of the groups that the questionnaire states.
    """

    n: int
    items: tuple[str, ...]
    dropped: tuple[str, ...]
    mean: NDArray[np.float64]
    sd: NDArray[np.float64]
    answered: NDArray[np.int64]
    correlation: Correlation | None
    factored: tuple[str, ...]
    eigenvalues: NDArray[np.float64] | None
    adequacy: Adequacy | None
    components: Components | None
    reliability: Reliability | None
    omega: Omega | None
    parallel: Parallel | None
    average: Average | None
    bootstrap: Bootstrap | None
    flags: Flags
    notes: tuple[Note, ...]
    settings: Settings
    table: NDArray[np.float64]
    turned: Turned
    scales: tuple[Scale, ...]


def analyse(
    scores: ArrayLike,
    items: Sequence[str] | None = None,
    *,
    settings: Settings | None = None,
    context: Context | None = None,
    drop: Sequence[str] = (),
    progress: Callable[[int], object] | None = None,
) -> Analysis:
    """Run the whole procedure on scores (n, p); NaN is a missing score.

    settings: how; drop: shorthand for settings.drop. context: what is known beside the scores. progress: called with
    the number of resamples just done.
    Raises NotFinite for infinite scores or an item without any, TooFewRows below two usable answers, AllEqual when
    nothing varies, UnknownItem in `drop` or `reverse`. What stops a single step only (a constant item,
    dependent items, n ≤ p) becomes a note and leaves that step None.
    """
    chosen, known = settings or Settings(drop=tuple(drop)), context or Context()
    ready, notes = prepare(scores, items, chosen.drop, pairwise=chosen.missing != "listwise")
    if chosen.missing == "fiml":
        ready, notes = replace(ready, likely=True), [likely_gaps(note) for note in notes]
    if known.points is not None:
        notes = off_scale(ready.table, ready.names, known.points) + notes
    notes = left_out(known.aside) + asking(known.unasked, ready.names, len(ready.table)) + notes
    ready, reversed_items = turned(ready, chosen.reverse, known.points, notes)
    correlation = _all_correlations(ready, chosen, notes)
    part = factor(ready, chosen, notes)
    scales = _scales(ready, part, chosen, known.groups, notes)
    resampled = _resampled(ready, part, chosen, notes, progress)
    _banner(part, resampled, notes)
    flags, more = flagged(ready.table, known.seconds)
    mean, sd, answered = _descriptives(ready.table)
    return Analysis(
        n=part.n, items=ready.names, dropped=ready.dropped, mean=mean, sd=sd, answered=answered,
        correlation=correlation, factored=part.names, eigenvalues=part.eigenvalues, adequacy=part.adequacy,
        components=part.components, reliability=part.reliability, omega=part.omega, parallel=part.parallel,
        average=part.average, bootstrap=resampled, flags=flags, notes=(*notes, *more), settings=chosen,
        table=ready.table, turned=reversed_items, scales=scales,
    )  # fmt: skip


def _descriptives(table: NDArray[np.float64]) -> tuple[NDArray, NDArray, NDArray]:
    there = ~np.isnan(table)
    answered = there.sum(axis=0)
    total = np.where(there, table, 0.0).sum(axis=0)
    mean = np.where(answered > 0, total / np.maximum(answered, 1), np.nan)
    spread = np.where(there, table - mean, 0.0)
    variance = (spread**2).sum(axis=0) / np.maximum(answered - 1, 1)
    return mean, np.where(answered > 1, np.sqrt(variance), np.nan), answered


def _scales(
    ready: Prepared, part: Factored, chosen: Settings, stated: Sequence[Group], notes: list[Note]
) -> tuple[Scale, ...]:
    """Each component's and each stated group's reliability, and a note on items that point the other way."""
    if len(part.names) < 2:
        return ()
    pearson = part.correlation if chosen.method == "pearson" else None
    table = ready.rows_of(ready.factored)
    groups = grouped(part.names, part.components, stated)
    if part.correlation is not None:
        notes += running_against(groups, part.names, part.correlation.r, part.components)
    covariance = step(notes, lambda: covariance_of(table, part.names, pearson, pairwise=ready.pairwise))
    return () if covariance is None else scales_of(groups, part.names, covariance, part.correlation, notes)


def _all_correlations(ready: Prepared, chosen: Settings, notes: list[Note]) -> Correlation | None:
    """Over all items, as Fig. 6 prints them before any is dropped."""
    names = named(ready.names, ready.correlated)
    table = ready.rows_of(ready.correlated)
    found = step(notes, lambda: correlation_of(table, names, chosen.method, ready))
    if found is None:
        return None
    notes += _close_pairs(found, names, ready.dropped)
    if ready.correlated.all():
        return found
    shape = (len(ready.names),) * 2
    r, p, counts = np.full(shape, np.nan), np.full(shape, np.nan), np.zeros(shape, dtype=np.int64)
    where = np.ix_(ready.correlated, ready.correlated)
    r[where], p[where], counts[where] = found.r, found.p, found.counts
    return Correlation(r, p, counts)


def _close_pairs(found: Correlation, names: tuple[str, ...], dropped: tuple[str, ...]) -> list[Note]:
    """Pairs that say nearly the same; a person chooses which of the two to drop, and the note keeps the choice."""
    notes = []
    for i, j in combinations(range(len(names)), 2):
        if round(float(found.r[i, j]), 3) >= PAIR_R and found.p[i, j] < PAIR_P:
            pair = (names[i], names[j])
            gone = [name for name in pair if name in dropped]
            choice = f"{' and '.join(gone)} dropped" if gone else "consider dropping one of the two"
            r = f"{found.r[i, j]:.3f}"
            notes.append(Note("close_pair", pair, f"r = {r}: {choice}", {"r": r}, "dropped" if gone else ""))
    return notes


def _resampled(
    ready: Prepared, part: Factored, chosen: Settings, notes: list[Note], progress
) -> Bootstrap | None:
    if chosen.bootstrap < 1:
        return None
    plain = chosen.method == "pearson" and not ready.pairwise
    if not plain:
        notes.append(
            Note(
                "bootstrap_means",
                (),
                "with pairwise or polychoric correlations only the means are resampled",
                {},
            )
        )
    # A stream of its own, so that the parallel draws do not shift the resamples.
    rng = np.random.default_rng([chosen.seed, 1])
    items = ready.factored if plain else np.zeros_like(ready.factored)
    found = bootstrap(ready.table, items, part.components, rng, draws=chosen.bootstrap, progress=progress)
    if plain and part.components is not None and found.used < 0.9 * found.draws:
        text = (
            f"only {found.used} of {found.draws} resamples vary in every item; the intervals are too narrow"
        )
        notes.append(Note("bootstrap_few", (), text, {"used": found.used, "draws": found.draws}))
    return found


def _banner(part: Factored, resampled: Bootstrap | None, notes: list[Note]) -> None:
    if part.components is None or part.n >= SMALL:
        return
    text = f"with {part.n} answers loadings and the number of components are fragile"
    told: dict[str, object] = {"n": part.n}
    form = ""
    if resampled is not None and resampled.loadings is not None and resampled.kaiser is not None:
        width = np.median(resampled.loadings[1] - resampled.loadings[0]) / 2
        same = 100 * resampled.kaiser[min(part.components.kept, len(resampled.kaiser) - 1)]
        kept = part.components.kept
        told |= {"width": f"{width:.2f}", "kept": kept, "same": f"{same:.0f}"}
        form = "bootstrap"
        text += f": loadings ± {width:.2f} (median of the bootstrap), Kaiser keeps {kept} in {same:.0f} % of resamples"
    notes.insert(0, Note("small_sample", (), text, told, form))
