"""Routes of the form page. They are relative to each other, so a prefix in front of them changes nothing."""

from __future__ import annotations

from collections.abc import Callable, Coroutine, Mapping
from typing import Annotated, Any

from fastapi import APIRouter, Header, Query, Request
from fastapi.responses import HTMLResponse, Response
from fastapi.routing import APIRoute

from survey.errors import StoreError
from survey.questionnaire import LANGUAGES, Language, Offers, Questionnaire, is_slug
from survey.web.form.clip import ClipOf
from survey.web.form.page import ASSETS, FOLDER, Ways, form_page, list_page, notice_page

__all__ = ["HEADERS", "PageRoute", "Preferred", "Wanted", "chosen_language", "form_router"]

_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; "
    "img-src 'self' data:; media-src 'self'; "
    "form-action 'self'; base-uri 'none'; frame-ancestors 'self'"
)
RETRY_SECONDS = 5
HEADERS = {
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
                headers = HEADERS | {"Retry-After": str(RETRY_SECONDS)}
                return HTMLResponse(
                    notice_page("unavailable", chosen_language(asked, preferred)), 503, headers
                )

        return showing


def form_router(
    questionnaires: Mapping[str, Questionnaire],
    clip_of: ClipOf | None = None,
    *,
    offers: Offers = None,
    ways: Ways | None = None,
    privacy: bool = False,
) -> APIRouter:
    """GET /questionnaires, /questionnaires/{id} and the script and style they use.

    clip_of: the host's film of an exhibit, shown beside items on motion. `?preview` sends and keeps nothing.
    offers: what the place has, None: everything is asked. ways: where the thanks lead. privacy:
    whether there is a page on it, which the consent then names.
    """
    on = ways or Ways()
    routes = APIRouter(include_in_schema=False, route_class=PageRoute)

    @routes.get("/questionnaires")
    def listed(lang: Wanted = None, preferred: Preferred = "") -> Response:
        asked = [found for found in questionnaires.values() if found.asking(offers).items]
        return HTMLResponse(list_page(asked, chosen_language(lang, preferred)), headers=HEADERS)

    @routes.get("/questionnaires/{key}")
    def form(request: Request, key: str, lang: Wanted = None, preferred: Preferred = "") -> Response:
        language, questionnaire = chosen_language(lang, preferred), questionnaires.get(key)
        if questionnaire is None:
            return HTMLResponse(notice_page("missing", language), 404, HEADERS)
        questionnaire = questionnaire.asking(offers)
        if not questionnaire.items:
            return HTMLResponse(notice_page("nothing", language), 404, HEADERS)
        exhibit = request.query_params.get("exhibit")
        # A mistyped exhibit must not keep a visitor from answering; the answer then stands without it.
        known = exhibit if exhibit is not None and is_slug(exhibit) else None
        clip = clip_of(known) if clip_of is not None and known is not None else None
        preview = "preview" in request.query_params
        back = on.home(language, known) if on.home is not None else None
        page = form_page(
            questionnaire,
            language,
            known,
            clip=clip,
            preview=preview,
            home=back,
            keep=on.keep,
            privacy=privacy,
        )
        return HTMLResponse(page, headers=HEADERS)

    routes.get("/survey-static/{name}")(_static)
    return routes


def _static(name: str) -> Response:
    if name not in ASSETS:
        return Response(status_code=404)
    headers = {"Cache-Control": "max-age=31536000, immutable", "X-Content-Type-Options": "nosniff"}
    return Response((FOLDER / name).read_bytes(), headers=headers, media_type=ASSETS[name])


def chosen_language(wanted: str | None, preferred: str) -> Language:
    """The language asked for, else the first of the browser's that we have, else Chinese."""
    offers = [wanted or "", *(part.split(";")[0] for part in preferred.split(","))]
    for offer in offers:
        for language in LANGUAGES:
            if offer.strip().lower().split("-")[0] == language:
                return language
    return "zh"
