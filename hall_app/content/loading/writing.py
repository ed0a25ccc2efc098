"""What is written in a content folder: articles, the glossary, and what weave files say of themselves."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any, TypeVar

from hall_app.content.files import TEXTS
from hall_app.content.folder import Article, Cloth, Writing
from hall_app.content.loading.exhibits import ID_FORM
from hall_app.content.loading.tables import folders_in, read_table, read_text, unforeseen
from hall_app.content.problems import Problem
from hall_app.content.schema.article import ArticleFile
from hall_app.content.schema.glossary import GlossaryFile
from hall_app.content.schema.research import NumbersFile, PapersFile
from hall_app.content.schema.values import Table

ARTICLES, GLOSSARY, WEAVES = "articles", "glossary.toml", "weaves"
NUMBERS, PAPERS = "research/numbers.json", "research/papers.toml"

T = TypeVar("T", bound=Table)


def load_writing(root: Path, last_good: Writing | None) -> tuple[Writing, list[Problem]]:
    """What there is to read, and its problems; what is faulty now keeps its last good version."""
    problems: list[Problem] = []
    articles: list[Article] = []
    for home in folders_in(root / ARTICLES):
        article, found = _whatever_it_holds(root, home.name)
        problems += found
        if article is None and last_good is not None:
            article = last_good.article(home.name)
        if article is not None:
            articles.append(article)
    before = last_good or Writing()
    glossary = _optional(root, GLOSSARY, GlossaryFile, GlossaryFile(word=before.words), problems)
    numbers = _optional(root, NUMBERS, NumbersFile, NumbersFile(section=before.numbers), problems)
    papers = _optional(root, PAPERS, PapersFile, PapersFile(paper=before.papers), problems)
    ordered = tuple(sorted(articles, key=lambda article: (article.file.order, article.id)))
    return Writing(ordered, glossary.word, _cloths(root), numbers.section, papers.paper), problems


def _optional(root: Path, name: str, model: type[T], before: T, problems: list[Problem]) -> T:
    """A file that a hall may do without; `before`, what it said last, where it is faulty now."""
    if not (root / name).exists():
        return model()
    value, found = read_table(root, name, model)
    problems += found
    return before if value is None else value


def _whatever_it_holds(root: Path, identity: str) -> tuple[Article | None, list[Problem]]:
    try:
        return _load_article(root, identity)
    except Exception as error:  # one article never takes the hall with it
        return None, [unforeseen(f"{ARTICLES}/{identity}/article.toml", error)]


def _load_article(root: Path, identity: str) -> tuple[Article | None, list[Problem]]:
    """One article's folder: the article, or None and everything that is wrong with it."""
    toml = f"{ARTICLES}/{identity}/article.toml"
    if set(identity) - set(ID_FORM):
        what = f"{identity!r} cannot be the name of an article"
        return None, [Problem(toml, "", what, "rename the folder with a-z, 0-9 and -")]
    file, problems = read_table(root, toml, ArticleFile)
    texts = {
        language: read_text(root, f"{ARTICLES}/{identity}/{name}", "every article", problems)
        for language, name in TEXTS.items()
    }
    if file is None or problems:
        return None, problems
    return Article(identity, root / ARTICLES / identity, file, texts["zh"], texts["en"]), []


def _cloths(root: Path) -> tuple[Cloth, ...]:
    """The weaves that can be told of; `hall check` says of the others what the engine says."""
    folder = root / WEAVES
    found = (_cloth(path) for path in sorted(folder.glob("*.toml"))) if folder.is_dir() else ()
    return tuple(cloth for cloth in found if cloth is not None)


def _cloth(path: Path) -> Cloth | None:
    try:
        told: dict[str, Any] = tomllib.loads(path.read_text("utf-8-sig"))
        motif = told["draft"].get("motif")
        return Cloth(
            id=path.stem,
            title_zh=str(told["title"]["zh"]),
            title_en=str(told["title"]["en"]),
            source=str(told.get("source", "")),
            kind=str(told["draft"]["kind"]),
            ends=float(told["ends_per_m"]),
            picks=float(told["picks_per_m"]),
            motif=Path(motif).stem if isinstance(motif, str) else None,
        )
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError):
        return None
