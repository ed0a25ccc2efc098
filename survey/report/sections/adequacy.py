"""KMO and Bartlett's test."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape

from survey.report.sections.article import Article
from survey.report.words import coefficient, decimal, probability

__all__ = ["adequacy"]


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
