"""The items: means and spread, correlations (the paper's Fig. 6 and 7), and whether these may be factored."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape

from survey.report import figures
from survey.report.sections.article import Article
from survey.report.tables import matrix_csv
from survey.report.words import coefficient, decimal, probability

__all__ = ["adequacy", "correlation", "items"]


def items(article: Article) -> Iterator[str]:
    """One table."""
    yield article.section("section_items")
    yield article.set(article.tables["items"])


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


def adequacy(article: Article) -> Iterator[str]:
    """The two tests and the KMO of each item, or that they could not be computed."""
    yield article.section("section_adequacy")
    found, say = article.found.adequacy, article.say
    if found is None:
        yield f"<p>{escape(say('adequacy_none'))}</p>"
        return
    test = found.bartlett
    grade = say(f"grade_{min(int(10 * found.kmo), 9) if found.kmo >= 0.5 else 0}")
    text = say(
        "adequacy_text", kmo=coefficient(found.kmo), grade=grade, df=test.df, chi2=decimal(test.chi2, 2),
        p=probability(test.p),
    )  # fmt: skip
    yield f"<p>{escape(text)}</p>"
    yield article.set(article.tables["kmo"], "narrow")
