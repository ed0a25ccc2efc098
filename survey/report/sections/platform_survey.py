"""A platform survey: means of modules and dimensions by role (the paper's Fig. 8 and 9), and what visitors wrote."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from html import escape

from survey.analysis.procedure import Profile, profile
from survey.questionnaire import Language
from survey.report import figures
from survey.report.sections.article import Article, Part
from survey.report.tables import Table
from survey.report.words import Words, decimal
from survey.scores import ScoreTable

__all__ = ["platform", "suggestions", "written_by_module"]


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


def suggestions(article: Article) -> Iterator[str]:
    """Nothing where no questionnaire was asked."""
    if article.asked is not None:
        yield article.section("section_suggestions")
        yield from suggestions_html((article.table, *(part.table for part in article.beside)), article.say)


PAPER_FIGURES = {"platform-user": 8, "platform-admin": 9}  # where the paper draws the role


def written_by_module(tables: Iterable[ScoreTable], language: Language) -> dict[str, list[str]]:
    """Title of the module → what was written on it, modules in the order in which they are asked."""
    written: dict[str, list[str]] = {}
    for table in tables:
        words = Words(language, table.questionnaire)
        asked = () if table.questionnaire is None else table.questionnaire.modules
        place = {module.id: at for at, module in enumerate(asked)}
        for module, text in sorted(table.suggestions, key=lambda one: place.get(one[0], len(place))):
            written.setdefault(words.module(module), []).append(text)
    return written


def suggestions_html(tables: Iterable[ScoreTable], say: Words) -> Iterator[str]:
    """A list of texts for each module, or that there are none."""
    written = written_by_module(tables, say.language)
    if not written:
        yield f"<p>{escape(say('no_suggestions'))}</p>"
    for module, texts in written.items():
        listed = "".join(f"<li>{escape(text)}</li>" for text in texts)
        yield f'<h3>{escape(module)}</h3><ul class="suggestions">{listed}</ul>'


def platform_table(
    key: str, seen: Profile, modules: Sequence[str], sides: Sequence[str], say: Words, title: str
) -> Table:
    """Mean ± half-width of each module (row) and dimension."""
    cells = [
        tuple(f"{decimal(mean, 2)} ± {decimal(half, 2)}" for mean, half in zip(*row, strict=True))
        for row in zip(seen.mean, seen.half, strict=True)
    ]
    body = tuple((module, *row) for module, row in zip(modules, cells, strict=True))
    return Table(key, say("platform_caption", title=title), (say("module"), *sides), body)
