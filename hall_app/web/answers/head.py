"""HEAD: what GET would be told, without having it."""

from __future__ import annotations

from starlette.requests import Request
from starlette.types import ASGIApp, Receive, Scope, Send

__all__ = ["HeadToo", "is_head"]

# What is read there is made for who asks and written down as had: by the office, and by who has a token of the survey.
NOTED = ("/office/", "/api/office/", "/api/v1/questionnaires/")
_MARK = "hall.head"  # in the scope of what was asked as HEAD


class HeadToo:
    """Answers HEAD wherever there is a GET; the server itself leaves the body out.

    Where reading is written down HEAD stays what it is, and is refused (405): the journal would tell of files that
    nobody got.
    """

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope.get("method") == "HEAD" and not scope["path"].startswith(NOTED):
            scope = {**scope, "method": "GET", _MARK: True}
        await self.app(scope, receive, send)


def is_head(request: Request) -> bool:
    """Whether GET is answered to who asked HEAD: nobody sees anything of it."""
    return _MARK in request.scope
