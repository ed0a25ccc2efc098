"""The report's page: one self-contained HTML, both languages in it, figures inline."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path

from survey.analysis import Analysis
from survey.questionnaire import LANGUAGES
from survey.report.chapters import Further
from survey.report.sections import Article, Part, sections_of
from survey.scores import ScoreTable

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
    return Report(_document(bodies, articles[1].title, articles[0].title), tables, drawings)


def _document(bodies: Iterable[str], english: str, chinese: str) -> str:
    """One page of both languages' <article>; english, chinese: its titles."""
    style = (Path(__file__).parent / "style.css").read_text("utf-8")
    # The only script: which of the two languages is shown, and what is too wide for the window says so and can be
    # scrolled by keys. Without scripts both languages are shown, one after the other.
    script = (
        "const root=document.documentElement,both="
        + f'{{en:"{_quoted(english)}",zh:"{_quoted(chinese)}"}};'
        + "function show(l){root.className=l;root.lang=l==='zh'?'zh-Hans':'en';document.title=both[l];fit()}"
        + "function fit(){for(const s of document.querySelectorAll('.scroll')){"
        + "const wide=s.scrollWidth>s.clientWidth+1;s.parentNode.classList.toggle('wide',wide);"
        + "wide?s.setAttribute('tabindex','0'):s.removeAttribute('tabindex')}}"
        + "addEventListener('load',fit);addEventListener('resize',fit);"
        + "function turn(){show(root.className==='zh'?'en':'zh');scrollTo(0,0)}"
        + "show(location.hash==='#zh'||location.hash!=='#en'&&/^zh/i.test(navigator.language)?'zh':'en');"
    )
    return f"""<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{escape(english)}</title>
<link rel="icon" href="data:,">
<style>{style}</style>
<script>{script}</script>
</head>
<body>
{"".join(bodies)}
</body>
</html>
"""


def _quoted(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", " ")
    return escaped.replace("<", "\\u003c").replace("\u2028", " ").replace("\u2029", " ")
