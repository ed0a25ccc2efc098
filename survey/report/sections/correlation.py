"""Correlations of all items (the paper's Fig. 6), pairs too close to keep both, their scatter matrix (Fig. 7)."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape

from survey.report import figures
from survey.report.sections.article import Article
from survey.report.tables.csv_text import matrix_csv

__all__ = ["correlation"]

SCATTERED = 5  # items that a scatter matrix shows legibly


def correlation(article: Article) -> Iterator[str]:
    """Nothing where no correlation could be computed."""
    found, say = article.found.correlation, article.say
    if found is None:
        return
    yield article.section("section_correlation")
    caption = say(
        "correlation_caption" if article.found.settings.method == "pearson" else "polychoric_caption"
    )
    labels = [say.item(item) for item in article.found.items]
    yield article.draw(
        "correlation",
        caption,
        figures.correlations(found.r, found.p, labels, article.name("correlation"), caption),
        f"{article.link('correlation', matrix_csv(found.r, labels), ' r')} "
        f"{article.link('probability', matrix_csv(found.p, labels), ' p')}",
    )
    if "pairs" not in article.tables:
        yield f"<p>{escape(say('no_pairs'))}</p>"
        return
    yield article.set(article.tables["pairs"])
    close = [note.items for note in article.found.notes if note.code == "close_pair"]
    chosen = list(dict.fromkeys(item for pair in close for item in pair))[:SCATTERED]
    scores = article.found.table[:, [article.found.items.index(item) for item in chosen]]
    caption = say("scatter_caption")
    labels = [say.item(item) for item in chosen]
    yield article.draw(
        "scatter", caption, figures.scatter_matrix(scores, labels, article.name("scatter"), caption)
    )
