"""The report's page: one self-contained HTML, both languages in it, figures inline."""

from __future__ import annotations

import base64
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from html import escape

from survey.analysis import Analysis
from survey.analysis.platform import Profile, profile
from survey.questionnaire import LANGUAGES, Language
from survey.reading import ScoreTable
from survey.report import figures, matrix
from survey.report.document import document
from survey.report.headline import component_names, key_figures
from survey.report.paper import paper_table
from survey.report.platform import PAPER_FIGURES, Part, platform_table, suggestions_html
from survey.report.sheets import as_csv, matrix_csv
from survey.report.tables import MANY, Table, as_html, tables_of
from survey.report.words import Words, coefficient, decimal, probability, whole

__all__ = ["Part", "Report", "build"]

SCATTERED = 5  # items that a scatter matrix shows legibly


@dataclass(frozen=True)
class Report:
    """html: the page; tables: name → CSV text; drawings: name → SVG; names carry their language."""

    html: str
    tables: dict[str, str]
    drawings: dict[str, str]


def build(table: ScoreTable, analysis: Analysis, beside: Sequence[Part] = ()) -> Report:
    """Everything in both languages. beside: the other roles of a platform survey."""
    tables: dict[str, str] = {}
    drawings: dict[str, str] = {}
    articles = [_Article(language, table, analysis, beside) for language in LANGUAGES]
    bodies = []
    for article in articles:
        bodies.append(article.html())
        tables |= article.csv
        drawings |= article.svg
    return Report(document(bodies, articles[1].title, articles[0].title), tables, drawings)


