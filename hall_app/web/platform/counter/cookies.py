"""Cookies of sessions, and the one that ties a form to its browser. All are HttpOnly."""

from __future__ import annotations

import secrets
from dataclasses import dataclass

from starlette.requests import Request
from starlette.responses import Response

from hall_app.house.people.records import OFFICE_HOURS, VISITOR_DAYS

__all__ = ["OFFICE", "VISITOR", "Kind", "give_mark", "give_token", "mark_of", "seal_key", "with_seal_key"]

_SEAL = "hall-form"
_MARK, _MARK_SECONDS = "hall-known", 400 * 86400  # no browser keeps a cookie for longer


@dataclass(frozen=True)
class Kind:
    """Sessions of visitors and of the office have a cookie each: who signs out here stays signed in there.

    same_site: "lax" lets a link from elsewhere find the visitor signed in; the office is entered from within.
    """

    name: str
    office: bool
    same_site: str
    seconds: int


VISITOR = Kind("hall-me", office=False, same_site="lax", seconds=VISITOR_DAYS * 86400)
OFFICE = Kind("hall-office", office=True, same_site="strict", seconds=OFFICE_HOURS * 3600)


def give_token(response: Response, request: Request, kind: Kind, token: str) -> None:
    """Let the browser keep the token of a session; "" lets it forget."""
    _set(response, request, kind.name, token, kind.same_site, kind.seconds if token else 0)


def give_mark(response: Response, request: Request, mark: str) -> None:
    """Let the browser keep by what the account that let it in knows it: nobody's name, and no way in."""
    _set(response, request, _MARK, mark, "lax", _MARK_SECONDS)


def mark_of(request: Request) -> str:
    return request.cookies.get(_MARK, "")[:100]


def seal_key(request: Request) -> str:
    """The word by which this browser's forms are known, a new one where it has none."""
    kept = request.cookies.get(_SEAL, "")
    return kept if len(kept) == 43 and kept.isascii() else secrets.token_urlsafe(32)


def with_seal_key(response: Response, request: Request, key: str) -> None:
    if request.cookies.get(_SEAL) != key:
        _set(response, request, _SEAL, key, "lax", None)


def _set(
    response: Response, request: Request, name: str, value: str, same_site: str, seconds: int | None
) -> None:
    response.set_cookie(
        name,
        value,
        max_age=seconds,
        path="/",
        httponly=True,
        secure=request.url.scheme == "https",
        samesite="strict" if same_site == "strict" else "lax",
    )
