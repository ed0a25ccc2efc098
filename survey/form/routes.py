"""Routes of the form page. They are relative to each other, so a prefix in front of them changes nothing."""

from __future__ import annotations

from collections.abc import Callable, Coroutine, Mapping
from typing import Annotated, Any

from fastapi import APIRouter, Header, Query, Request
from fastapi.responses import HTMLResponse, Response
from fastapi.routing import APIRoute

from survey.errors import StoreError
from survey.form.clip import ClipOf
from survey.form.page import ASSETS, FOLDER, form_page, list_page, notice_page
from survey.questionnaire import LANGUAGES, Language, Questionnaire
from survey.slug import is_slug

__all__ = ["form_router"]

_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; "
    "img-src 'self' data:; media-src 'self'; "
    "form-action 'self'; base-uri 'none'; frame-ancestors 'self'"
)
RETRY_SECONDS = 5
_HEADERS = {
    "Content-Security-Policy": _POLICY,
    "Cache-Control": "no-cache",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
}

Wanted = Annotated[str | None, Query(alias="lang", description="zh or en; else what the browser prefers")]
Preferred = Annotated[str, Header(alias="accept-language")]


class PageRoute(APIRoute):
    """A route whose visitor sees a page also when the store does not answer."""

    def get_route_handler(self) -> Callable[[Request], Coroutine[Any, Any, Response]]:
        handle = super().get_route_handler()

        async def showing(request: Request) -> Response:
            try:
                return await handle(request)
            except StoreError:
                asked, preferred = (
                    request.query_params.get("lang"),
                    request.headers.get("accept-language", ""),
                )
                headers = _HEADERS | {"Retry-After": str(RETRY_SECONDS)}
                return HTMLResponse(notice_page("unavailable", _language(asked, preferred)), 503, headers)

        return showing


def form_router(questionnaires: Mapping[str, Questionnaire], clip_of: ClipOf | None = None) -> APIRouter:
    """GET /questionnaires, /questionnaires/{id} and the script and style they use.

    clip_of: the host's film of an exhibit, shown beside items on motion. `?preview` sends and keeps nothing.
    """
    routes = APIRouter(include_in_schema=False, route_class=PageRoute)

    @routes.get("/questionnaires")
    def listed(lang: Wanted = None, preferred: Preferred = "") -> Response:
        return HTMLResponse(
            list_page(list(questionnaires.values()), _language(lang, preferred)), headers=_HEADERS
        )

    @routes.get("/questionnaires/{key}")
    def form(request: Request, key: str, lang: Wanted = None, preferred: Preferred = "") -> Response:
        language, questionnaire = _language(lang, preferred), questionnaires.get(key)
        if questionnaire is None:
            return HTMLResponse(notice_page("missing", language), 404, _HEADERS)
        exhibit = request.query_params.get("exhibit")
        # A mistyped exhibit must not keep a visitor from answering; the answer then stands without it.
        known = exhibit if exhibit is not None and is_slug(exhibit) else None
        clip = clip_of(known) if clip_of is not None and known is not None else None
        preview = "preview" in request.query_params
        page = form_page(questionnaire, language, known, clip=clip, preview=preview)
        return HTMLResponse(page, headers=_HEADERS)

    @routes.get("/survey-static/{name}")
    def static(name: str) -> Response:
        if name not in ASSETS:
            return Response(status_code=404)
        headers = {"Cache-Control": "max-age=31536000, immutable", "X-Content-Type-Options": "nosniff"}
        return Response((FOLDER / name).read_bytes(), headers=headers, media_type=ASSETS[name])

    return routes


def _language(wanted: str | None, preferred: str) -> Language:
    """The language asked for, else the first of the browser's that we have, else Chinese."""
    offers = [wanted or "", *(part.split(";")[0] for part in preferred.split(","))]
    for offer in offers:
        for language in LANGUAGES:
            if offer.strip().lower().split("-")[0] == language:
                return language
    return "zh"
