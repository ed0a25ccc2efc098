"""A summary as a page of text for the terminal."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from survey.analysis.correlation import stars

__all__ = ["printed"]


def printed(found: dict[str, Any], means: list[dict[str, Any]]) -> str:
    """The tables of the paper in their order, from `summary` and `descriptives`; the notes say what is missing."""
    parts = (_correlations, _adequacy, _variance, _retention, _loadings, _reliability, _notes)
    texts = ["\n".join(_means(found, means)), *("\n".join(part(found)) for part in parts)]
    return "\n\n".join(text for text in texts if text)


def _width(names: list[str]) -> int:
    return max(map(len, names)) + 2


def _means(found: dict[str, Any], means: list[dict[str, Any]]) -> Iterator[str]:
    wide = _width(found["items"])
    intervals = (found["bootstrap"] or {}).get("means", {})
    yield f"{found['n']} complete answers, {len(found['items'])} items"
    yield f"{'':{wide}}{'n':>6}{'mean':>8}{'sd':>8}" + ("    95 % bootstrap" if intervals else "")
    for row in means:
        line = f"{row['item']:{wide}}{row['answered']:6d}{_cell(row['mean'])}{_cell(row['sd'])}"
        if row["item"] in intervals:
            line += "".join(_cell(intervals[row["item"]][side]) for side in ("low", "high"))
        yield line


def _cell(value: float | None, wide: int = 8) -> str:
    return f"{'–':>{wide}}" if value is None else f"{value:{wide}.3f}"


def _correlations(found: dict[str, Any]) -> Iterator[str]:
    if not (r := found["correlation"]):
        return
    wide = _width(r["rows"])
    yield "Pearson correlation, two-tailed (** p < .01, * p < .05)"
    yield " " * wide + "".join(f"{number + 1:>8}" for number in range(len(r["rows"])))
    for row, item in enumerate(r["rows"]):
        cells = (_starred(r["values"][row][col], found["p"]["values"][row][col]) for col in range(row))
        yield f"{item:{wide}}" + "".join(f"{cell:>8}" for cell in cells) + f"{'1':>6}"


def _starred(r: float | None, p: float | None) -> str:
    return "–  " if r is None or p is None else f"{r:.3f}{stars(p):2}"


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
    turn = found["rotation"]
    normalised = ", Kaiser normalisation" if turn["normalisation"] else ""
    yield f"Loadings, rotation {turn['method']}{normalised}"
    for item, row in zip(table["rows"], table["values"], strict=True):
        yield f"{item:{wide}}" + "".join(f"{value:8.3f}" for value in row)
    if turn["method"] == "oblimin":
        yield "Correlations of the components"
        for name, row in zip(turn["correlation"]["rows"], turn["correlation"]["values"], strict=True):
            yield f"{name:{wide}}" + "".join(f"{value:8.3f}" for value in row)


def _retention(found: dict[str, Any]) -> Iterator[str]:
    if found["eigenvalues"] is None:
        return
    kaiser = sum(value > 1.0 + 1e-12 for value in found["eigenvalues"])
    counts = [f"Kaiser {kaiser}"]
    if (parallel := found["parallel"]) is not None:
        counts.append(
            f"parallel analysis {parallel['keep']} (as factors {_or_dash(parallel['factors']['keep'])})"
        )
    if (average := found["map"]) is not None:
        counts.append(f"MAP {average['keep']} (fourth powers {average['keep_fourth']})")
    yield "Components to keep: " + ", ".join(counts)


def _or_dash(value: int | None) -> str:
    return "–" if value is None else str(value)


def _reliability(found: dict[str, Any]) -> Iterator[str]:
    if found["alpha"] is None:
        return
    interval = (found["bootstrap"] or {}).get("alpha")
    text = f"Cronbach's α {found['alpha']:.3f}"
    if interval:
        text += f" (95 % bootstrap {interval['low']:.3f} to {interval['high']:.3f})"
    yield text + (f", McDonald's ω {found['omega']:.3f}" if found["omega"] is not None else "")
    wide = _width([*found["item_total"], *(name for scale in found["scales"] for name in _named(scale))])
    yield f"{'':{wide}}{'α':>8}{'ω':>8}{'r item-total':>14}{'α without':>11}"
    yield from _items("all items", found, wide)
    for scale in found["scales"]:
        yield from _items(_named(scale)[0], scale, wide)


def _named(scale: dict[str, Any]) -> list[str]:
    return [scale["key"] if scale["kind"] == "component" else f"{scale['kind']} {scale['key']}"]


def _items(title: str, scale: dict[str, Any], wide: int) -> Iterator[str]:
    yield f"{title:{wide}}{_cell(scale['alpha'])}{_cell(scale['omega'])}"
    for item, r in (scale["item_total"] or {}).items():
        without = (scale["alpha_if_deleted"] or {}).get(item)
        yield f"  {item:{wide - 2}}{'':16}{_cell(r, 14)}{_cell(without, 11)}"


def _notes(found: dict[str, Any]) -> Iterator[str]:
    for note in found["warnings"]:
        items = f" [{', '.join(note['items'])}]" if note["items"] else ""
        yield f"note {note['code']}{items}: {note['message']}"
