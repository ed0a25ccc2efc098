"""The list of articles, and an article: its text, the words it uses, what it speaks of, what it rests on."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from html import escape
from pathlib import Path

from hall_app.content.folder import Article, Content
from hall_app.content.views.scene import thumbnail
from hall_app.content.views.writing import (
    article_html,
    article_picture,
    image_html,
    page_of,
    spoken_of,
    weave_picture,
    words_of,
)
from hall_app.web.pages.catalogue import SmallOf
from hall_app.web.pages.frame import Frame, other_language, part

__all__ = ["Pictures", "article_page", "culture_page"]

SCRIPT = "book/words.js"
_WORDS = {
    "zh": {
        "title": "服饰文化",
        "lead": "关于衣料、裁制与穿着的文章。凡可查的都注明出处与可靠程度，凡是推想都说是推想。",
        "kicker": "文章",
        "glossary": "词语表",
        "weaves": "织物",
        "beside": "文中所涉",
        "exhibit": "展品",
        "weave": "织物",
        "article": "接着读",
        "said": "文中词语",
        "sources": "依据",
        "previous": "上一篇",
        "next": "下一篇",
        "written": "写于",
        "licence": "许可",
        "empty": "还没有文章。",
    },
    "en": {
        "title": "Culture of dress",
        "lead": "On cloth, on cutting and on wearing. What can be looked up has its source and how far it was checked; "
        "what is a guess is called one.",
        "kicker": "Articles",
        "glossary": "Glossary",
        "weaves": "Weaves",
        "beside": "What it speaks of",
        "exhibit": "Exhibits",
        "weave": "Weaves",
        "article": "Read on",
        "said": "Words in this article",
        "sources": "What this rests on",
        "previous": "Previous",
        "next": "Next",
        "written": "Written",
        "licence": "Licence",
        "empty": "There are no articles yet.",
    },
}
STANDING = {
    "zh": {
        "museum": "馆藏",
        "secondary": "转述",
        "recalled": "凭记忆",
        "own": "本馆所算",
        "choice": "本馆所设",
    },
    "en": {
        "museum": "museum",
        "secondary": "second hand",
        "recalled": "from memory",
        "own": "computed here",
        "choice": "chosen here",
    },
}


@dataclass(frozen=True)
class Pictures:
    """Where pages get pictures: small ones, sizes of large ones by address, folders of bakes."""

    small_of: SmallOf
    size_of: Callable[[str], tuple[int, int] | None]
    baked: Mapping[str, Path]

    def small(self, url: str | None) -> str:
        """A small picture that says nothing which the words beside it do not; nothing where there is none."""
        if url is None:
            return ""
        found = self.small_of(url)
        return image_html(found.url, "", (found.width, found.height)) if found else image_html(url, "", None)

    def large(self, url: str, words: str) -> str:
        """The picture itself, one that is higher than wide marked as such. words: escaped."""
        size = self.size_of(url)
        tall = ' class="tall"' if size and size[1] > size[0] else ""
        return image_html(url, words, size).replace("<img", f"<img{tall}", 1)


def culture_page(content: Content, lang: str, pictures: Pictures) -> str:
    """The list of all articles."""
    words, frame = _WORDS[lang], Frame(content.hall, lang, "culture", "/culture")
    cards = "".join(_card(content, article, lang, pictures) for article in content.writing.articles)
    listed = f'<ul class="cards">{cards}</ul>' if cards else f"<p>{words['empty']}</p>"
    return frame.page(
        words["title"],
        f"""<header><p class="kicker">{words["kicker"]}</p><h1>{words["title"]}</h1>
<p class="lead">{words["lead"]}</p><p class="doors"><a href="/culture/glossary?lang={lang}">{words["glossary"]}</a>
<a href="/culture/weaves?lang={lang}">{words["weaves"]}</a></p></header>{listed}""",
    )


def _card(content: Content, article: Article, lang: str, pictures: Pictures) -> str:
    file = article.file
    url = article_picture(content, article, file.picture, baked=pictures.baked) if file.picture else None
    return f"""<li><a href="{page_of("article", article.id, lang)}">{pictures.small(url)}
