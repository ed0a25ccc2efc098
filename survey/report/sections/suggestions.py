"""What visitors wrote, by module."""

from __future__ import annotations

from collections.abc import Iterator

from survey.report.article import Article
from survey.report.platform import suggestions_html

__all__ = ["suggestions"]


def suggestions(article: Article) -> Iterator[str]:
    """Nothing where no questionnaire was asked."""
    if article.asked is not None:
        yield article.section("section_suggestions")
        yield from suggestions_html((article.table, *(part.table for part in article.beside)), article.say)
