"""What visitors wrote, by module."""

from __future__ import annotations

from collections.abc import Iterator

from survey.report.platform import suggestions_html
from survey.report.sections.article import Article

__all__ = ["suggestions"]


def suggestions(article: Article) -> Iterator[str]:
    """Nothing where no questionnaire was asked."""
    if article.asked is not None:
        yield article.section("section_suggestions")
        yield from suggestions_html((article.table, *(part.table for part in article.beside)), article.say)
