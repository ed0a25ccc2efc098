"""The addresses of the pages to read. Pages are made once for each state of the hall, searches each time."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Hashable
from typing import Annotated, Any

from fastapi import FastAPI, HTTPException, Query, Request
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import FileResponse, HTMLResponse, Response

from hall_app.content.folder import Content
from hall_app.content.search import LONGEST, Entry, SearchIndex, entries_of
from hall_app.content.search import Query as Asked
from hall_app.house.house import House
from hall_app.web.answers.packed import REVALIDATED, Packed
from hall_app.web.answers.work import SLOW, Answers
from hall_app.web.pages.catalogue import shown_language
from hall_app.web.pages.lost import lost_page
from hall_app.web.reading.bibliography import bibliography
from hall_app.web.reading.culture import Pictures, article_page, culture_page
from hall_app.web.reading.glossary import glossary_page, weaves_page
from hall_app.web.reading.research import data_file, method_file, research_page
from hall_app.web.reading.search import found_json, search_page

__all__ = ["add_reading"]

HTML = "text/html; charset=utf-8"
LOOK_EVERY = 1.0  # [s] between two looks at what the survey publishes
Make = Callable[[Content, str, Pictures], str]
More = Callable[[], tuple[Entry, ...]]

_NO_ARTICLE = {
    "zh": "这篇文章不在这里，也许改了名字，或已撤下。",
    "en": "This article is not here; it may have another name now.",
}
_ARTICLES = ("/culture", {"zh": "看看全部文章", "en": "See all articles"})


def add_reading(app: FastAPI, house: House, pictures_of: Callable[[], Pictures], more: More = tuple) -> None:
    """Add /culture and what is below it, /search and /api/search. pictures_of: as pages show them now.

    more: what is to be found beside the content, as it is now; asked in a thread, at each search.
    """
    pages = Answers()  # of their own: there are many, and they are asked for one by one

    async def told(request: Request, key: str, lang: str | None, make: Make) -> Response:
        content, pictures = house.content, pictures_of()
        spoken = shown_language(content, lang)

        def made() -> Packed:
            return Packed(make(content, spoken, pictures).encode(), HTML)

        return await (await pages.of(house.state, (key, spoken), made)).answer(request)

    @app.get("/culture", response_class=HTMLResponse, include_in_schema=False)
    async def culture(request: Request, lang: str | None = None) -> Response:
        return await told(request, "culture", lang, culture_page)

    @app.get("/culture/glossary", response_class=HTMLResponse, include_in_schema=False)
    async def glossary(request: Request, lang: str | None = None) -> Response:
        return await told(
            request, "glossary", lang, lambda content, spoken, _: glossary_page(content, spoken)
        )

    @app.get("/culture/weaves", response_class=HTMLResponse, include_in_schema=False)
    async def weaves(request: Request, lang: str | None = None) -> Response:
        return await told(request, "weaves", lang, weaves_page)

    @app.get("/culture/{article}", response_class=HTMLResponse, include_in_schema=False)
    async def one(request: Request, article: str, lang: str | None = None) -> Response:
        found = house.content.writing.article(article)
        if found is None:
            spoken = shown_language(house.content, lang)
            return HTMLResponse(lost_page(house.content, spoken, _NO_ARTICLE, (_ARTICLES,)), 404)
        return await told(
            request,
            f"article {article}",
            lang,
            lambda content, spoken, pictures: article_page(content, found, spoken, pictures),
        )

    _add_research(app, house, pictures_of)
    _add_search(app, house, more)


def _add_research(app: FastAPI, house: House, pictures_of: Callable[[], Pictures]) -> None:
    pages, answered = Answers(), Answers()

    @app.get("/research", response_class=HTMLResponse, include_in_schema=False)
    async def research(request: Request, lang: str | None = None) -> Response:
        content, pictures, spoken = house.content, pictures_of(), shown_language(house.content, lang)
        results = await answered.of(int(time.monotonic() / LOOK_EVERY), "results", lambda: _published(house))

        def made() -> Packed:
            return Packed(research_page(content, spoken, pictures, json.loads(results)).encode(), HTML)

        return await (await pages.of((*house.state, results), spoken, made)).answer(request)

    @app.get("/research/methods/{name}.md", include_in_schema=False)
    async def method(name: str) -> FileResponse:
        found = method_file(name)
        if found is None:
            raise HTTPException(404, "no such method: see /research")
        return FileResponse(
            found, media_type="text/plain; charset=utf-8", headers={"Cache-Control": REVALIDATED}
        )

    @app.get("/research/papers.bib", include_in_schema=False)
    async def papers() -> Response:
        text = bibliography(house.content.writing.papers)
        named = {"Content-Disposition": 'attachment; filename="papers.bib"', "Cache-Control": REVALIDATED}
        return Response(text, media_type="application/x-bibtex; charset=utf-8", headers=named)

    @app.get("/research/{path:path}", include_in_schema=False)
    async def data(path: str) -> FileResponse:
        found = data_file(house.content, path)
        if found is None:
            raise HTTPException(404, "no such data: see /research")
        return FileResponse(found, filename=found.name, headers={"Cache-Control": REVALIDATED})


def _published(house: House) -> str:
    """What everybody may see of the answers, as JSON; nothing while the store does not answer."""
    try:
        return json.dumps(list(house.survey_results()))
    except Exception:  # a store that is lost is told of elsewhere; the figures need not wait for it
        return "[]"


def _add_search(app: FastAPI, house: House, more: More) -> None:
    indexes = Answers()

    async def index() -> tuple[SearchIndex, Hashable]:
        """The index of what is shown now, and the state it is of; made anew when that changes."""
        beside = await run_in_threadpool(more)
        content, shown, state = house.content, house.shown(), (*house.state, beside)

        def made() -> SearchIndex:
            return SearchIndex((*entries_of(content, shown), *beside))

        return await indexes.of(state, "index", made), state

    @app.get("/search", response_class=HTMLResponse, include_in_schema=False)
    async def page(q: str = "", lang: str | None = None) -> Response:
        content, spoken = house.content, shown_language(house.content, lang)
        asked, (known, state) = _plain(q), await index()

        def made() -> str:
            return search_page(content, asked, spoken, known.find(Asked.of(asked), spoken))

        return HTMLResponse(await SLOW.of(("search", state, spoken, asked), made))

    @app.get("/api/search")
    async def search(
        q: Annotated[
            str, Query(description="what is looked for, in Chinese, English or pinyin; any text")
        ] = "",
        lang: Annotated[str | None, Query(description='"zh" or "en"; else the hall\'s own language')] = None,
    ) -> dict[str, Any]:
        """Exhibits, articles, activities, words and weaves that hold what is asked for, the best first.

        `title` and `excerpt` are pieces [words, whether they were looked for]; `lang` is the excerpt's language.
        """
        spoken = shown_language(house.content, lang)
        asked, (known, state) = _plain(q), await index()
        found = await SLOW.of(("find", state, spoken, asked), lambda: known.find(Asked.of(asked), spoken))
        return found_json(asked, spoken, found)


def _plain(asked: str) -> str:
    """The question without what cannot be printed, and without the end of one that is no question any more."""
    asked = asked[: 2 * LONGEST]
    return " ".join("".join(letter if letter.isprintable() else " " for letter in asked).split())
