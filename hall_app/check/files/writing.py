"""Articles and the glossary: what they refer to is there, pictures are described and small, texts are texts."""

from __future__ import annotations

import posixpath
from collections.abc import Iterator
from difflib import get_close_matches
from pathlib import Path

from hall_app.content.files import TEXTS, file_problem, is_there, shortened, walk_files
from hall_app.content.folder import Article, Content
from hall_app.content.models.pictures import FORMATS, picture_fault
from hall_app.content.problems import Problem
from hall_app.content.views.markdown import pictures_in, raw_html_in, references_in, undescribed_in
from hall_app.content.views.writing import article_picture, is_written

MB = 1_000_000
HEAVIEST, TOGETHER = 1 * MB, 5 * MB  # pictures of one article, and of all
GLOSSARY = "glossary.toml"
LISTED = {"exhibits": "exhibit", "weaves": "weave", "articles": "article"}  # key of a table -> what it names


def writing_problems(content: Content) -> list[Problem]:
    """Everything that is wrong with the articles and words that could be read."""
    found: list[Problem] = []
    total = 0
    for article in content.writing.articles:
        found += _names(content, article.toml, "", article.file)
        for language, name in TEXTS.items():
            found += _text(content, article, f"articles/{article.id}/{name}", article.text(language))
        found += _pictures(content, article)
        weight = sum(path.stat().st_size for path in _own(article))
        total += weight
        if weight > HEAVIEST:
            found.append(_heavy(article.toml, "its pictures have", weight, HEAVIEST))
    if total > TOGETHER:
        found.append(_heavy("articles", "all pictures together have", total, TOGETHER))
    found += _research(content)
    for number, word in enumerate(content.writing.words, 1):
        found += _names(content, GLOSSARY, f"word[{number}].", word)
        for name in word.see:
            if content.writing.word(name) is None:
                found.append(_lost(content, GLOSSARY, f"word[{number}].see", "word", name))
    return found


def _names(content: Content, file: str, before: str, table: object) -> Iterator[Problem]:
    """What the lists of an article or a word name and is not there."""
    for key, kind in LISTED.items():
        for name in getattr(table, key, ()):
            if not is_written(content, kind, name):
                yield _lost(content, file, f"{before}{key}", kind, name)


def _lost(content: Content, file: str, key: str, kind: str, name: str) -> Problem:
    there = content.writing
    known: list[str] = {
        "exhibit": [one.id for one in content.exhibits],
        "word": [one.id for one in there.words],
        "weave": [one.id for one in there.cloths],
        "article": [one.id for one in there.articles],
    }[kind]
    close = get_close_matches(name, known, n=1)
    place = f"add it to {GLOSSARY}" if kind == "word" else f"add {kind}s/{name}"
    fix = f"did you mean {close[0]}?" if close else f"correct the name, or {place}"
    return Problem(file, key, f"there is no {kind} {shortened(name)!r}", fix)


def _text(content: Content, article: Article, name: str, text: str) -> Iterator[Problem]:
    if tag := raw_html_in(text):
        yield Problem(
            name, "", f"HTML is not read, {tag} is shown as letters", "remove the tag, use Markdown"
        )
    for kind, named in dict.fromkeys(references_in(text)):
        if not is_written(content, kind, named):
            yield _lost(content, name, f"{kind}:{named}", kind, named)
    for path in dict.fromkeys(pictures_in(text)):
        if article_picture(content, article, path) is None:
            yield _unshown(name, "", path)
    for path in undescribed_in(text):
        what = f"the picture {shortened(path)} has no description for visitors who cannot see it"
        yield Problem(name, "", what, "write ![what it shows](path)")


def _unshown(file: str, key: str, path: str) -> Problem:
    what = f"the picture {shortened(path)} is not there and is left out"
    fix = "copy it to the article's media/ and write media/…, or name one of exhibits/… or weaves/…"
    return Problem(file, key, what, fix)


def _pictures(content: Content, article: Article) -> Iterator[Problem]:
    """The picture for lists; the article's own pictures, shown as what they say they are, and all of them used."""
    file, picture = article.file, article.file.picture
    if picture is not None and article_picture(content, article, picture) is None:
        yield _unshown(article.toml, "picture", picture)
    used = {"article.toml", "LICENCE.txt", *TEXTS.values(), file.picture}
    used |= {
        posixpath.normpath(path) for text in (article.text_zh, article.text_en) for path in pictures_in(text)
    }
    for path in walk_files(article.folder):
        name = path.relative_to(article.folder).as_posix()
        whole = f"articles/{article.id}/{name}"
        if name not in used:
            yield Problem(
                whole, "", "the file is not used", "show it in a text by ![…](media/…), or remove it"
            )
        elif path.suffix.lower() in FORMATS and (fault := picture_fault(path)):
            yield Problem(whole, "", *fault)


def _research(content: Content) -> Iterator[Problem]:
    """Plots, data and papers that are named and not there."""
    home, fix = content.folder / "research", "run: python tests/bench/research_page.py"
    for number, one in enumerate(content.writing.numbers, 1):
        for path in (*one.data, *([one.plot] if one.plot else ())):
            if not is_there(home / path):
                yield Problem(
                    "research/numbers.json", f"section[{number}]", f"missing file {shortened(path)}", fix
                )
    for number, paper in enumerate(content.writing.papers, 1):
        if paper.file is not None:
            named = file_problem(
                "research/papers.toml", f"paper[{number}].file", home, paper.file, root=content.folder
            )
            if named is None and not paper.file.lower().endswith(".pdf"):
                what = f"{shortened(paper.file)} is no .pdf"
                named = Problem("research/papers.toml", f"paper[{number}].file", what, "save it as PDF")
            if named is not None:
                yield named


def _own(article: Article) -> list[Path]:
    return [path for path in walk_files(article.folder) if path.suffix.lower() in FORMATS]


def _heavy(file: str, whose: str, weight: int, most: int) -> Problem:
    what = f"{whose} {weight / MB:.1f} MB, at most {most / MB:g} MB"
    return Problem(file, "", what, "scale them down, or save them as JPEG of lower quality")
