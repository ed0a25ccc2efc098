"""The hall as a plain page, its second door: for readers without 3-D, for screen readers, for phones and for print.

Contents first, then an article an exhibit: one h1, titles h2, what stands beneath them h3 and lower. Pictures are small
and lead to the large ones; nothing needs a script.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any

from hall_app.content.folder import Content, Exhibit
from hall_app.content.views.markdown import html_of
from hall_app.content.views.scene import exhibit_json, own_picture, thumbnail
from hall_app.web.collection.record import Collection
from hall_app.web.collection.schema_org import artwork, hall_graph, in_page
from hall_app.web.pages.frame import Frame

__all__ = ["Records", "Small", "catalogue_html", "schema_records", "shown_language"]

_WORDS = {
    "zh": {
        "title": "展品目录",
        "hall": "进入展厅",
        "switch": "English",
        "contents": "目录",
        "skip": "跳到目录正文",
        "number": "第 {n} 号",
        "large": "（查看大图）",
        "transcript": "文字稿",
        "data": "资料",
        "measured": "模拟与实测数据",
        "scanned": "扫描与测量",
        "licence": "许可",
        "visit": "在展厅中观看",
        "keep": "收藏",
        "back": "回到目录",
        "pages": "网页",
        "formats": "数据格式",
        "all_formats": "全部展品的数据格式",
        "empty": "展厅里现在没有展品。",
    },
    "en": {
        "title": "Catalogue",
        "hall": "Enter the hall",
        "switch": "中文",
        "contents": "Contents",
        "skip": "Skip to the exhibits",
        "number": "No. {n}",
        "large": "(large picture)",
        "transcript": "Transcript",
        "data": "Data",
        "measured": "Simulated and measured",
        "scanned": "Scanned and measured",
        "licence": "Licence",
        "visit": "See it in the hall",
        "keep": "Keep as a favourite",
        "back": "Back to the contents",
        "pages": "Pages",
        "formats": "As data",
        "all_formats": "All exhibits as data",
        "empty": "There are no exhibits in the hall at present.",
    },
}


@dataclass(frozen=True)
class Small:
    """A picture's thumbnail: its address and size [pixels]."""

    url: str
    width: int
    height: int


# The same records for programs: names and addresses of an exhibit's, and of the whole collection's.
_FORMATS = {
    "IIIF": "/iiif/3/{key}/manifest",
    "LIDO": "/collection/{key}/lido.xml",
    "Dublin Core": "/collection/{key}/dc.xml",
    "schema.org": "/collection/{key}/schema.jsonld",
    "GLB": "/collection/{key}/model.glb",
}
_ALL_FORMATS = {
    "IIIF": "/iiif/3/collection",
    "LIDO": "/collection/lido.xml",
    "schema.org": "/collection/schema.jsonld",
    "CSV": "/collection/table.csv",
    "OAI-PMH": "/oai?verb=Identify",
}


@dataclass(frozen=True)
class Records:
    """What the page tells programs, as script elements: of the hall, and of each exhibit by its id."""

    hall: str
    exhibits: Mapping[str, str]


NO_RECORDS = Records("", {})


def schema_records(collection: Collection) -> Records:
    """The collection in schema.org's words."""
    works = {item.id: in_page(artwork(collection, item)) for item in collection.items}
    return Records(in_page(hall_graph(collection)), works)


SmallOf = Callable[[str], Small | None]  # address of a picture -> its thumbnail, None where it has none


def shown_language(content: Content, asked: str | None) -> str:
    """ "zh" or "en" as asked for, the hall's own for anything else."""
    return asked if asked in _WORDS else content.hall.language


def catalogue_html(
    content: Content,
    shown: tuple[Exhibit, ...],
    baked: Mapping[str, Path],
    language: str | None,
    small_of: SmallOf = lambda url: None,
    records: Records = NO_RECORDS,
) -> str:
    """The whole catalogue in "zh" or "en" (anything else: the hall's language)."""
    lang = shown_language(content, language)
    page = _Page(content, lang, _WORDS[lang], small_of, records)
    details = {
        exhibit.id: exhibit_json(content, exhibit.id, baked=baked.get(exhibit.id)) for exhibit in shown
    }
    numbered = [(n, e, detail) for n, e in enumerate(shown, 1) if (detail := details[e.id])]
    listed = "".join(page.line(n, e, thumbnail(e, baked.get(e.id))) for n, e, _ in numbered)
    entries = "".join(page.entry(n, e, detail) for n, e, detail in numbered)
    return page.whole(listed, entries or f"<p>{page.words['empty']}</p>")


