"""What all pages to read have in common: one head with ways to the others and a search, one foot."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from html import escape
from urllib.parse import urlencode

from hall_app.content.schema.hall import HallFile
from hall_app.web.pages.door import ICON

__all__ = ["NAVIGATION", "Frame", "other_language", "part"]

# key, address, name in both languages; in the order of the head.
NAVIGATION: tuple[tuple[str, str, dict[str, str]], ...] = (
    ("hall", "/", {"zh": "展厅", "en": "Hall"}),
    ("catalogue", "/catalogue", {"zh": "展品", "en": "Exhibits"}),
    ("culture", "/culture", {"zh": "文章", "en": "Articles"}),
    ("glossary", "/culture/glossary", {"zh": "词语", "en": "Glossary"}),
    ("weaves", "/culture/weaves", {"zh": "织物", "en": "Weaves"}),
    ("research", "/research", {"zh": "研究", "en": "Research"}),
    ("activities", "/activities", {"zh": "活动", "en": "Activities"}),
    ("visit", "/visit", {"zh": "参观", "en": "Visit"}),
    ("survey", "/questionnaires", {"zh": "问卷", "en": "Survey"}),
    ("me", "/me", {"zh": "账户", "en": "Account"}),
)
_BELOW = (("privacy", "/privacy", {"zh": "隐私", "en": "Privacy"}),)

_WORDS = {
    "zh": {
        "site": "本站",
        "foot": "页尾",
        "find": "搜索",
        "asked": "搜索展品、文章、活动、词语与织物",
        "skip": "跳到正文",
        "switch": "English",
        "licence": "许可",
    },
    "en": {
        "site": "Site",
        "foot": "Foot of the page",
        "find": "Search",
        "asked": "Search exhibits, articles, activities, words and weaves",
        "skip": "Skip to the text",
        "switch": "中文",
        "licence": "Licence",
    },
}


def other_language(lang: str) -> str:
    return "en" if lang == "zh" else "zh"


@dataclass(frozen=True)
class Frame:
    """A page's head and foot. here: key of NAVIGATION, or "" for another page; path, query: of the page itself."""

    hall: HallFile
    lang: str
    here: str
    path: str
    query: Mapping[str, str] | None = None

    def whole(
        self,
        title: str,
        body: str,
        *,
        styles: tuple[str, ...] = ("reading",),
        script: str = "",
        records: str = "",
    ) -> str:
        """The page. title: escaped here; body: HTML from the head to the foot; script: a file of /static; records: HTML
        of its head that programs read."""
        name = getattr(self.hall.title, self.lang)
        sheets = "".join(f'<link rel="stylesheet" href="/static/book/{s}.css">' for s in ("book", *styles))
        runs = f'<script src="/static/{script}" defer></script>' if script else ""
        return f"""<!doctype html>
<html lang="{self.lang}"><head><meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<link rel="icon" href="{ICON}">
<title>{escape(title)} · {escape(name)}</title>{sheets}{runs}{records}</head>
<body>{body}</body></html>"""

    def page(self, title: str, main: str, *, styles: tuple[str, ...] = ("reading",), script: str = "") -> str:
        """A page whose body is one main element. main: its HTML."""
        skip = f'<a class="skip" href="#main">{_WORDS[self.lang]["skip"]}</a>'
        body = f'{skip}{self.head()}<main id="main" tabindex="-1">{main}</main>{self.foot()}'
        return self.whole(title, body, styles=styles, script=script)

    def head(self) -> str:
        words, name = _WORDS[self.lang], getattr(self.hall.title, self.lang)
        ways = "".join(self._way(key, address, names) for key, address, names in NAVIGATION)
        return f"""<header class="site">
<a class="home" href="/?lang={self.lang}">
<span aria-hidden="true">{escape(self.hall.title.zh[:1])}</span>{escape(name)}</a>
{self.search_form("site-q")}{self._switch()}<nav aria-label="{words["site"]}">{ways}</nav></header>"""

    def search_form(self, key: str, asked: str = "", *, large: bool = False) -> str:
        """A form that asks the search page. key: the field's id; asked: what stands in it."""
        words = _WORDS[self.lang]
        return f"""<form class="find{" large" if large else ""}" action="/search"{"" if large else ' role="search"'}>
<input type="hidden" name="lang" value="{self.lang}"><label class="unseen" for="{key}">{words["asked"]}</label>
<input type="search" id="{key}" name="q" value="{escape(asked)}" maxlength="200" autocomplete="off">
<button>{words["find"]}</button></form>"""

    def foot(self) -> str:
        words, hall, lang = _WORDS[self.lang], self.hall, self.lang
        ways = "".join(self._way(key, address, names) for key, address, names in (*NAVIGATION, *_BELOW))
        title, subtitle = escape(getattr(hall.title, lang)), escape(getattr(hall.subtitle, lang))
        return f"""<footer><nav aria-label="{words["foot"]}">{ways}</nav>
<p>{title} · {subtitle}</p><p>{words["licence"]}: {escape(hall.licence)}</p></footer>"""

    def _way(self, key: str, address: str, names: Mapping[str, str]) -> str:
        now = ' aria-current="page"' if key == self.here else ""
        return f'<a href="{address}?lang={self.lang}"{now}>{names[self.lang]}</a>'

    def _switch(self) -> str:
        other = other_language(self.lang)
        query = escape(urlencode({**(self.query or {}), "lang": other}))
        words = _WORDS[self.lang]["switch"]
        return f'<a class="tongue" href="{escape(self.path)}?{query}" lang="{other}" hreflang="{other}">{words}</a>'


def part(key: str, title: str, inside: str, *, style: str = "") -> str:
    """A part of a page under its heading, which names it. key: its id; title: escaped; style: its class, if any."""
    kind = f' class="{style}"' if style else ""
    small = "" if style else ' class="small"'
    return f"""<section{kind} id="{key}" aria-labelledby="title-{key}">
<h2{small} id="title-{key}">{title}</h2>{inside}</section>"""
