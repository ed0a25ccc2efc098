"""What a browser is shown where there is nothing: a page that says so and leads on, in the reader's language."""

from __future__ import annotations

from urllib.parse import quote

from fastapi import Request
from fastapi.responses import HTMLResponse, JSONResponse, Response
from starlette.exceptions import HTTPException

from hall_app.content.folder import Content
from hall_app.web.pages.catalogue import shown_language
from hall_app.web.pages.frame import Frame

__all__ = ["lost_answer", "lost_page"]

_TITLE = {"zh": "没有这一页", "en": "There is no such page"}
_NOTHING = {
    "zh": "这个地址没有内容，也许改了名字，或已撤下。",
    "en": "There is nothing at this address; it may have another name now.",
}
_WAYS = (
    ("/", {"zh": "走进展厅", "en": "Into the hall"}),
    ("/catalogue", {"zh": "看看全部展品", "en": "See all exhibits"}),
    ("/search", {"zh": "搜索", "en": "Search"}),
)
Way = tuple[str, dict[str, str]]


def lost_page(
    content: Content,
    lang: str,
    words: dict[str, str] = _NOTHING,
    ways: tuple[Way, ...] = _WAYS,
    path: str = "",
) -> str:
    """words: what is not there; ways: addresses that lead on, and what they are called; path: of the other language."""
    doors = "".join(f'<a href="{way}?lang={lang}">{name[lang]}</a>' for way, name in ways)
    inside = f'<h1>{_TITLE[lang]}</h1><p class="lead">{words[lang]}</p><p class="doors">{doors}</p>'
    return Frame(content.hall, lang, "", path or ways[0][0]).page(_TITLE[lang], inside)


def lost_answer(content: Content, request: Request, error: Exception) -> Response:
    """To a browser that follows an address a page, to a program what it was refused with."""
    told = error if isinstance(error, HTTPException) else HTTPException(404)
    page = "text/html" in request.headers.get("accept", "") and not request.url.path.startswith("/api/")
    if page and request.method == "GET":
        lang = shown_language(content, request.query_params.get("lang"))
        here = "/" + quote(request.url.path.lstrip("/"))  # //elsewhere would be another site's
        return HTMLResponse(lost_page(content, lang, path=here), 404)
    return JSONResponse({"detail": told.detail}, 404, headers=told.headers)
