"""A summary as a page of text for the terminal."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from survey.analysis.correlation import stars

__all__ = ["printed"]


def printed(found: dict[str, Any]) -> str:
    """The tables of the paper in their order; what was not computed is missing, the notes say why."""
    parts = (_means, _correlations, _adequacy, _variance, _loadings, _alpha, _notes)
    return "\n\n".join(text for part in parts if (text := "\n".join(part(found))))


def _width(names: list[str]) -> int:
    return max(map(len, names)) + 2


def _means(found: dict[str, Any]) -> Iterator[str]:
    wide = _width(found["items"])
    yield f"{found['n']} complete answers, {len(found['items'])} items"
    yield f"{'':{wide}}{'n':>6}{'mean':>8}{'sd':>8}"
    for item in found["items"]:
        yield f"{item:{wide}}{found['answered'][item]:6d}{found['mean'][item]:8.3f}{found['sd'][item]:8.3f}"


def _correlations(found: dict[str, Any]) -> Iterator[str]:
    if not (r := found["correlation"]):
        return
    wide = _width(r["rows"])
    yield "Pearson correlation, two-tailed (** p < .01, * p < .05)"
    yield " " * wide + "".join(f"{number + 1:>8}" for number in range(len(r["rows"])))
    for row, item in enumerate(r["rows"]):
        cells = (
            f"{r['values'][row][col]:.3f}{stars(found['p']['values'][row][col]):2}" for col in range(row)
        )
        yield f"{item:{wide}}" + "".join(f"{cell:>8}" for cell in cells) + f"{'1':>6}"


def _adequacy(found: dict[str, Any]) -> Iterator[str]:
    if (test := found["bartlett"]) is not None:
        yield f"KMO {found['kmo']:.3f}"
        yield f"Bartlett χ² = {test['chi2']:.2f}, df = {test['df']}, p = {test['p']:.3g}"


def _variance(found: dict[str, Any]) -> Iterator[str]:
    if not found["variance"]:
        return
    yield "Total variance    initial: total       %   cum. %     rotated: total       %   cum. %"
    rotated = found["variance"]["rotated"]
    for number, row in enumerate(found["variance"]["initial"]):
        line = f"{number + 1:4d}{row['total']:26.3f}{row['percent']:8.2f}{row['cumulative']:9.2f}"
        if number < len(rotated):
            row = rotated[number]
            line += f"{row['total']:19.3f}{row['percent']:8.2f}{row['cumulative']:9.2f}"
        yield line


def _loadings(found: dict[str, Any]) -> Iterator[str]:
    if not (table := found["loadings"]):
        return
    wide = _width(table["rows"])
    yield f"Loadings, {found['rotation']}"
    for item, row in zip(table["rows"], table["values"], strict=True):
        yield f"{item:{wide}}" + "".join(f"{value:8.3f}" for value in row)


def _alpha(found: dict[str, Any]) -> Iterator[str]:
    if found["alpha"] is not None:
        yield f"Cronbach's α {found['alpha']:.3f}"


def _notes(found: dict[str, Any]) -> Iterator[str]:
    for note in found["warnings"]:
        items = f" [{', '.join(note['items'])}]" if note["items"] else ""
        yield f"note {note['code']}{items}: {note['message']}"
