"""What was found, as a page and as JSON."""

from __future__ import annotations

from html import escape
from typing import Any

from hall_app.content.folder import Content
from hall_app.content.search import Findings, Found, Marked, Query, excerpt, marked
from hall_app.web.pages.frame import Frame, other_language

__all__ = ["found_json", "search_page"]

KIND = {
    "zh": {"exhibit": "展品", "article": "文章", "activity": "活动", "word": "词语", "weave": "织物"},
    "en": {
        "exhibit": "Exhibit",
        "article": "Article",
        "activity": "Activity",
        "word": "Word",
        "weave": "Weave",
    },
}
_WORDS = {
    "zh": {
        "title": "搜索",
        "lead": "在展品、文章、活动、词语与织物里寻找，中文、英文、拼音都可以。",
        "count": "找到 {n} 条",
        "most": "找到 {n} 条，先列最相关的 {most} 条；再加一个词，可缩小范围。",
        "none": "没有找到“{q}”。换一个词试试：中文可用两个字，如“褙子”；英文可用词的开头，如“gauz”。也可以浏览",
        "catalogue": "展品目录",
        "culture": "文章",
        "glossary": "词语表",
        "mark": "、",
        "stop": "。",
    },
    "en": {
        "title": "Search",
        "lead": "Looks through exhibits, articles, activities, words and weaves, in Chinese, in English and by pinyin.",
        "count": "{n} found",
        "most": "{n} found; the best {most} of them are listed. One more word narrows it down.",
        "none": "Nothing was found for “{q}”. Try another word: in Chinese two characters such as 褙子, in English the "
        "beginning of a word such as “gauz”. Or look through",
        "catalogue": "the catalogue",
        "culture": "the articles",
        "glossary": "the glossary",
        "mark": ", ",
        "stop": ".",
    },
}


def found_json(asked: str, lang: str, found: Findings) -> dict[str, Any]:
    """GET /api/search: number of all that was found; of the best title and excerpt, in pieces [words,
    whether they were looked for], nothing in HTML."""
    query = Query.of(asked)
    return {
        "q": asked[:200],
        "lang": lang,
        "terms": list(query.parts),
        "number": found.number,
        "found": [
            {
                "kind": one.shown.kind,
                "id": one.shown.id,
                "title": list(marked(one.shown.title, query).pieces),
                "excerpt": list(excerpt(one.entry.text, query).pieces),
                "lang": one.entry.lang,
                "address": one.shown.address,
            }
            for one in found.best
        ],
    }


def search_page(content: Content, asked: str, lang: str, found: Findings) -> str:
    """The form, and below it what was found."""
    words, query = _WORDS[lang], Query.of(asked)
    shown = asked[:200]
    frame = Frame(content.hall, lang, "", "/search", {"q": shown})
    if not asked.strip():
        below = ""
    elif not found.best:
        below = f'<p role="status">{_nothing(shown, lang)}</p>'
    else:
        lines = "".join(_line(one, query, lang) for one in found.best)
        told = "count" if found.number == len(found.best) else "most"
        count = words[told].format(n=found.number, most=len(found.best))
        below = f'<p class="quiet" role="status">{count}</p><ol class="found">{lines}</ol>'
    return frame.page(
        f"{words['title']}: {shown}" if shown.strip() else words["title"],
        f"""<header><h1>{words["title"]}</h1><p class="lead">{words["lead"]}</p>
{frame.search_form("q", shown, large=True)}</header>{below}""",
    )


def _nothing(asked: str, lang: str) -> str:
    words = _WORDS[lang]
    ways = [("catalogue", "/catalogue"), ("culture", "/culture"), ("glossary", "/culture/glossary")]
    links = words["mark"].join(f'<a href="{at}?lang={lang}">{words[key]}</a>' for key, at in ways)
    return f"{escape(words['none'].format(q=asked))} {links}{words['stop']}"


def _line(one: Found, query: Query, lang: str) -> str:
    spoken = "" if one.entry.lang == lang else f' lang="{other_language(lang)}"'
    text = f"<p{spoken}>{_html(excerpt(one.entry.text, query))}</p>" if one.entry.text else ""
    return f"""<li><h2><a href="{escape(one.shown.address)}">{_html(marked(one.shown.title, query))}</a></h2>
<p class="quiet">{KIND[lang].get(one.shown.kind, escape(one.shown.kind))}</p>{text}</li>"""


def _html(text: Marked) -> str:
    return "".join(
        f"<mark>{escape(words)}</mark>" if found else escape(words) for words, found in text.pieces
    )
