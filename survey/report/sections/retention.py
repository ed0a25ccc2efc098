"""How many components each criterion keeps, and the eigenvalues beside chance."""

from __future__ import annotations

from collections.abc import Iterator

from survey.report import figures
from survey.report.sections.article import Article

__all__ = ["retention"]


def retention(article: Article) -> Iterator[str]:
    """Nothing without components."""
    found, say = article.found, article.say
    if found.components is None:
        return
    yield article.section("section_retention")
    yield article.set(article.tables["retention"], "narrow")
    chance, boot = found.parallel, found.bootstrap
    caption = say(
        "scree_caption", draws=0 if chance is None else chance.draws,
        quantile=95 if chance is None else f"{100 * chance.level:.0f}",
    )  # fmt: skip
    svg = figures.scree(
        found.components.eigenvalues, None if chance is None else chance.upper,
        None if boot is None else boot.eigenvalues, say, article.name("scree"), caption,
    )  # fmt: skip
    yield article.draw("scree", caption, svg)
