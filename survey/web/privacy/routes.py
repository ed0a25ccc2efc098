"""The route of the privacy page, beside the form's and answered like them."""

from __future__ import annotations

from collections.abc import Callable

from fastapi import APIRouter, Request
from fastapi.responses import HTMLResponse, Response

from survey.web.form import HEADERS, PageRoute, Preferred, Wanted, chosen_language
from survey.web.privacy.page import privacy_page
from survey.web.privacy.record import Record

__all__ = ["privacy_router"]


def privacy_router(record: Callable[[], Record]) -> APIRouter:
    """GET /privacy. record: of processing, as it is when it is asked for."""
    routes = APIRouter(include_in_schema=False, route_class=PageRoute)

    @routes.get("/privacy")
    def privacy(request: Request, lang: Wanted = None, preferred: Preferred = "") -> Response:
        page = privacy_page(record(), chosen_language(lang, preferred), scheme=request.url.scheme)
        return HTMLResponse(page, headers=HEADERS)

    return routes
