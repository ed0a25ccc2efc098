"""The report's sections in their order: each a function of an `Article` that yields HTML, nothing where it has none."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from survey.questionnaire import Questionnaire
from survey.report.sections.article import Article, Part
from survey.report.sections.closing import further, method, notes
from survey.report.sections.components import loadings, retention, variance
from survey.report.sections.consistency import reliability
from survey.report.sections.item_statistics import adequacy, correlation, items
from survey.report.sections.platform_survey import platform, suggestions
from survey.report.sections.published_paper import paper, way

__all__ = ["Article", "Part", "Section", "sections_of"]

Section = Callable[[Article], Iterator[str]]


def sections_of(asked: Questionnaire | None) -> list[Section]:
    """A platform survey is read for its modules and dimensions (III.C) first, and for what visitors wrote of them."""
    middle: list[Section] = [
        items, way, correlation, adequacy, retention, variance, loadings, reliability, further,
    ]  # fmt: skip
    last: list[Section] = [notes, paper, method]
    if asked is not None and asked.dimensions:
        return [platform, suggestions, *middle, *last]
    return [*middle, suggestions, *last]
