"""The report's page: one self-contained HTML, both languages in it, figures inline."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from survey.analysis import Analysis
from survey.questionnaire.definition import LANGUAGES
from survey.report.chapters.chapter import Further
from survey.report.document import document
from survey.report.platform import Part
from survey.report.sections import sections_of
from survey.report.sections.article import Article
from survey.scores.csv_table import ScoreTable

__all__ = ["Part", "Report", "build"]


@dataclass(frozen=True)
class Report:
    """html: the page; tables: name → CSV text; drawings: name → SVG; names carry their language."""

    html: str
    tables: dict[str, str]
    drawings: dict[str, str]


def build(
    table: ScoreTable, analysis: Analysis, beside: Sequence[Part] = (), further: Sequence[Further] = ()
) -> Report:
    """Everything in both languages. beside: the other roles of a platform survey. further: more chapters."""
    tables: dict[str, str] = {}
    drawings: dict[str, str] = {}
    articles = [Article(language, table, analysis, beside, further) for language in LANGUAGES]
    bodies = []
    for article in articles:
        body = "".join("".join(section(article)) for section in sections_of(table.questionnaire))
        bodies.append(article.html(body))
        tables |= article.csv
        drawings |= article.svg
    return Report(document(bodies, articles[1].title, articles[0].title), tables, drawings)
