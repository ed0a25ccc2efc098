"""The hall as a plain page: the same texts and pictures for readers without 3-D, for screen readers and for print."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape
from pathlib import Path
from typing import Any

from ..content.loading import Content, Exhibit
from ..content.views import exhibit_json

__all__ = ["catalogue_html"]

_WORDS = {
    "zh": {"title": "展品目录", "hall": "进入展厅", "other": "English", "data": "资料", "licence": "许可"},
    "en": {
        "title": "Catalogue",
        "hall": "Enter the hall",
        "other": "中文",
        "data": "Data",
        "licence": "Licence",
    },
}


def catalogue_html(
    content: Content, shown: tuple[Exhibit, ...], baked: Mapping[str, Path], language: str | None
) -> str:
    """The whole catalogue in "zh" or "en" (anything else: the hall's language)."""
    lang = language if language in _WORDS else content.hall.language
    words, other = _WORDS[lang], "en" if lang == "zh" else "zh"
    title = escape(getattr(content.hall.title, lang))
    entries = [exhibit_json(content, exhibit.id, baked=baked.get(exhibit.id)) for exhibit in shown]
    body = "".join(_entry(entry, lang, words) for entry in entries if entry)
    return f"""<!doctype html>
<html lang="{lang}"><head><meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title} · {words["title"]}</title><link rel="stylesheet" href="/static/catalogue.css"></head>
<body><header><h1>{title}</h1><p>{escape(getattr(content.hall.subtitle, lang))}</p>
<nav><a href="/?lang={lang}">{words["hall"]}</a>
<a href="/catalogue?lang={other}" lang="{other}">{words["other"]}</a></nav>
</header><main>{body}</main></body></html>"""


def _entry(detail: dict[str, Any], lang: str, words: dict[str, str]) -> str:
    record = "".join(
        f"<dt>{escape(line['label'][lang])}</dt><dd>{escape(line['value'][lang])}</dd>"
        for line in detail["record"]
    )
    media = "".join(_medium(medium, lang) for medium in detail["media"])
    link = f"/?exhibit={escape(detail['id'])}&amp;lang={lang}"
    return f"""<article id="{escape(detail["id"])}"><h2>{escape(detail["title"][lang])}</h2>
{detail["text"][lang]}{media}<h3>{words["data"]}</h3><dl>{record}</dl>
<p><small>{words["licence"]}: {escape(detail["licence"])}</small></p>
<p><a href="{link}">{words["hall"]}</a></p></article>"""


def _medium(medium: dict[str, Any], lang: str) -> str:
    alt = escape((medium["alt"] or {}).get(lang, ""))
    caption = escape((medium["caption"] or {}).get(lang, ""))
    transcript = escape((medium["transcript"] or {}).get(lang, ""))
    if medium["kind"] == "picture":
        shown = f'<img src="{escape(medium["sources"][0]["url"])}" alt="{alt}" loading="lazy">'
    else:
        sources = "".join(
            f'<source src="{escape(s["url"])}" type="{escape(s["type"])}">' for s in medium["sources"]
        )
        poster = f' poster="{escape(medium["poster"])}"' if medium["poster"] else ""
        label = f' aria-label="{alt}"' if alt else ""
        shown = f'<{medium["kind"]} controls preload="none"{poster}{label}>{sources}</{medium["kind"]}>'
    spoken = f"<details><summary>≡</summary><p>{transcript}</p></details>" if transcript else ""
    return f"<figure>{shown}<figcaption>{caption}</figcaption>{spoken}</figure>"