class _Article:
    """One language's half; numbers its tables and figures as they come."""

    def __init__(
        self, language: Language, table: ScoreTable, analysis: Analysis, beside: Sequence[Part]
    ) -> None:
        self.table, self.found, self.beside = table, analysis, beside
        self.say = Words(language, table.questionnaire)
        asked = table.questionnaire
        self.title = self.say("title") if asked is None else asked.title.in_language(language)
        self.names = component_names(analysis, asked, self.say)
        self.tables = tables_of(analysis, self.say, self.names)
        self.csv: dict[str, str] = {}
        self.svg: dict[str, str] = {}
        self._tables = self._figures = 0
        self._sections: list[str] = []

    def html(self) -> str:
        """The <article>."""
        parts = [
            self._items, self._correlation, self._adequacy, self._retention, self._variance, self._loadings,
            self._reliability, self._suggestions, self._notes, self._paper, self._method,
        ]  # fmt: skip
        # A platform survey is read for its modules and dimensions (III.C), and for what visitors wrote of them.
        if self.table.questionnaire is not None and self.table.questionnaire.dimensions:
            parts.remove(self._suggestions)
            parts[:0] = [self._platform, self._suggestions]
        body = "".join("".join(part()) for part in parts)
        return f'<article lang="{self.say("language")}">{self._head()}{self._contents()}{body}</article>'

    def _contents(self) -> str:
        links = "".join(
            f'<li><a href="#{self._place(at)}">{escape(title)}</a></li>'
            for at, title in enumerate(self._sections, 1)
        )
        return f'<nav aria-label="{self.say("contents")}"><ol>{links}</ol></nav>'

    def _place(self, section: int) -> str:
        return f"{self.say.language}-{section}"

    def _head(self) -> str:
        say, found = self.say, self.found
        banners = ""
        if self.table.synthetic:
            banners += f'<p class="banner synthetic"><b>{escape(say("synthetic"))}</b></p>'
        for note in found.notes:
            if note.code in ("small_sample", "barely_enough_rows", "too_few_rows"):
                banners += (
                    f'<p class="banner"><b>{escape(say("fragile"))}</b>{escape(_opening(say.note(note)))}</p>'
                )
        subtitle = say("subtitle", source=self.table.source, n=whole(found.n), items=len(found.items))
        return (
            f'<header><div class="top"><span>{escape(say("title"))}</span>'
            f'<button type="button" onclick="turn()">{escape(say("switch"))}</button></div>'
            f'<h1>{escape(self.title)}</h1><p class="subtitle">{escape(subtitle)}</p></header>'
            f"{banners}{key_figures(found, say)}"
        )

    def _section(self, key: str) -> str:
        self._sections.append(title := self.say(key))
        at = len(self._sections)
        return f'<h2 id="{self._place(at)}"><i>{at}</i>{escape(title)}</h2>'

    def _table(self, table: Table | None, kind: str = "") -> str:
        if table is None:
            return ""
        self._tables += 1
        text = as_csv(table, (self.say("low"), self.say("high")))
        made = as_html(table, f"{self.say('table')} {self._tables}.", self._link(table.key, text))
        return f'<div class="{kind}">{made}</div>' if kind else made

    def _link(self, key: str, text: str, words: str = "") -> str:
        name = f"{key}.{self.say.language}.csv"
        self.csv[name] = text
        data = base64.b64encode(text.encode()).decode()
        return f'<a download="{name}" href="data:text/csv;base64,{data}">{self.say("download")}{words}</a>'

    def _drawing(self, key: str, caption: str, svg: str, links: str = "") -> str:
        self._figures += 1
        self.svg[f"{key}.{self.say.language}.svg"] = svg
        return (
            f'<figure class="drawing"><div class="scroll">{svg}</div><figcaption>'
            f"<b>{self.say('figure')} {self._figures}.</b> {escape(caption)} {links}</figcaption></figure>"
        )

    def _name(self, key: str) -> str:
        return f"{key}-{self.say.language}"

    def _items(self) -> Iterator[str]:
        yield self._section("section_items")
        yield self._table(self.tables["items"])

    def _correlation(self) -> Iterator[str]:
        found, say = self.found.correlation, self.say
        if found is None:
            return
        yield self._section("section_correlation")
        caption = say(
            "correlation_caption" if self.found.settings.method == "pearson" else "polychoric_caption"
        )
        labels = [say.item(item) for item in self.found.items]
        yield self._drawing(
            "correlation",
            caption,
            matrix.correlations(found.r, found.p, labels, self._name("correlation"), caption),
            f"{self._link('correlation', matrix_csv(found.r, labels), ' r')} "
            f"{self._link('probability', matrix_csv(found.p, labels), ' p')}",
        )
        if "pairs" not in self.tables:
            yield f"<p>{escape(say('no_pairs'))}</p>"
            return
        yield self._table(self.tables["pairs"])
        close = [note.items for note in self.found.notes if note.code == "close_pair"]
        items = list(dict.fromkeys(item for pair in close for item in pair))[:SCATTERED]
        scores = self.found.table[:, [self.found.items.index(item) for item in items]]
        caption = say("scatter_caption")
        labels = [say.item(item) for item in items]
        yield self._drawing(
            "scatter", caption, figures.scatter_matrix(scores, labels, self._name("scatter"), caption)
        )

    def _adequacy(self) -> Iterator[str]:
        yield self._section("section_adequacy")
        found = self.found.adequacy
        if found is None:
            yield f"<p>{escape(self.say('adequacy_none'))}</p>"
            return
        test = found.bartlett
        grade = self.say(f"grade_{min(int(10 * found.kmo), 9) if found.kmo >= 0.5 else 0}")
        text = self.say(
            "adequacy_text", kmo=coefficient(found.kmo), grade=grade, df=test.df, chi2=decimal(test.chi2, 2),
            p=probability(test.p),
        )  # fmt: skip
        yield f"<p>{escape(text)}</p>"
        yield self._table(self.tables["kmo"], "narrow")

    def _retention(self) -> Iterator[str]:
        found, say = self.found, self.say
        if found.components is None:
            return
        yield self._section("section_retention")
        yield self._table(self.tables["retention"], "narrow")
        chance, boot = found.parallel, found.bootstrap
        caption = say(
            "scree_caption", draws=0 if chance is None else chance.draws,
            quantile=95 if chance is None else f"{100 * chance.level:.0f}",
        )  # fmt: skip
        svg = figures.scree(
            found.components.eigenvalues, None if chance is None else chance.upper,
            None if boot is None else boot.eigenvalues, say, self._name("scree"), caption,
        )  # fmt: skip
        yield self._drawing("scree", caption, svg)

    def _variance(self) -> Iterator[str]:
        if self.found.components is not None:
            yield self._section("section_variance")
            yield self._table(self.tables["variance"])

    def _loadings(self) -> Iterator[str]:
        found, say = self.found.components, self.say
        yield self._section("section_loadings")
        if found is None:
            yield f"<p>{escape(say('no_components'))}</p>"
            return
        yield self._table(self.tables["loadings"])
        if found.kept > MANY:
            yield f'<p class="small">{escape(" · ".join(self.names))}</p>'
        yield f'<p class="small">{escape(say("naming"))}</p>' if self.table.questionnaire else ""
        yield self._table(self.tables.get("component-correlations"))
        order, boot = found.sorted_items(), self.found.bootstrap
        interval = None if boot is None or boot.loadings is None else boot.loadings[:, order]
        labels = [say.item(self.found.factored[row]) for row in order]
        caption = say("loadings_figure")
        svg = figures.loadings(
            found.loadings[order], interval, labels, self.names, self._name("loadings"), caption
        )
        yield self._drawing("loadings", caption, svg)

    def _reliability(self) -> Iterator[str]:
        found, boot = self.found.reliability, self.found.bootstrap
        if found is None:
            return
        yield self._section("section_reliability")
        interval = ""
        if boot is not None and boot.alpha is not None:
            interval = f" [{coefficient(boot.alpha[0])}, {coefficient(boot.alpha[1])}]"
        omega = "–" if self.found.omega is None else coefficient(self.found.omega.omega)
        text = self.say("reliability_text", alpha=coefficient(found.alpha), interval=interval, omega=omega)
        yield f"<p>{escape(text)}</p>"
        yield self._table(self.tables.get("alpha"), "narrow")

    def _platform(self) -> Iterator[str]:
        asked = self.table.questionnaire
        assert asked is not None
        yield self._section("section_platform")
        parts = (Part(self.table, asked), *self.beside)
        # One scale for all roles, so that their charts can be compared.
        seen = [profile(part.table.scores, *part.sides) for part in parts]
        low = min(one.lowest for one in seen)
        for part, one in zip(parts, seen, strict=True):
            yield from self._role(part, one, low)

    def _role(self, part: Part, seen: Profile, low: float) -> Iterator[str]:
        say, asked = self.say, part.questionnaire
        modules = [module.title.in_language(say.language) for module in asked.modules]
        sides = [side.label.in_language(say.language) for side in asked.dimensions]
        title = f"{asked.title.in_language(say.language)}, n = {len(part.table.scores)}"
        caption = say("platform_figure", title=title)
        if asked.id in PAPER_FIGURES:
            caption += say("platform_paper", number=PAPER_FIGURES[asked.id])
        key = f"platform-{asked.id}"
        svg = figures.lines(
            seen.mean, seen.half, modules, sides, (low, asked.points), self._name(key), caption
        )
        yield self._drawing(key, caption, svg)
        yield self._table(platform_table(key, seen, modules, sides, say, title))

    def _suggestions(self) -> Iterator[str]:
        if self.table.questionnaire is None:
            return
        yield self._section("section_suggestions")
        yield from suggestions_html((self.table, *(part.table for part in self.beside)), self.say)

    def _notes(self) -> Iterator[str]:
        yield self._section("section_flags")
        if "notes" not in self.tables:
            yield f"<p>{escape(self.say('nothing_flagged'))}</p>"
        yield self._table(self.tables.get("notes"))

    def _paper(self) -> Iterator[str]:
        say, asked = self.say, self.table.questionnaire
        yield self._section("section_paper")
        yield f"<p>{escape(say('paper_intro'))}</p>"
        comparable = self.found if asked is not None and asked.id == "garment" else None
        yield self._table(paper_table(comparable, say), "paper")

    def _method(self) -> Iterator[str]:
        say, chosen = self.say, self.found.settings
        yield self._section("section_method")
        dropped = ", ".join(map(say.item, self.found.dropped)) or say("none")
        text = say(
            "method_text", method=say(f"way_{chosen.method}"), missing=say(f"way_{chosen.missing}"),
            rotation=say(f"way_{chosen.rotation}"), dropped=dropped, seed=chosen.seed,
            factors=chosen.factors if isinstance(chosen.factors, int) else say(f"way_{chosen.factors}"),
        )  # fmt: skip
        yield f"<p>{escape(text)}</p><p>{escape(say('method_script'))}</p>"
        yield f'<footer class="small">{escape(say("small_print"))}</footer>'


def _opening(text: str) -> str:
    return text[:1].upper() + text[1:]
