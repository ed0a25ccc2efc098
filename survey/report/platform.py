"""A platform survey's part of the report: means of modules and dimensions, and what visitors wrote, by module."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from html import escape

from survey.analysis.procedure.profiles import Profile
from survey.questionnaire.definition import Language, Questionnaire
from survey.report.tables.table import Table
from survey.report.words import Words, decimal
from survey.scores.csv_table import ScoreTable

__all__ = ["PAPER_FIGURES", "Part", "platform_table", "suggestions_html", "written_by_module"]

PAPER_FIGURES = {"platform-user": 8, "platform-admin": 9}  # where the paper draws the role


@dataclass(frozen=True)
class Part:
    """A table of answers beside the analysed one, such as the other role's."""

    table: ScoreTable
    questionnaire: Questionnaire

    @property
    def sides(self) -> tuple[int, int]:
        """How many modules, and from how many sides each is judged."""
        return len(self.questionnaire.modules), len(self.questionnaire.dimensions)


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