<h2>{escape(getattr(file.title, lang))}</h2><p>{escape(getattr(file.summary, lang))}</p></a></li>"""


def article_page(content: Content, article: Article, lang: str, pictures: Pictures) -> str:
    """One article."""
    words, file, other = _WORDS[lang], article.file, other_language(lang)
    frame = Frame(content.hall, lang, "culture", f"/culture/{article.id}")
    text = article_html(content, article, lang, pictures.large, baked=pictures.baked)
    title, second = escape(getattr(file.title, lang)), escape(getattr(file.title, other))
    return frame.page(
        getattr(file.title, lang),
        f"""<article class="article"><header class="opening">
<p class="kicker"><a href="/culture?lang={lang}">{words["kicker"]}</a></p>
<h1>{title}</h1><p class="second" lang="{other}">{second}</p>
<p class="lead">{escape(getattr(file.summary, lang))}</p></header>
<div class="text">{text}</div>{_beside(content, article, lang, pictures)}
{_said(content, article, lang)}{_sources(article, lang)}
<p class="quiet">{words["written"]} <time datetime="{file.written}">{file.written}</time> ·
{words["licence"]}: {escape(file.licence)}</p>
{_turn(content, article, lang)}</article>""",
        script=SCRIPT,
    )


def _beside(content: Content, article: Article, lang: str, pictures: Pictures) -> str:
    words = _WORDS[lang]
    parts = []
    for kind in ("exhibit", "weave", "article"):
        lines = "".join(
            f'<a href="{page_of(kind, name, lang)}">{pictures.small(url)}<span>{escape(title)}</span></a>'
            for name, title, url in _named(content, article, kind, lang, pictures.baked)
        )
        if lines:
            parts.append(f'<h2 class="small">{words[kind]}</h2>{lines}')
    return f'<aside class="beside" aria-label="{words["beside"]}">{"".join(parts)}</aside>' if parts else ""


def _named(
    content: Content, article: Article, kind: str, lang: str, baked: Mapping[str, Path]
) -> list[tuple[str, str, str | None]]:
    """(id, title, picture) of the exhibits, weaves or articles that it speaks of."""
    found: list[tuple[str, str, str | None]] = []
    for name in spoken_of(content, article, kind):
        if kind == "exhibit" and (exhibit := content.exhibit(name)) is not None:
            found.append((name, getattr(exhibit.file.title, lang), thumbnail(exhibit, baked.get(name))))
        elif kind == "weave" and (cloth := content.writing.cloth(name)) is not None:
            found.append((name, cloth.title(lang), weave_picture(content, name)))
        elif (
            kind == "article" and (one := content.writing.article(name)) is not None and one.id != article.id
        ):
            picture = one.file.picture
            url = article_picture(content, one, picture, baked=baked) if picture else None
            found.append((name, getattr(one.file.title, lang), url))
    return found


def _said(content: Content, article: Article, lang: str) -> str:
    """The words the text refers to, explained; the page's script shows them where they stand."""
    lines = []
    for name in words_of(content, article, lang):
        if (word := content.writing.word(name)) is not None:
            first, second = (word.zh, word.en) if lang == "zh" else (word.en, word.zh)
            lines.append(
                f"<div><dt>{escape(first)}<span>{escape(second)} {escape(word.pinyin)}</span></dt>"
                f'<dd id="said-{name}">{escape(getattr(word.short, lang))}</dd></div>'
            )
    if not lines:
        return ""
    return part("said", _WORDS[lang]["said"], f'<dl class="words">{"".join(lines)}</dl>')


def _sources(article: Article, lang: str) -> str:
    lines = []
    for source in article.file.source:
        text = escape(getattr(source.text, lang))
        if source.url:
            text = f'<a href="{escape(source.url)}" rel="noopener noreferrer">{text}</a>'
        lines.append(f'<li><span class="standing">{STANDING[lang][source.standing]}</span>{text}</li>')
    return part("sources", _WORDS[lang]["sources"], f'<ol class="sources">{"".join(lines)}</ol>')


def _turn(content: Content, article: Article, lang: str) -> str:
    """The articles before and after it."""
    listed, words = content.writing.articles, _WORDS[lang]
    place = listed.index(article)
    ways = ""
    for key, at in (("previous", place - 1), ("next", place + 1)):
        if 0 <= at < len(listed):
            title = escape(getattr(listed[at].file.title, lang))
            ways += f'<a href="{page_of("article", listed[at].id, lang)}">{words[key]}: {title}</a>'
    return f'<nav class="turn" aria-label="{words["article"]}">{ways}</nav>' if ways else ""
