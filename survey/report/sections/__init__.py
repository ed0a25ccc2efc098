"""The report's sections in their order: each a function of an `Article` that yields HTML, nothing where it has none."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from survey.questionnaire.definition import Questionnaire
from survey.report.sections.adequacy import adequacy
from survey.report.sections.article import Article
from survey.report.sections.correlation import correlation
from survey.report.sections.further import further
from survey.report.sections.items import items
from survey.report.sections.loadings import loadings
from survey.report.sections.method import method
from survey.report.sections.notes import notes
from survey.report.sections.paper import paper
from survey.report.sections.platform import platform
from survey.report.sections.reliability import reliability
from survey.report.sections.retention import retention
from survey.report.sections.suggestions import suggestions
from survey.report.sections.variance import variance
from survey.report.sections.way import way

__all__ = ["Section", "sections_of"]

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
