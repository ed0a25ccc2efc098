"""The report's chapter on a confirmatory analysis: fit, loadings with their intervals, factors, what fits least."""

from __future__ import annotations

from functools import partial

import numpy as np

from survey.analysis.confirmatory import Confirmation, Fit, Parameter
from survey.report.chapters.chapter import Chapter, Drawing
from survey.report.figures import intervals
from survey.report.tables import Table
from survey.report.words import Words, coefficient, decimal, probability, whole

__all__ = ["confirmation_chapter"]

SHOWN = 5
WORTH = 3.84  # χ² of one degree of freedom at p = .05


def confirmation_chapter(found: Confirmation, say: Words) -> Chapter:
    """In one language."""
    judged = found.judged
    opening = say(
        "confirm_text", way=say(f"way_{found.estimator}"), n=whole(found.n), factors=len(found.model.names),
        items=len(found.items),
    )  # fmt: skip
    verdict = say(
        "confirm_fit", chi2=decimal(judged.chi2, 2), df=judged.df, cfi=coefficient(judged.cfi),
        rmsea=coefficient(judged.rmsea), srmr=coefficient(judged.srmr),
        p="–" if judged.p is None else probability(judged.p),
    )  # fmt: skip
    notes = map(say.remark, found.notes)
    tables = (_loadings(found, say), _factors(found, say), _residuals(found, say), _hints(found, say))
    return Chapter(
        "section_confirm",
        (opening, verdict, *notes, _fit(found, say), _drawing(found, say), *filter(None, tables), say("confirm_rules")),
    )  # fmt: skip


def _fit(found: Confirmation, say: Words) -> Table:
    rows = [(say("confirm_plain"), *_figures(found.fit))]
    if found.scaled is not None:
        rows.append((say("confirm_robust"), *_figures(found.scaled)))
    rows.append(
        (
            say("confirm_base"),
            decimal(found.fit.base.chi2, 3),
            str(found.fit.base.df),
            *["–"] * 5,
        )
    )
    head = ("", "χ²", "df", "p", "CFI", "TLI", "RMSEA [90 %]", "SRMR")
    return Table("confirm-fit", say("confirm_fit_caption"), head, tuple(rows))


def _figures(fit: Fit) -> tuple[str, ...]:
    p = "–" if fit.p is None else probability(fit.p).removeprefix("= ")
    rmsea = f"{coefficient(fit.rmsea)} [{coefficient(fit.rmsea_low)}, {coefficient(fit.rmsea_high)}]"
    return (
        decimal(fit.chi2, 3),
        str(fit.df),
        p,
        coefficient(fit.cfi),
        coefficient(fit.tli),
        rmsea,
        coefficient(fit.srmr),
    )


def _of(found: Confirmation, op: str) -> list[Parameter]:
    return [one for one in found.parameters if one.op == op]


def _drawing(found: Confirmation, say: Words) -> Drawing:
    lines = _of(found, "=~")
    values = np.array([_edges(one) for one in lines], dtype=np.float64)
    caption = say("confirm_figure")
    draw = partial(
        _drawn,
        values,
        [say.item(one.right) for one in lines],
        [say.module(one.left) for one in lines],
        caption,
    )
    return Drawing("confirm-loadings", caption, draw)


def _drawn(values, labels: list[str], groups: list[str], caption: str, name: str) -> str:
    return intervals(values, labels, groups, (0.0, 1.0), name, caption)


def _edges(one: Parameter) -> tuple[float, float, float]:
    assert one.standard is not None
    return one.standard.estimate, one.standard.low, one.standard.high


def _interval(one: Parameter) -> str:
    value, low, high = _edges(one)
    return f"{coefficient(value)} [{coefficient(low)}, {coefficient(high)}]"


def _loadings(found: Confirmation, say: Words) -> Table:
    rows, rules, last = [], set(), ""
    for at, one in enumerate(_of(found, "=~")):
        if last and one.left != last:
            rules.add(at)
        error = "–" if not np.isfinite(one.error) else decimal(one.error)
        p = "–" if not np.isfinite(one.p) else probability(one.p).removeprefix("= ")
        name = say.module(one.left) if one.left != last else ""
        rows.append((name, say.item(one.right), decimal(one.estimate), error, p, _interval(one)))
        last = one.left
    head = (say("factor"), say("item"), say("estimate"), say("se"), "p", f"{say('standardised')} [95 %]")
    return Table(
        "confirm-loadings", say("confirm_loadings_caption"), head, tuple(rows), left=2, rules=frozenset(rules)
    )


def _factors(found: Confirmation, say: Words) -> Table | None:
    names = set(found.model.names)
    pairs = [one for one in _of(found, "~~") if {one.left, one.right} <= names and one.left != one.right]
    if not pairs:
        return None
    rows = tuple((say.module(one.left), say.module(one.right), _interval(one)) for one in pairs)
    head = (say("factor"), say("factor"), "r [95 %]")
    return Table("confirm-factors", say("confirm_factors_caption"), head, rows, left=2)


def _residuals(found: Confirmation, say: Words) -> Table:
    rows, cols = np.tril_indices(len(found.items), -1)
    values = found.residual[rows, cols]
    order = np.argsort(-np.abs(values))[:SHOWN]
    body = tuple(
        (say.item(found.items[cols[at]]), say.item(found.items[rows[at]]), coefficient(float(values[at])))
        for at in order
    )
    head = (say("item"), say("item"), say("residual"))
    return Table("confirm-residuals", say("confirm_residuals_caption"), head, body, left=2)


def _hints(found: Confirmation, say: Words) -> Table | None:
    worth = [one for one in found.hints if one.chi2 > WORTH][:SHOWN]
    if not worth:
        return None
    names = set(found.model.names)
    body = tuple(
        (
            f"{say.module(one.left) if one.left in names else say.item(one.left)} {one.op} {say.item(one.right)}",
            decimal(one.chi2, 2),
            decimal(one.value),
        )
        for one in worth
    )
    head = (say("hint"), "Δχ²", say("would_be"))
    return Table("confirm-hints", say("confirm_hints_caption"), head, body)
