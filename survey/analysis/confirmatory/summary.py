"""A `Confirmation` as plain data for --json, and as a page of text for the terminal."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from survey.analysis.confirmatory.confirmation import Confirmation, Parameter
from survey.analysis.confirmatory.fit_indices import Fit
from survey.analysis.plain_data import matrix, number, warnings

__all__ = ["SHOWN", "confirmation_printed", "confirmation_summary"]

SHOWN = 5  # hints, from this χ² on
WORTH = 3.84
NAMES = {
    "ml": "maximum likelihood",
    "fiml": "maximum likelihood, full information",
    "dwls": "DWLS on polychorics",
}


def confirmation_summary(found: Confirmation) -> dict[str, Any]:
    """JSON without NaN. `fit` is the plain χ²'s, `robust` (DWLS alone) the scaled-shifted one's."""
    return {
        "estimator": found.estimator,
        "model": found.model.text,
        "n": found.n,
        "rows": found.rows,
        "items": list(found.items),
        "factors": list(found.model.names),
        "fit": _fit(found.fit),
        "robust": None
        if found.scaled is None
        else _fit(found.scaled) | {"scaling_factor": found.factor, "shift": found.shift},
        "parameters": [_parameter(one) for one in found.parameters],
        "loadings": matrix(found.items, found.model.names, found.loadings),
        "factor_correlations": matrix(found.model.names, found.model.names, found.factors),
        "residual_correlations": matrix(found.items, found.items, found.residual),
        "hints": [
            {
                "left": one.left,
                "op": one.op,
                "right": one.right,
                "chi2_less": one.chi2,
                "would_be": one.value,
            }
            for one in found.hints[: 4 * SHOWN]
        ],
        "warnings": warnings(found.notes),
    }


def _fit(fit: Fit) -> dict[str, Any]:
    return {
        "chi2": fit.chi2,
        "df": fit.df,
        "p": fit.p,
        "cfi": fit.cfi,
        "tli": fit.tli,
        "rmsea": {
            "estimate": fit.rmsea, "level": 0.9, "low": fit.rmsea_low, "high": fit.rmsea_high, "p_close": fit.close,
        },
        "srmr": fit.srmr,
        "baseline": {"chi2": fit.base.chi2, "df": fit.base.df},
    }  # fmt: skip


def _parameter(one: Parameter) -> dict[str, Any]:
    told: dict[str, Any] = {
        "left": one.left,
        "op": one.op,
        "right": one.right,
        "estimate": one.estimate,
        "se": number(one.error),
        "z": number(one.z),
        "p": number(one.p),
    }
    made = one.standard
    if made is None:
        return told | {"standardised": None}
    parts = {"estimate": made.estimate, "se": made.error, "low": made.low, "high": made.high}
    return told | {"standardised": {key: number(value) for key, value in parts.items()}}


def confirmation_printed(found: Confirmation) -> str:
    """Model, fit, loadings, factors, largest residuals, hints and notes."""
    parts = (_head, _fits, _loadings, _factors, _residuals, _hints, _notes)
    texts = ("\n".join(part(found)) for part in parts)
    return "\n\n".join(text for text in texts if text)


def _head(found: Confirmation) -> Iterator[str]:
    yield f"{NAMES[found.estimator]}: {found.n} answers, {len(found.items)} items"
    yield from (f"  {line}" for line in found.model.text.split("; "))


def _fits(found: Confirmation) -> Iterator[str]:
    yield from _one_fit("", found.fit)
    if found.scaled is not None:
        yield from _one_fit("robust (scaled, shifted): ", found.scaled)
    yield "usually called good: CFI and TLI ≥ .95, RMSEA ≤ .06, SRMR ≤ .08 (Hu and Bentler 1999); rules of thumb"


def _one_fit(what: str, fit: Fit) -> Iterator[str]:
    p = "" if fit.p is None else f", p = {fit.p:.3g}"
    yield f"{what}χ² = {fit.chi2:.3f}, df = {fit.df}{p}"
    yield (
        f"  CFI {fit.cfi:.3f}  TLI {fit.tli:.3f}  RMSEA {fit.rmsea:.3f} [{fit.rmsea_low:.3f}, {fit.rmsea_high:.3f}]"
        f" (90 %)  SRMR {fit.srmr:.3f}"
    )


def _loadings(found: Confirmation) -> Iterator[str]:
    wide = max(len(f"{one.left} =~ {one.right}") for one in found.parameters) + 2
    yield f"{'':{wide}}{'estimate':>9}{'se':>8}{'z':>8}{'p':>8}{'standard':>10}   95 %"
    for one in found.parameters:
        if one.op != "=~":
            continue
        made = one.standard
        assert made is not None
        tail = "".join(_cell(value, 8) for value in (one.error, one.z, one.p))
        yield (
            f"{f'{one.left} =~ {one.right}':{wide}}{one.estimate:9.3f}{tail}{made.estimate:10.3f}"
            f"{_cell(made.low, 8)}{_cell(made.high, 7)}"
        )


def _cell(value: float, wide: int) -> str:
    return f"{value:{wide}.3f}" if np.isfinite(value) else f"{'–':>{wide}}"


def _factors(found: Confirmation) -> Iterator[str]:
    if len(found.model.names) > 1:
        yield "correlations of the factors"
        for row, name in enumerate(found.model.names[1:], 1):
            yield f"  {name:20}" + "".join(f"{value:8.3f}" for value in found.factors[row, :row])


def _residuals(found: Confirmation) -> Iterator[str]:
    rows, cols = np.tril_indices(len(found.items), -1)
    values = found.residual[rows, cols]
    order = np.argsort(-np.abs(values))[:SHOWN]
    yield "largest residual correlations (observed less implied)"
    yield from (f"  {found.items[cols[at]]} ~~ {found.items[rows[at]]}: {values[at]:.3f}" for at in order)


def _hints(found: Confirmation) -> Iterator[str]:
    worth = [one for one in found.hints if one.chi2 > WORTH][:SHOWN]
    if worth:
        yield "what χ² would lose by one more parameter (a hint: each is a new model, for new answers to confirm)"
        yield from (
            f"  {one.left} {one.op} {one.right}: {one.chi2:.2f}, about {one.value:.3f}" for one in worth
        )


def _notes(found: Confirmation) -> Iterator[str]:
    for note in found.notes:
        items = f"{', '.join(note.items)}: " if note.items else ""
        yield f"note ({note.code}): {items}{note.message}"
