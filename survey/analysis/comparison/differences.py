"""Two groups, item by item: Welch's t with Hedges' g, Mann–Whitney with Cliff's δ, and Holm over the items."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import stats
from scipy.optimize import brentq
from scipy.special import gammaln, ndtri

from survey.analysis.checks import finite_scores
from survey.analysis.errors import GroupTooSmall, NotFinite, UnknownGroup, WrongShape
from survey.analysis.screening import Note, named

__all__ = ["LEAST", "Comparison", "Difference", "Effect", "compare", "holm"]

LEAST = 10  # answers in a group: below, its means tell of persons, and only a huge difference would be found
LEVEL = 0.95


@dataclass(frozen=True)
class Effect:
    """A figure with its 95 % interval."""

    value: float
    low: float
    high: float


@dataclass(frozen=True)
class Difference:
    """One item in both groups; None where a group has fewer than ten answers to it or nothing varies.

    n, mean, sd: of the two groups. half: half of each mean's 95 % interval (Student's t). difference: of the means,
    first less second. g: Hedges' of the pooled deviation. delta: Cliff's δ, the rank-biserial correlation: how much
    oftener a score of the first group exceeds one of the second than the other way round. p_…_holm: over all items.
    """

    item: str
    n: tuple[int, int]
    mean: tuple[float, float] | None = None
    sd: tuple[float, float] | None = None
    half: tuple[float, float] | None = None
    difference: Effect | None = None
    t: float | None = None
    df: float | None = None
    p: float | None = None
    p_holm: float | None = None
    g: Effect | None = None
    u: float | None = None
    p_ranks: float | None = None
    p_ranks_holm: float | None = None
    delta: Effect | None = None


@dataclass(frozen=True)
class Comparison:
    """by: what the groups differ in. groups: their names, n: their answers."""

    by: str
    groups: tuple[str, str]
    n: tuple[int, int]
    items: tuple[Difference, ...]
    notes: tuple[Note, ...]


def compare(
    scores: ArrayLike,
    items: Sequence[str],
    labels: Sequence[str],
    *,
    by: str = "group",
    groups: tuple[str, str] | None = None,
) -> Comparison:
    """Of scores (n, p), NaN missing, and each answer's label (n,), "" where unknown.

    groups: which two, in their order; None: the labels there are, by their alphabet.
    Raises UnknownGroup unless the labels come to two groups, GroupTooSmall for one of fewer than ten answers,
    NotFinite, WrongShape.
    """
    table = np.asarray(scores, dtype=np.float64)
    _, names = finite_scores(np.nan_to_num(table, nan=0.0, posinf=0.0, neginf=0.0), items, rows=0)
    if len(labels) != len(table):
        raise WrongShape(f"{len(labels)} labels for {len(table)} answers – give one each")
    if infinite := named(names, np.asarray(np.isinf(table).any(axis=0))):
        raise NotFinite(f"{', '.join(infinite)}: infinite scores – correct them", infinite)
    chosen = _groups(labels, by, groups)
    parts = [table[np.array([label == group for label in labels])] for group in chosen]
    parts = [part[~np.isnan(part).all(axis=1)] for part in parts]
    for group, part in zip(chosen, parts, strict=True):
        if len(part) < LEAST:
            # The exact number would tell of a small group what the refusal is to keep.
            raise GroupTooSmall(
                f"{by} {group}: fewer than {LEAST} answers – means of so few tell of persons and find only huge"
                " differences; gather more, or join groups",
                (group,),
            )
    found = [_difference(name, *(part[:, at] for part in parts)) for at, name in enumerate(names)]
    return Comparison(
        by, chosen, (len(parts[0]), len(parts[1])), tuple(_adjusted(found)), _notes(found, labels, chosen)
    )


def _groups(labels: Sequence[str], by: str, groups: tuple[str, str] | None) -> tuple[str, str]:
    there = sorted({label for label in labels if label})
    shown = ", ".join(there[:12]) + (" …" if len(there) > 12 else "")
    if groups is None:
        if len(there) != 2:
            raise UnknownGroup(
                f"{by}: {len(there)} groups ({shown or 'none'}), two are compared – name two: --groups A,B"
            )
        return there[0], there[1]
    missing = [group for group in groups if group not in there]
    if missing or groups[0] == groups[1]:
        told = f"no {missing[0]!r} among {shown or 'no labels'}" if missing else "the two groups are the same"
        raise UnknownGroup(f"{by}: {told} – name two of them", missing)
    return groups


def _difference(item: str, x: NDArray[np.float64], y: NDArray[np.float64]) -> Difference:
    x, y = x[~np.isnan(x)], y[~np.isnan(y)]
    n = (len(x), len(y))
    if min(n) < LEAST:
        return Difference(item, n)
    mean, sd = (float(x.mean()), float(y.mean())), (float(x.std(ddof=1)), float(y.std(ddof=1)))
    half = tuple(
        float(stats.t.ppf((1 + LEVEL) / 2, count - 1)) * s / count**0.5
        for count, s in zip(n, sd, strict=True)
    )
    told = Difference(item, n, mean, sd, (half[0], half[1]))
    if sd[0] == 0.0 and sd[1] == 0.0:
        return told
    test: Any = stats.ttest_ind(x, y, equal_var=False)
    edge = test.confidence_interval(LEVEL)
    ranks: Any = stats.mannwhitneyu(x, y, method="asymptotic")
    return Difference(
        item, n, mean, sd, (half[0], half[1]),
        difference=Effect(mean[0] - mean[1], float(edge.low), float(edge.high)),
        t=float(test.statistic), df=float(test.df), p=float(test.pvalue), g=_hedges(n, mean, sd),
        u=float(ranks.statistic), p_ranks=float(ranks.pvalue), delta=_cliff(x, y),
    )  # fmt: skip


def _hedges(n: tuple[int, int], mean: tuple[float, float], sd: tuple[float, float]) -> Effect:
    """g = J (m₁ − m₂) / s, J exact; its interval from the noncentral t (Hedges and Olkin 1985)."""
    df = n[0] + n[1] - 2
    pooled = (((n[0] - 1) * sd[0] ** 2 + (n[1] - 1) * sd[1] ** 2) / df) ** 0.5
    root = (1.0 / n[0] + 1.0 / n[1]) ** 0.5
    shrink = float(np.exp(gammaln(df / 2) - gammaln((df - 1) / 2)) / (df / 2) ** 0.5)
    d = (mean[0] - mean[1]) / pooled
    low, high = (_noncentral(d / root, df, level) * root for level in ((1 + LEVEL) / 2, (1 - LEVEL) / 2))
    return Effect(shrink * d, shrink * low, shrink * high)


def _noncentral(t: float, df: int, level: float) -> float:
    """The noncentrality with which t is exceeded with probability 1 − level."""

    def apart(delta: float) -> float:
        return float(stats.nct.cdf(t, df, delta)) - level

    reach = 6.0 + 0.2 * abs(t)
    low, high = t - reach, t + reach
    while apart(low) < 0.0:
        low -= reach
    while apart(high) > 0.0:
        high += reach
    found: Any = brentq(apart, low, high, xtol=1e-10)
    return float(found)


def _cliff(x: NDArray[np.float64], y: NDArray[np.float64]) -> Effect:
    """δ with Cliff's consistent variance and the interval of Feng and Cliff (2004), which stays within ±1."""
    n, m = len(x), len(y)
    above = _dominance(x, y)
    below = -_dominance(y, x)
    delta = float(above.mean())
    order = np.sort(y)
    ties = int((np.searchsorted(order, x, "right") - np.searchsorted(order, x, "left")).sum())
    squares = (n * m - ties) - n * m * delta**2
    variance = (m**2 * ((above - delta) ** 2).sum() + n**2 * ((below - delta) ** 2).sum() - squares) / (
        n * m * (n - 1) * (m - 1)
    )
    variance = max(float(variance), (1.0 - delta**2) / (n * m - 1))
    z = float(ndtri((1 + LEVEL) / 2))
    wide = z * variance**0.5 * ((1.0 - delta**2) ** 2 + z**2 * variance) ** 0.5
    under = 1.0 - delta**2 + z**2 * variance
    if under <= 0.0:  # every score of one group exceeds all of the other
        edge = (min(n, m) - z**2) / (min(n, m) + z**2)
        return Effect(delta, *((edge, 1.0) if delta > 0.0 else (-1.0, -edge)))
    middle = delta - delta**3
    return Effect(delta, max((middle - wide) / under, -1.0), min((middle + wide) / under, 1.0))


