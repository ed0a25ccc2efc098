"""What the reader must know beside the numbers."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape

from survey.report.sections.article import Article

__all__ = ["notes"]


def notes(article: Article) -> Iterator[str]:
    """The notes as a table, or that there are none."""
    yield article.section("section_flags")
    if "notes" not in article.tables:
        yield f"<p>{escape(article.say('nothing_flagged'))}</p>"
    yield article.set(article.tables.get("notes"), "notes")
