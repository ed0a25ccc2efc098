"""The report's tables as rows of text, and how the page sets them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from html import escape

from survey.analysis import Analysis
from survey.analysis.components import kaiser_count
from survey.report.words import Words, coefficient, decimal

__all__ = ["MANY", "Table", "as_html", "tables_of"]

SHORT = 4  # characters of a column's head that stay on one line
MANY = 4  # components, beyond which the table has room for their loadings alone


@dataclass(frozen=True)
class Table:
    """key: name of the CSV file. head: column titles; body: rows of cells, the first `left` are set flush left.

    words: further columns that hold words, flush left too. strong: cells (row, column) that are set bold.
    groups: (title, columns) above the head.
    """

    key: str
    caption: str
    head: tuple[str, ...]
    body: tuple[tuple[str, ...], ...]
    left: int = 1
    words: frozenset[int] = frozenset()
    strong: frozenset[tuple[int, int]] = frozenset()
    groups: tuple[tuple[str, int], ...] = ()
    rules: frozenset[int] = field(default_factory=frozenset)


def as_html(table: Table, number: str, link: str, hint: str = "") -> str:
    """A <figure> with its numbered caption above and rules as journals set them. hint: shown where it must scroll."""
    groups = ""
    if table.groups:
        cells = "".join(
            f'<th colspan="{span}"><span>{escape(text)}</span></th>' for text, span in table.groups
        )
        groups = f'<tr class="groups">{cells}</tr>'
    head = "".join(_th(text, at < table.left or at in table.words) for at, text in enumerate(table.head))
    rows = "".join(
        f"<tr{' class=rule' if at in table.rules else ''}>"
        + "".join(_td(table, at, column, text) for column, text in enumerate(row))
        + "</tr>"
        for at, row in enumerate(table.body)
    )
    return (
        f'<figure class="table"><figcaption><b>{escape(number)}</b> {escape(table.caption)} {link}</figcaption>'
        f'<p class="hint" aria-hidden="true">{escape(hint)}</p>'
        f'<div class="scroll"><table><thead>{groups}<tr>{head}</tr></thead><tbody>{rows}</tbody></table></div></figure>'
    )


def _th(text: str, left: bool) -> str:
    # Chinese breaks anywhere, so a short head would stand upright in a narrow column.
    kinds = [*(["left"] if left else []), *(["short"] if len(text) <= SHORT else [])]
    kind = f' class="{" ".join(kinds)}"' if kinds else ""
    return f'<th scope="col"{kind}>{escape(text).replace(" %", "&nbsp;%")}</th>'


def _td(table: Table, row: int, column: int, text: str) -> str:
    kinds = [
        *(["left"] if column < table.left or column in table.words else []),
        *(["strong"] if (row, column) in table.strong else []),
    ]
    kind = f' class="{" ".join(kinds)}"' if kinds else ""
    return f"<td{kind}>{escape(text)}</td>"


def tables_of(analysis: Analysis, say: Words, names: Sequence[str]) -> dict[str, Table]:
    """Every table that the analysis has figures for, by key. names: (k,) of the components."""
    made = [
        _items(analysis, say), _pairs(analysis, say), _adequacy(analysis, say), _retention(analysis, say),
        _variance(analysis, say), _loadings(analysis, say, names), _phi(analysis, say, names),
        _reliability(analysis, say), _notes(analysis, say),
    ]  # fmt: skip
    return {table.key: table for table in made if table is not None and table.body}


def _items(analysis: Analysis, say: Words) -> Table:
    boot = analysis.bootstrap
    head = [say("item"), say("n"), say("mean"), say("sd")]
    rows = []
    for at, item in enumerate(analysis.items):
        row = [
            say.item(item),
            str(analysis.answered[at]),
            decimal(analysis.mean[at], 2),
            decimal(analysis.sd[at], 2),
        ]
        if boot is not None:
            row.append(f"{decimal(boot.means[0, at], 2)} – {decimal(boot.means[1, at], 2)}")
        rows.append(tuple(row))
    if boot is None:
        caption = say("items_caption", level=95, draws=0).split("。")[0].split(", with")[0]
    else:
        head.append(f"{100 * boot.level:.0f} %")
        caption = say("items_caption", level=f"{100 * boot.level:.0f}", draws=boot.draws)
    return Table("items", caption, tuple(head), tuple(rows))


def _pairs(analysis: Analysis, say: Words) -> Table:
    rows = []
    for note in analysis.notes:
        if note.code != "close_pair" or analysis.correlation is None:
            continue
        i, j = (analysis.items.index(item) for item in note.items)
        gone = [say.item(item) for item in note.items if item in analysis.dropped]
        choice = say("choice_dropped", items=" / ".join(gone)) if gone else say("choice_open")
        pair = " ~ ".join(say.item(item) for item in note.items)
        p = analysis.correlation.p[i, j]
        rows.append(
            (
                pair,
                coefficient(analysis.correlation.r[i, j]),
                "< .001" if p < 0.001 else coefficient(p),
                choice,
            )
        )
    head = (say("pair"), "r", "p", say("choice"))
    return Table("pairs", say("pairs_caption"), head, tuple(rows), words=frozenset({3}))


def _adequacy(analysis: Analysis, say: Words) -> Table | None:
    if analysis.adequacy is None:
        return None
    values = zip(analysis.factored, analysis.adequacy.kmo_per_item, strict=True)
    rows = tuple((say.item(item), coefficient(value)) for item, value in values)
    return Table("kmo", say("adequacy_caption"), (say("item"), "KMO"), rows)


def _retention(analysis: Analysis, say: Words) -> Table | None:
    if analysis.components is None:
        return None
    rows = [(say("kaiser"), str(kaiser_count(analysis.components.eigenvalues)))]
    if analysis.parallel is not None:
        rows.append((say("parallel"), str(analysis.parallel.kept)))
        kept = analysis.parallel.factors_kept
        rows.append((say("parallel_factors"), "–" if kept is None else str(kept)))
    if analysis.average is not None:
        rows += [
            (say("map"), str(analysis.average.kept)),
            (say("map_fourth"), str(analysis.average.kept_fourth)),
        ]
    return Table("retention", say("retention_caption"), (say("criterion"), say("keep")), tuple(rows))


def _variance(analysis: Analysis, say: Words) -> Table | None:
    found = analysis.components
    if found is None:
        return None
    p, rows = len(found.eigenvalues), []
    for at, value in enumerate(found.eigenvalues):
        row = [str(at + 1), decimal(value), decimal(100 * value / p, 2)]
        row.append(decimal(100 * found.eigenvalues[: at + 1].sum() / p, 2))
        if at < found.kept:
            square = found.rotated[at]
            row += [
                decimal(square),
                decimal(100 * square / p, 2),
                decimal(100 * found.rotated[: at + 1].sum() / p, 2),
            ]
        rows.append(tuple(row + [""] * (7 - len(row))))
    three = (say("total"), say("percent"), say("cumulative"))
    return Table(
        "variance", say("variance_caption"), (say("component"), *three, *three), tuple(rows),
        groups=(("", 1), (say("initial"), 3), (say("rotated"), 3)), rules=frozenset({found.kept}),
    )  # fmt: skip


def _loadings(analysis: Analysis, say: Words, names: Sequence[str]) -> Table | None:
    found, boot = analysis.components, analysis.bootstrap
    if found is None:
        return None
    rows, strong, rules, last = [], set(), set(), -1
    home = abs(found.loadings).argmax(axis=1)
    for row, item in enumerate(found.sorted_items()):
        cells = [say.item(analysis.factored[item])]
        for column in range(found.kept):
            text = coefficient(found.loadings[item, column])
            if boot is not None and boot.loadings is not None and found.kept <= MANY:
                low, high = boot.loadings[:, item, column]
                text += f" [{coefficient(low, 2)}, {coefficient(high, 2)}]"
            cells.append(text)
        rows.append((*cells, coefficient(found.communalities[item])))
        strong.add((row, 1 + int(home[item])))
        if home[item] != last and row:
            rules.add(row)
        last = home[item]
    # Many names beside each other do not fit; the page lists them beneath.
    titles = names if found.kept <= MANY else [str(at + 1) for at in range(found.kept)]
    head = (say("item"), *titles, say("communality"))
    caption = say("loadings_caption", rotation=say(f"rotation_{found.rotation}"))
    if boot is None or boot.loadings is None or found.kept > MANY:  # the figure has the intervals of many
        caption = caption.split("方括号")[0].split(" In brackets")[0]
    return Table("loadings", caption, head, tuple(rows), strong=frozenset(strong), rules=frozenset(rules))


def _phi(analysis: Analysis, say: Words, names: Sequence[str]) -> Table | None:
    found = analysis.components
    if found is None or found.rotation != "oblimin":
        return None
    rows = tuple(
        (name, *(coefficient(value) for value in row))
        for name, row in zip(names, found.correlation, strict=True)
    )
    return Table("component-correlations", say("phi_caption"), ("", *names), rows)


def _reliability(analysis: Analysis, say: Words) -> Table | None:
    found = analysis.reliability
    if found is None or found.if_deleted is None:
        return None
    figures = zip(analysis.factored, found.item_total, found.if_deleted, strict=True)
    rows = tuple((say.item(item), coefficient(r), coefficient(value)) for item, r, value in figures)
    head = (say("item"), say("item_total"), say("without"))
    return Table("alpha", say("reliability_caption"), head, rows)


def _notes(analysis: Analysis, say: Words) -> Table:
    rows = tuple((note.code, say.items(note.items) or "–", say.note(note)) for note in analysis.notes)
    return Table(
        "notes", say("section_flags"), (say("note"), say("concerning"), say("message")), rows, left=3
    )
