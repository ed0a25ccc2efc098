"""The route of the privacy page, beside the form's and answered like them."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from time import monotonic

from fastapi import APIRouter, Request
from fastapi.responses import HTMLResponse, Response

from survey.web.form import HEADERS, PageRoute, Preferred, Wanted, chosen_language
from survey.web.privacy.page import privacy_page
from survey.web.privacy.record import Record

__all__ = ["privacy_router"]

_LOOK_EVERY = 1.0  # [s] between two looks at the store and the controller's file


def privacy_router(record: Callable[[], Record]) -> APIRouter:
    """GET /privacy. record: of processing; looked at once a second however many ask."""
    routes = APIRouter(include_in_schema=False, route_class=PageRoute)

    @lru_cache(maxsize=1)
    def record_at(moment: int) -> Record:
        return record()

    @routes.get("/privacy")
    def privacy(request: Request, lang: Wanted = None, preferred: Preferred = "") -> Response:
        found = record_at(int(monotonic() / _LOOK_EVERY))
        page = privacy_page(found, chosen_language(lang, preferred), scheme=request.url.scheme)
        return HTMLResponse(page, headers=HEADERS)

    return routes
