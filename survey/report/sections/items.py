"""Means and spread of the items."""

from __future__ import annotations

from collections.abc import Iterator

from survey.report.sections.article import Article

__all__ = ["items"]


def items(article: Article) -> Iterator[str]:
    """One table."""
    yield article.section("section_items")
    yield article.set(article.tables["items"])
