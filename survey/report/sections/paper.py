"""What the paper printed beside what its own Table 3 says and what these answers do."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape

from survey.report.sections.article import Article
from survey.report.tables.paper import paper_table

__all__ = ["paper"]


def paper(article: Article) -> Iterator[str]:
    """One table."""
    yield article.section("section_paper")
    yield f"<p>{escape(article.say('paper_intro'))}</p>"
    comparable = article.found if article.asked is not None and article.asked.id == "garment" else None
    yield article.set(paper_table(comparable, article.say), "paper")
