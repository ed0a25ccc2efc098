"""Articles as pages show them: where their references and pictures lead, and what speaks of what."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape
from pathlib import Path

from hall_app.content.files import is_there
from hall_app.content.folder import Article, Content
from hall_app.content.views.markdown import Draw, html_of, references_in
from hall_app.content.views.scene import media_file, media_type, media_url

# A picture's path may begin with one of the first two: it is then the hall's and not the article's.
EXHIBITS, WEAVES, RESEARCH = "exhibits", "weaves", "research"

# Where things are read, by kind; {lang} and {name} are put in.
PAGES = {
    "word": "/culture/glossary?lang={lang}#word-{name}",
    "weave": "/culture/weaves?lang={lang}#weave-{name}",
    "exhibit": "/catalogue?lang={lang}#exhibit-{name}",
    "article": "/culture/{name}?lang={lang}",
}


def page_of(kind: str, name: str, lang: str) -> str:
    """Address of the page, and the place on it, where that "word", "weave", "exhibit" or "article" is read."""
    return PAGES[kind].format(lang=lang, name=name)


def is_written(content: Content, kind: str, name: str) -> bool:
    """Whether there is such a thing to refer to."""
    there = content.writing
    if kind == "exhibit":
        return content.exhibit(name) is not None
    return {"word": there.word, "weave": there.cloth, "article": there.article}[kind](name) is not None


def article_html(
    content: Content, article: Article, lang: str, draw: Draw, *, baked: Mapping[str, Path] | None = None
) -> str:
    """The article's text as HTML, its headings from h2 on. draw, baked: as for html_of and scene_json.

    The first of a word's references is described by the element "said-<id>", which the page has to hold.
    """
    described: set[str] = set()

    def refer(kind: str, name: str) -> dict[str, str] | None:
        if not is_written(content, kind, name):
            return None
        attributes = {"href": page_of(kind, name, lang)}
        if kind == "word":
            attributes |= {"class": "word", "data-word": name}
            if name not in described:
                described.add(name)
                attributes["aria-describedby"] = f"said-{name}"
        return attributes

    def picture(path: str) -> str | None:
        return article_picture(content, article, path, baked=baked)

    return html_of(article.text(lang), picture, draw=draw, top=2, refer=refer, figures=True)


def words_of(content: Content, article: Article, lang: str) -> tuple[str, ...]:
    """The ids of the words that the text refers to, each once, in its order."""
    named = (name for kind, name in references_in(article.text(lang)) if kind == "word")
    return tuple(name for name in dict.fromkeys(named) if content.writing.word(name) is not None)


def spoken_of(content: Content, article: Article, kind: str) -> tuple[str, ...]:
    """The ids of the exhibits, weaves or articles that it names in its table or refers to in its texts."""
    file = article.file
    listed = {"exhibit": file.exhibits, "weave": file.weaves, "article": file.articles}[kind]
    told = [
        name for text in (article.text_zh, article.text_en) for k, name in references_in(text) if k == kind
    ]
    return tuple(name for name in dict.fromkeys((*listed, *told)) if is_written(content, kind, name))


def articles_on(content: Content, kind: str, name: str) -> tuple[Article, ...]:
    """The articles that speak of that word, weave or exhibit."""
    if kind == "word":
        return tuple(a for a in content.writing.articles if name in words_of(content, a, "zh"))
    return tuple(a for a in content.writing.articles if name in spoken_of(content, a, kind))


def article_picture(
    content: Content, article: Article, path: str, *, baked: Mapping[str, Path] | None = None
) -> str | None:
    """Address of a picture of the article: media/… of its own, exhibits/… or weaves/… of the hall; else None."""
    if not media_type(path).startswith("image/"):
        return None
    owner, _, inside = path.partition("/")
    if owner == EXHIBITS:
        name, _, inside = inside.partition("/")
        exhibit = content.exhibit(name)
        if exhibit is None or ".." in Path(inside).parts:
            return None
        return media_url(name, inside, media_file(exhibit, inside, (baked or {}).get(name)))
    file = writing_file(content, path if owner == WEAVES else f"articles/{article.id}/{path}")
    if file is None or not is_there(file):
        return None
    return media_url(*_of_owner(file.relative_to(content.folder).as_posix()), file)


def _of_owner(path: str) -> tuple[str, str]:
    owner, _, inside = path.partition("/")
    return owner, inside


def writing_file(content: Content, path: str) -> Path | None:
    """Where a picture of articles/<id>/, weaves/ or research/plots/ lies; None outside them and for odd names."""
    owner, _, inside = path.partition("/")
    home = content.folder / owner
    if owner == "articles":
        name, _, inside = inside.partition("/")
        article = content.writing.article(name)
        if article is None:
            return None
        home = article.folder
    elif owner == RESEARCH:
        home = home / "plots"
        inside = inside.removeprefix("plots/")
    elif owner != WEAVES:
        return None
    try:
        full = (home / inside).resolve()
        return full if full.is_relative_to(home.resolve()) and full != home.resolve() else None
    except (OSError, ValueError):
        return None


def weave_picture(content: Content, name: str) -> str | None:
    """Address of the picture beside a weave's file, None where there is none."""
    return media_url(WEAVES, f"{name}.jpg", content.folder / WEAVES / f"{name}.jpg")


def plot_picture(content: Content, plot: str) -> str | None:
    """Address of a plot of the research page, None where there is none."""
    return media_url(RESEARCH, plot, content.folder / RESEARCH / plot)


def image_html(url: str, words: str, size: tuple[int, int] | None) -> str:
    """A picture that comes when it is near. words: its alternative text, escaped; size: its own [pixels]."""
    kept = f' width="{size[0]}" height="{size[1]}"' if size else ""  # the page keeps its place
    return f'<img src="{escape(url)}" alt="{words}"{kept} loading="lazy" decoding="async">'
