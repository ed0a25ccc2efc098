"""Both doors of the office, the page and the API, and the one check: signed in there, and of a role that may.

Whoever may not is told so with 403 and stands in the journal. Who is not signed in is shown the door: /office leads to
the form, the API answers 401.
"""

from __future__ import annotations

import json
from functools import partial
from typing import Any

from fastapi import FastAPI, Request
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import JSONResponse, Response

from hall_app.house.people import ACTS, PeopleError
from hall_app.web.platform.counter import (
    PLAIN,
    STATUS,
    Act,
    Answer,
    Asking,
    Counter,
    Form,
    Moved,
    Takes,
    View,
    form_of,
    is_whole,
)
from hall_app.web.platform.office.deeds import Deed, Reading
from survey.errors import StoreError

__all__ = ["Access"]

SEAL = "X-Seal"  # header of the API: what /api/office/me tells
_STATUS = {**STATUS, "signed-out": 401}
_HEADERS = {
    "Cache-Control": "no-store",
    "Content-Security-Policy": "default-src 'none'; frame-ancestors 'none'",
}


class Access:
    """Puts readings and deeds at their addresses."""

    def __init__(self, app: FastAPI, counter: Counter) -> None:
        self._app, self._counter, self._people = app, counter, counter.people

    def reading(self, one: Reading) -> None:
        self._counter.page(f"/office/{one.path}", self._staff(one.act, one.page))
        self._program("GET", one.path, one.act, one.of)

    def own(self, path: str, of: Any) -> None:
        """What everybody of the staff may ask of the API."""
        self._program("GET", path, "", of)

    def deed(self, one: Deed) -> None:
        def done(asking: Asking) -> Answer:
            came = one.do(asking)
            if one.shows is not None:
                return one.shows(asking, came)
            return Moved(
                asking.address(f"/office/{one.back}".format(**{**came, **asking.names}), done="done")
            )

        page = self._staff(one.act, one.page)
        on = f"/office/{one.back}" if "/" not in one.path else ""
        may = partial(self._check, act=one.act)
        self._counter.act(f"/office/{one.path}", self._staff(one.act, done), page, one.takes, on, may)
        self._program("POST", one.path, one.act, one.do, one.takes)

    def _staff(self, act: str, view: View) -> Act:
        def asked(asking: Asking) -> Answer:
            if asking.guest is None:
                return Moved(asking.address("/office"))
            if not asking.refusal:  # else it was checked, and written down, when the form came in
                self._check(asking, act)
            elif not asking.person.may(act):
                raise PeopleError("not-allowed")
            return view(asking)

        return asked

    def _check(self, asking: Asking, act: str) -> None:
        """Raises PeopleError, and writes it down, for who may not."""
        if act not in ACTS:
            raise ValueError(f"{act!r}: no such act – declare it in hall_app/house/people/acts.py")
        if not asking.person.may(act):
            self._people.refuse(asking.person.id, act, asking.path)
            raise PeopleError("not-allowed")

    def _program(self, method: str, path: str, act: str, of: Any, takes: Takes = PLAIN) -> None:
        async def asked(request: Request) -> Response:
            form = Form({})
            refused = await run_in_threadpool(self._refusal, request, act)
            if refused is not None:
                return refused
            try:
                if method == "POST":
                    form = await _brought(request, takes)
                return await run_in_threadpool(self._answer, request, form, of)
            except PeopleError as error:
                return _told(error, _language(request))
            finally:
                form.close()

        self._app.add_api_route(f"/api/office/{path}", asked, methods=[method], include_in_schema=False)

    def _refusal(self, request: Request, act: str) -> Response | None:
        """Before anything of what is sent is read."""
        try:
            asking = self._counter.asking(request)
            if asking.guest is None:
                return _told(PeopleError("signed-out"), _language(request))
            if act:
                self._check(asking, act)
            if request.method == "POST":
                self._counter.check(request, asking, request.headers.get(SEAL, ""))
        except PeopleError as error:
            return _told(error, _language(request))
        except StoreError as error:
            return _lost(error)
        return None

    def _answer(self, request: Request, form: Form, of: Any) -> Response:
        try:
            return JSONResponse(of(self._counter.asking(request, form)), headers=_HEADERS)
        except PeopleError as error:
            return _told(error, _language(request), 404 if error.missing else None)
        except StoreError as error:
            return _lost(error)


async def _brought(request: Request, takes: Takes) -> Form:
    """Files as a form brings them, anything else as JSON. Raises PeopleError."""
    kind = request.headers.get("content-type", "").partition(";")[0].strip().lower()
    if takes.files and kind == "multipart/form-data":
        return await form_of(request, takes)
    body = bytearray()
    async for part in request.stream():
        body += part
        if len(body) > takes.largest:
            raise PeopleError("form-size")
    return Form(_fields(kind, bytes(body)))


def _language(request: Request) -> str:
    return "zh" if request.query_params.get("lang") == "zh" else "en"


def _lost(error: StoreError) -> Response:
    return JSONResponse({"error": "store", "text": str(error)}, 503, headers=_HEADERS)


def _fields(kind: str, body: bytes) -> dict[str, str]:
    """A JSON object of plain values as the fields of a form. Raises PeopleError."""
    try:
        given = json.loads(body.decode() or "{}") if kind == "application/json" else None
    except (ValueError, RecursionError):
        given = None
    if not isinstance(given, dict):
        raise PeopleError("form-kind")
    fields = {}
    for name, value in given.items():
        if isinstance(value, list) and all(isinstance(one, str) for one in value):
            value = " ".join(value)
        if isinstance(value, bool):
            value = "on" if value else ""
        if not isinstance(value, str | int | float) or not is_whole(str(value)):
            raise PeopleError("form-kind")
        fields[name] = str(value)
    return fields


def _told(error: PeopleError, lang: str, status: int | None = None) -> JSONResponse:
    told = {"error": error.key, "text": error.text(lang)}
    # Of what somebody else changed meanwhile, both versions.
    told |= {name: str(error.figures[name]) for name in ("now", "yours", "tag") if name in error.figures}
    return JSONResponse(told, status or _STATUS.get(error.key, 400), headers=_HEADERS)