@dataclass(frozen=True)
class _Page:
    """The catalogue in one language."""

    content: Content
    lang: str
    words: dict[str, str]
    small_of: SmallOf
    records: Records

    @property
    def other(self) -> str:
        return "en" if self.lang == "zh" else "zh"

    def whole(self, listed: str, entries: str) -> str:
        hall, words, other = self.content.hall, self.words, self.other
        title, subtitle = escape(getattr(hall.title, self.lang)), escape(getattr(hall.subtitle, self.lang))
        about = f'<p class="about">{escape(getattr(hall.about, self.lang))}</p>' if hall.about else ""
        frame = Frame(hall, self.lang, "catalogue", "/catalogue")
        body = f"""<a class="skip" href="#exhibits">{words["skip"]}</a>{frame.head()}
<section class="cover" aria-labelledby="cover-title">
<span class="seal" aria-hidden="true">{escape(hall.title.zh[:1])}</span>
<h1 id="cover-title">{title}</h1>
<p class="subtitle">{subtitle}</p><p class="kind">{words["title"]}</p>{about}
<nav class="doors" aria-label="{words["pages"]}"><a class="door" href="/?lang={self.lang}">{words["hall"]}</a>
<a href="/catalogue?lang={other}" lang="{other}" hreflang="{other}">{words["switch"]}</a></nav></section>
<nav class="contents" id="contents" aria-labelledby="contents-title"><h2 id="contents-title">{words["contents"]}</h2>
<ol>{listed}</ol></nav>
<main id="exhibits" tabindex="-1">{entries}{self._formats("all_formats", _ALL_FORMATS)}</main>{frame.foot()}"""
        return frame.whole(words["title"], body, styles=("catalogue",), records=self.records.hall)

    def _formats(self, title: str, addresses: Mapping[str, str], key: str = "") -> str:
        """The ways to the same records for programs."""
        ways = " ".join(f'<a href="{path.format(key=key)}">{name}</a>' for name, path in addresses.items())
        return f'<p class="formats"><span>{self.words[title]}:</span> {ways}</p>'

    def line(self, number: int, exhibit: Exhibit, picture: str | None) -> str:
        """An exhibit among the contents."""
        title, caption = exhibit.file.title, exhibit.file.caption
        below = f'<span class="what">{escape(getattr(caption, self.lang))}</span>' if caption else ""
        shown = self._picture(picture, "") if picture else ""
        return f"""<li><a href="#exhibit-{escape(exhibit.id)}"><span class="plate">{shown}</span>
<span class="line"><span class="number">{self.words["number"].format(n=number)}</span>
<span class="name">{escape(getattr(title, self.lang))}</span>{below}</span></a></li>"""

    def entry(self, number: int, exhibit: Exhibit, detail: dict[str, Any]) -> str:
        words, key = self.words, escape(exhibit.id)
        title, second = escape(detail["title"][self.lang]), escape(detail["title"][self.other])
        data = self._table("data", detail["record"]) + self._table(
            "scanned" if detail["scanned"] else "measured", detail["measured"]
        )
        media = "".join(self._medium(medium) for medium in detail["media"])
        plates = f'<div class="plates">{media}</div>' if media else ""
        return f"""<article id="exhibit-{key}" aria-labelledby="title-{key}">
<header><p class="number">{words["number"].format(n=number)}</p><h2 id="title-{key}">{title}</h2>
<p class="second" lang="{self.other}">{second}</p></header>
<div class="text">{self._text(exhibit)}</div>{plates}
<div class="record">{data}<p class="licence">{words["licence"]}: {escape(detail["licence"])}</p>
<p class="ways"><a href="/?exhibit={key}&amp;lang={self.lang}">{words["visit"]}</a>
<a href="/me/keep?exhibit={key}&amp;lang={self.lang}">{words["keep"]}</a>
<a href="#contents">{words["back"]}</a></p>
{self._formats("formats", _FORMATS, key)}</div>{self.records.exhibits.get(exhibit.id, "")}</article>"""

    def _table(self, title: str, lines: list[dict[str, Any]]) -> str:
        """Lines {label, value} under their heading, nothing where there are none."""
        rows = "".join(
            f"<div><dt>{escape(line['label'][self.lang])}</dt><dd>{escape(line['value'][self.lang])}</dd></div>"
            for line in lines
        )
        return f"<h3>{self.words[title]}</h3><dl>{rows}</dl>" if lines else ""

    def _text(self, exhibit: Exhibit) -> str:
        markdown = exhibit.text_zh if self.lang == "zh" else exhibit.text_en
        return html_of(markdown, lambda path: own_picture(exhibit, path), draw=self._leading, top=3)

    def _picture(self, url: str, words: str) -> str:
        """The small picture alone. words: its alternative text, escaped."""
        small = self.small_of(url)
        size = f' width="{small.width}" height="{small.height}"' if small else ""
        return f'<img src="{escape(small.url if small else url)}" alt="{words}"{size} loading="lazy" decoding="async">'

    def _leading(self, url: str, words: str) -> str:
        """The small picture as a way to the large one."""
        large = f'<span class="unseen">{self.words["large"]}</span>'
        return f'<a class="plate" href="{escape(url)}">{self._picture(url, words)}{large}</a>'

    def _medium(self, medium: dict[str, Any]) -> str:
        alt, caption, transcript = (
            escape((medium[part] or {}).get(self.lang, "")) for part in ("alt", "caption", "transcript")
        )
        shown = (
            self._leading(medium["sources"][0]["url"], alt)
            if medium["kind"] == "picture"
            else self._played(medium, alt)
        )
        below = f"<figcaption>{caption or alt}</figcaption>" if caption or alt else ""
        spoken = (
            f"<details><summary>{self.words['transcript']}</summary><p>{transcript}</p></details>"
            if transcript
            else ""
        )
        return f'<figure class="{escape(medium["kind"])}">{shown}{below}{spoken}</figure>'

    def _played(self, medium: dict[str, Any], alt: str) -> str:
        """A film or a sound."""
        kind = escape(medium["kind"])
        sources = "".join(
            f'<source src="{escape(s["url"])}" type="{escape(s["type"])}">' for s in medium["sources"]
        )
        small = self.small_of(medium["poster"]) if medium["poster"] else None
        poster = (
            f' poster="{escape(small.url)}" width="{small.width}" height="{small.height}"' if small else ""
        )
        label = f' aria-label="{alt}"' if alt else ""
        return f'<{kind} controls preload="none"{poster}{label}>{sources}</{kind}>'
