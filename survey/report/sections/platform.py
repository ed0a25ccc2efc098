"""Means of modules and dimensions of a platform survey, role by role (the paper's Fig. 8 and 9)."""

from __future__ import annotations

from collections.abc import Iterator

from survey.analysis.procedure.profiles import Profile, profile
from survey.report import figures
from survey.report.platform import PAPER_FIGURES, Part, platform_table
from survey.report.sections.article import Article

__all__ = ["platform"]


def platform(article: Article) -> Iterator[str]:
    """A figure and a table for each role. Means are of the scores as they were answered, none of them turned."""
    assert article.asked is not None
    yield article.section("section_platform")
    parts = (Part(article.table, article.asked), *article.beside)
    # One scale for all roles, so that their charts can be compared.
    seen = [profile(part.table.scores, *part.sides) for part in parts]
    low = min(one.lowest for one in seen)
    for part, one in zip(parts, seen, strict=True):
        yield from _role(article, part, one, low)


def _role(article: Article, part: Part, seen: Profile, low: float) -> Iterator[str]:
    say, asked = article.say, part.questionnaire
    modules = [module.title.in_language(say.language) for module in asked.modules]
    sides = [side.label.in_language(say.language) for side in asked.dimensions]
    title = f"{asked.title.in_language(say.language)}, n = {len(part.table.scores)}"
    caption = say("platform_figure", title=title)
    if asked.id in PAPER_FIGURES:
        caption += say("platform_paper", number=PAPER_FIGURES[asked.id])
    key = f"platform-{asked.id}"
    svg = figures.lines(seen.mean, seen.half, modules, sides, (low, asked.points), article.name(key), caption)
    yield article.draw(key, caption, svg)
    yield article.set(platform_table(key, seen, modules, sides, say, title), "platform")
