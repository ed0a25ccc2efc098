"""Reliability of the whole and of each scale: α, ω, item-total correlations, α without each item."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape

from survey.analysis import Scale
from survey.report.sections.article import Article
from survey.report.tables import Table
from survey.report.words import coefficient

__all__ = ["reliability"]


def reliability(article: Article) -> Iterator[str]:
    """The whole in a sentence, a table of the scales, a table of their items. Nothing without any of these."""
    found, boot, say = article.found.reliability, article.found.bootstrap, article.say
    if found is None and not article.found.scales:
        return
    yield article.section("section_reliability")
    if found is not None:
        interval = ""
        if boot is not None and boot.alpha is not None:
            interval = f" [{coefficient(boot.alpha[0])}, {coefficient(boot.alpha[1])}]"
        omega = "–" if article.found.omega is None else coefficient(article.found.omega.omega)
        text = say("reliability_text", alpha=coefficient(found.alpha), interval=interval, omega=omega)
        yield f"<p>{escape(text)}</p>"
    if article.found.scales:
        yield f"<p>{escape(say('scales_text'))}</p>"
        yield article.set(_scales(article))
        yield article.set(_items(article))
    yield article.set(article.tables.get("alpha"), "narrow")


def _scales(article: Article) -> Table:
    rows = []
    for scale in article.found.scales:
        alpha = scale.reliability
        figures = (None, None) if alpha is None else (alpha.alpha, alpha.standardised)
        omega = None if scale.omega is None else scale.omega.omega
        shown = [*figures, omega]
        rows.append((_title(article, scale), str(len(scale.items)), str(scale.n), *map(coefficient, shown)))
    say = article.say
    kinds = [scale.kind for scale in article.found.scales]
    rules = frozenset(at for at in range(1, len(kinds)) if kinds[at] != kinds[at - 1])
    head = (say("scale"), say("item_count"), "n", "α", say("alpha_standardised"), "ω")
    return Table("scales", say("scales_caption"), head, tuple(rows), rules=rules)


def _items(article: Article) -> Table | None:
    """Each scale's items; a module that holds just what a component does is not written twice."""
    say, rows, rules = article.say, [], set()
    written: set[frozenset[str]] = set()
    for scale in article.found.scales:
        alpha = scale.reliability
        if alpha is None or frozenset(scale.items) in written:
            continue
        written.add(frozenset(scale.items))
        rules.add(len(rows))
        for at, item in enumerate(scale.items):
            without = None if alpha.if_deleted is None else alpha.if_deleted[at]
            title = _title(article, scale) if not at else ""
            rows.append((title, say.item(item), coefficient(alpha.item_total[at]), coefficient(without)))
    if not rows:
        return None
    head = (say("scale"), say("item"), say("item_total"), say("without"))
    return Table(
        "scale-items", say("scale_items_caption"), head, tuple(rows), left=2, rules=frozenset(rules - {0})
    )


def _title(article: Article, scale: Scale) -> str:
    if scale.kind == "component":
        number = int(scale.key.removeprefix("component_"))
        name = article.names[number - 1]
        return (
            article.say("scale_component", name=name) if name[0].isdecimal() else name
        )  # else it says so itself
    label = article.say.module if scale.kind == "module" else article.say.dimension
    return article.say(f"scale_{scale.kind}", name=label(scale.key))
