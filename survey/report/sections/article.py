"""One language's half of the report: what its sections share, and how they number tables and figures."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

from survey.analysis import Analysis
from survey.questionnaire import Language, Questionnaire
from survey.report.chapters import Further
from survey.report.sections.headline import component_names, head
from survey.report.tables import Table, as_csv, as_html, tables_of
from survey.report.words import Words
from survey.scores import ScoreTable

__all__ = ["Article", "Part"]


@dataclass(frozen=True)
class Part:
    """A table of answers beside the analysed one, such as the other role's."""

    table: ScoreTable
    questionnaire: Questionnaire

    @property
    def sides(self) -> tuple[int, int]:
        """How many modules, and from how many sides each is judged."""
        return len(self.questionnaire.modules), len(self.questionnaire.dimensions)


class Article:
    """What a section writes into; every section is a function of one, see `survey.report.sections`.

    table: what was analysed; found: the analysis; beside: the other roles of a platform survey; further: chapters of
    other analyses; names: (k,) of the components; tables: those that the analysis has figures for, by key. csv, svg:
    the files that came of it.
    """

    def __init__(
        self,
        language: Language,
        table: ScoreTable,
        analysis: Analysis,
        beside: Sequence[Part],
        further: Sequence[Further],
    ) -> None:
        self.table, self.found, self.beside, self.further = table, analysis, beside, further
        self.asked = table.questionnaire
        self.say = Words(language, self.asked, analysis.turned.items)
        self.title = self.say("title") if self.asked is None else self.asked.title.in_language(language)
        self.names = component_names(analysis, self.asked, self.say)
        self.tables = tables_of(analysis, self.say, self.names)
        self.csv: dict[str, str] = {}
        self.svg: dict[str, str] = {}
        self._tables = self._figures = 0
        self._sections: list[str] = []

    def html(self, body: str) -> str:
        """The <article> around what the sections have written."""
        top = head(self.title, self.table, self.found, self.say)
        return f'<article lang="{self.say("language")}">{top}{self._contents()}{body}</article>'

    def section(self, key: str) -> str:
        """The heading of a section, numbered; key: of its title among the words."""
        self._sections.append(title := self.say(key))
        at = len(self._sections)
        return f'<h2 id="{self._place(at)}"><i>{at}</i>{escape(title)}</h2>'

    def set(self, table: Table | None, kind: str = "") -> str:
        """A table, numbered, with its CSV; kind: a class of the style sheet. Nothing for None."""
        if table is None:
            return ""
        self._tables += 1
        text = as_csv(table, (self.say("low"), self.say("high")))
        number = f"{self.say('table')} {self._tables}."
        made = as_html(table, number, self.link(table.key, text), self.say("scroll"))
        return f'<div class="{kind}">{made}</div>' if kind else made

    def link(self, key: str, text: str, words: str = "") -> str:
        """A link that saves a CSV text."""
        name = f"{key}.{self.say.language}.csv"
        self.csv[name] = text
        data = base64.b64encode(text.encode()).decode()
        return f'<a download="{name}" href="data:text/csv;base64,{data}">{self.say("download")}{words}</a>'

    def draw(self, key: str, caption: str, svg: str, links: str = "") -> str:
        """A figure, numbered; svg: drawn with the name `self.name(key)`."""
        self._figures += 1
        self.svg[f"{key}.{self.say.language}.svg"] = svg
        hint = escape(self.say("scroll"))
        return (
            f'<figure class="drawing"><p class="hint" aria-hidden="true">{hint}</p>'
            f'<div class="scroll">{svg}</div>'
            f"<figcaption><b>{self.say('figure')} {self._figures}.</b> {escape(caption)} {links}</figcaption></figure>"
        )

    def name(self, key: str) -> str:
        """What keeps a figure's ids apart from the other language's."""
        return f"{key}-{self.say.language}"

    def _contents(self) -> str:
        links = "".join(
            f'<li><a href="#{self._place(at)}">{escape(title)}</a></li>'
            for at, title in enumerate(self._sections, 1)
        )
        return f'<nav aria-label="{self.say("contents")}"><ol>{links}</ol></nav>'

    def _place(self, section: int) -> str:
        return f"{self.say.language}-{section}"
