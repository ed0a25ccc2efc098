"""A `Comparison` as plain data for --json, and as a page of text for the terminal."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from survey.analysis.comparison.differences import Comparison, Difference, Effect
from survey.analysis.plain_data import warnings

__all__ = ["comparison_printed", "comparison_summary"]


def comparison_summary(found: Comparison) -> dict[str, Any]:
    """JSON; an item that is not compared holds nulls and stands in `warnings`."""
    return {
        "by": found.by,
        "groups": [{"name": name, "n": n} for name, n in zip(found.groups, found.n, strict=True)],
        "items": [_item(one) for one in found.items],
        "warnings": warnings(found.notes),
    }


def _item(one: Difference) -> dict[str, Any]:
    pairs = {"mean": one.mean, "sd": one.sd, "half": one.half}
    shown = one.mean is not None
    return {
        "item": one.item,
        "n": list(one.n) if shown else None,
        **{key: None if pair is None else list(pair) for key, pair in pairs.items()},
        "difference": _effect(one.difference),
        "welch": _test({"t": one.t, "df": one.df, "p": one.p, "p_holm": one.p_holm}),
        "hedges_g": _effect(one.g),
        "mann_whitney": _test({"u": one.u, "p": one.p_ranks, "p_holm": one.p_ranks_holm}),
        "cliffs_delta": _effect(one.delta),
    }


def _effect(one: Effect | None) -> dict[str, float] | None:
    return None if one is None else {"value": one.value, "low": one.low, "high": one.high}


def _test(figures: dict[str, float | None]) -> dict[str, float | None] | None:
    return None if None in figures.values() else figures


def comparison_printed(found: Comparison) -> str:
    """A line per item and how to read it."""
    return "\n".join(_lines(found))


def _lines(found: Comparison) -> Iterator[str]:
    (first, second), (n, m) = found.groups, found.n
    wide = max(len(one.item) for one in found.items) + 2
    yield f"{found.by}: {first} ({n} answers) against {second} ({m})"
    yield (
        f"{'':{wide}}{'means':>13}{'difference, 95 %':>23}{'p (Holm)':>10}{'g, 95 %':>23}"
        f"{'p ranks':>9}{'δ, 95 %':>23}"
    )
    for one in found.items:
        if one.mean is None:
            yield f"{one.item:{wide}}  too few answers"
            continue
        head = f"{one.item:{wide}}{one.mean[0]:6.2f} {one.mean[1]:6.2f}"
        if one.p_holm is None or one.p_ranks_holm is None:
            yield f"{head}  nothing varies"
            continue
        yield (
            f"{head}{_shown(one.difference)}{one.p_holm:10.4f}{_shown(one.g)}{one.p_ranks_holm:9.4f}"
            f"{_shown(one.delta)}"
        )
    yield "p are Holm's over all items. g: Hedges', difference in standard deviations; .2 small, .5 middling, .8 large."
    yield f"δ: Cliff's, how much oftener a score of {first} exceeds one of {second} than falls below it."
    for note in found.notes:
        items = f" [{', '.join(note.items)}]" if note.items else ""
        yield f"note {note.code}{items}: {note.message}"


def _shown(one: Effect | None) -> str:
    return "" if one is None else f"{one.value:8.2f} [{one.low:5.2f}, {one.high:5.2f}]".rjust(23)
