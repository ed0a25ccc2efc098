"""Total variance explained (the paper's Table 2)."""

from __future__ import annotations

from collections.abc import Iterator

from survey.report.sections.article import Article

__all__ = ["variance"]


def variance(article: Article) -> Iterator[str]:
    """Nothing without components."""
    if article.found.components is not None:
        yield article.section("section_variance")
        yield article.set(article.tables["variance"])
