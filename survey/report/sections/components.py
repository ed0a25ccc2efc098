"""The components: how many each criterion keeps, the variance they explain (Table 2), their loadings (Table 3)."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape

from survey.report import figures
from survey.report.sections.article import Article
from survey.report.tables import MANY

__all__ = ["loadings", "retention", "variance"]


def retention(article: Article) -> Iterator[str]:
    """Nothing without components."""
    found, say = article.found, article.say
    if found.components is None:
        return
    yield article.section("section_retention")
    yield article.set(article.tables["retention"], "narrow")
    chance, boot = found.parallel, found.bootstrap
    caption = say(
        "scree_caption", draws=0 if chance is None else chance.draws,
        quantile=95 if chance is None else f"{100 * chance.level:.0f}",
    )  # fmt: skip
    svg = figures.scree(
        found.components.eigenvalues, None if chance is None else chance.upper,
        None if boot is None else boot.eigenvalues, say, article.name("scree"), caption,
    )  # fmt: skip
    yield article.draw("scree", caption, svg)


def variance(article: Article) -> Iterator[str]:
    """Nothing without components."""
    if article.found.components is not None:
        yield article.section("section_variance")
        yield article.set(article.tables["variance"])


def loadings(article: Article) -> Iterator[str]:
    """The table and the figure, or that no component could be extracted."""
    found, say = article.found.components, article.say
    yield article.section("section_loadings")
    if found is None:
        yield f"<p>{escape(say('no_components'))}</p>"
        return
    yield article.set(article.tables["loadings"], "dense" if found.kept > MANY else "")
    if found.kept > MANY:
        yield f'<p class="small">{escape(" · ".join(article.names))}</p>'
    yield f'<p class="small">{escape(say("naming"))}</p>' if article.asked else ""
    yield article.set(article.tables.get("component-correlations"))
    order, boot = found.sorted_items(), article.found.bootstrap
    interval = None if boot is None or boot.loadings is None else boot.loadings[:, order]
    labels = [say.item(article.found.factored[row]) for row in order]
    caption = say("loadings_figure")
    svg = figures.loadings(
        found.loadings[order], interval, labels, article.names, article.name("loadings"), caption
    )
    yield article.draw("loadings", caption, svg)
