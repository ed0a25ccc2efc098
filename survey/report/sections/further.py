"""What other analyses add: stated factors, two groups."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape

from survey.report.chapters.chapter import Drawing
from survey.report.sections.article import Article
from survey.report.tables.table import Table

__all__ = ["further"]


def further(article: Article) -> Iterator[str]:
    """A section for each chapter."""
    for chapter in (make(article.say) for make in article.further):
        yield article.section(chapter.title)
        for part in chapter.parts:
            if isinstance(part, Table):
                yield article.set(part)
            elif isinstance(part, Drawing):
                yield article.draw(part.key, part.caption, part.svg(article.name(part.key)))
            else:
                yield f"<p>{escape(part)}</p>"