def _dominance(x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
    """Of each x the share of y below it less the share above."""
    order = np.sort(y)
    below = np.searchsorted(order, x, side="left")
    above = len(y) - np.searchsorted(order, x, side="right")
    return (below - above) / len(y)


def holm(p: Sequence[float]) -> NDArray[np.float64]:
    """Probabilities (m,) multiplied so that the chance of a single false alarm among all stays (Holm 1979)."""
    values = np.asarray(p, dtype=np.float64)
    order = np.argsort(values)
    steps = np.maximum.accumulate(values[order] * np.arange(len(values), 0, -1))
    out = np.zeros_like(values)
    out[order] = np.minimum(steps, 1.0)
    return out


def _adjusted(found: list[Difference]) -> list[Difference]:
    tested = [one for one in found if one.p is not None and one.p_ranks is not None]
    by_t = holm([one.p for one in tested if one.p is not None])
    by_rank = holm([one.p_ranks for one in tested if one.p_ranks is not None])
    held = {one.item: (float(a), float(b)) for one, a, b in zip(tested, by_t, by_rank, strict=True)}
    return [
        replace(one, p_holm=held[one.item][0], p_ranks_holm=held[one.item][1]) if one.item in held else one
        for one in found
    ]


def _notes(found: list[Difference], labels: Sequence[str], chosen: tuple[str, str]) -> tuple[Note, ...]:
    notes = []
    few = tuple(one.item for one in found if one.mean is None)
    if few:
        text = f"fewer than {LEAST} answers of a group; the item is not compared"
        notes.append(Note("group_too_small", few, text, {"least": LEAST}, "item"))
    still = tuple(one.item for one in found if one.mean is not None and one.t is None)
    if still:
        notes.append(
            Note("constant_item", still, "the same score in both groups; nothing to test", {}, "compare")
        )
    left = sum(label not in chosen for label in labels)
    if left:
        text = f"{left} answers are in neither group and left out"
        notes.append(Note("no_group", (), text, {"left": left}))
    return tuple(notes)
