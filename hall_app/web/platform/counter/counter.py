"""Pages and acts put at their addresses: who asks is found, forms checked, refusals told."""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import replace
from html import escape
from pathlib import Path
from urllib.parse import quote

from fastapi import FastAPI, Request
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import FileResponse, HTMLResponse, RedirectResponse, Response

from hall_app.house.house import House
from hall_app.house.people import People, PeopleError
from hall_app.web.limits.doorkeeper import address_of
from hall_app.web.pages.catalogue import shown_language
from hall_app.web.pages.frame import Frame
from hall_app.web.platform.counter.asking import Asking, Download, Guest, Moved, Page, Shown
from hall_app.web.platform.counter.cookies import (
    Kind,
    give_mark,
    give_token,
    mark_of,
    seal_key,
    with_seal_key,
)
from hall_app.web.platform.counter.guard import (
    PLAIN,
    SEAL,
    Form,
    Takes,
    check_form,
    check_origin,
    form_of,
    seal_of,
)
from hall_app.web.platform.counter.pace import Pace
from survey.errors import StoreError

__all__ = ["STATUS", "Act", "Answer", "Counter", "View"]

Answer = Shown | Moved | Download
View = Callable[[Asking], Answer]
Act = Callable[[Asking], Answer]

# Of a page with forms nothing is kept, it runs no script but the hall's, and no other page shows it in a frame.
_HEADERS = {
    "Cache-Control": "no-store",
    "Content-Security-Policy": "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; "
    "media-src 'self'; "
    "form-action 'self'; frame-ancestors 'none'; base-uri 'none'",
    "X-Frame-Options": "DENY",
}
# Of a page that runs a script: it asks this hall.
_ASKING = " connect-src 'self'"
# Of a file that somebody brought: nothing in it runs, whatever it says it is.
_SEALED = {
    "Cache-Control": "no-store",
    "Content-Security-Policy": "default-src 'none'; sandbox; frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff",
}
STATUS = {
    "too-often": 429,
    "form": 403,
    "not-allowed": 403,
    "form-size": 413,
    "text-size": 413,
    "file-size": 413,
    "file-pixels": 413,
    "quota": 413,
    "changed": 409,
    "draft-changed": 409,
    "occasion-changed": 409,
    "undo-changed": 409,
    "exhibit-taken": 409,
    "address-taken": 409,
}
_REFUSED = ("请再试一次", "Please try again")
_NOWHERE = ("没有这一页", "There is no such page")
_LOST = (
    ("现在读不到数据", "账户数据暂时读不到，请稍后再试。"),
    ("Not available now", "Accounts cannot be reached at the moment: try again in a minute."),
)
_log = logging.getLogger(__name__)
LEAD = "lead"  # name of the routes that answer with the way to a page, and with none themselves


class Counter:
    """kind: of the sessions that count here; pace: tries, counted together with those of other counters."""

    def __init__(self, app: FastAPI, house: House, people: People, kind: Kind, pace: Pace) -> None:
        self._app, self.house, self.people, self.kind, self.pace = app, house, people, kind, pace
        self._pages: set[str] = set()

    def page(self, path: str, view: View) -> None:
        """Answer GET."""

        async def asked(request: Request) -> Response:
            return await run_in_threadpool(self._answer, request, None, view, view)

        self._pages.add(path)
        self._app.add_api_route(path, asked, methods=["GET"], include_in_schema=False)

    def handed(self, path: str, view: View) -> None:
        """Answer POST of a page that is none of the counter's by one to look at: nothing is done, so no seal is asked.

        What is handed over so stands in no address: neither a browser's history nor another page learns of it.
        """

        async def asked(request: Request) -> Response:
            given: Form | PeopleError
            try:
                given = await form_of(request)
            except PeopleError as error:
                given = error
            return await run_in_threadpool(self._answer, request, given, view, view, sealed=False)

        self._app.add_api_route(path, asked, methods=["POST"], include_in_schema=False)

    def act(
        self,
        path: str,
        act: Act,
        again: View,
        takes: Takes = PLAIN,
        on: str = "",
        before: Callable[[Asking], None] | None = None,
    ) -> None:
        """Answer POST by `act`; what is refused shows the page `again`, with the reason.

        on: path of the page that its form is on, else the nearest page above it; who asks for the act itself, by a
        mark or a page loaded again, is led there. Pages are added before the acts of the same path. before: raises
        PeopleError for who may not, ahead of a large form's reading.
        """

        async def asked(request: Request) -> Response:
            form: Form | None = None
            try:
                check_origin(request)
                # Nobody's megabytes are read but those of who is signed in.
                if takes.largest > PLAIN.largest and await run_in_threadpool(self.guest, request) is None:
                    return await run_in_threadpool(self._answer, request, None, again, again)
                if takes.largest > PLAIN.largest and before is not None:
                    await run_in_threadpool(before, await run_in_threadpool(self.asking, request))
                form = await form_of(request, takes)
                return await run_in_threadpool(self._answer, request, form, act, again)
            except PeopleError as error:
                return await run_in_threadpool(self._answer, request, error, act, again)
            except StoreError:
                return await run_in_threadpool(self._answer, request, None, again, again)
            finally:
                if form is not None:
                    form.close()

        self._app.add_api_route(path, asked, methods=["POST"], include_in_schema=False)
        if path not in self._pages:
            self._lead(path, on or self._above(path))

    def _above(self, path: str) -> str:
        """The nearest page above a path."""
        while path and path not in self._pages:
            path = path.rpartition("/")[0]
        return path or "/"

    def _lead(self, path: str, to: str) -> None:
        """Answer GET by the way to another page."""

        async def asked(request: Request) -> Response:
            names = {name: quote(str(value), safe="") for name, value in request.path_params.items()}
            lang = self._language(request, "", None)
            return RedirectResponse(f"{to.format(**names)}?lang={lang}", 303, headers=_HEADERS)

        self._app.add_api_route(path, asked, methods=["GET"], name=LEAD, include_in_schema=False)

    def guest(self, request: Request) -> Guest | None:
        """Who is signed in. Raises StoreError."""
        token = request.cookies.get(self.kind.name, "")
        found = self.people.sessions.find(token, office=self.kind.office) if token else None
        return Guest(*found, token) if found else None

    def asking(self, request: Request, form: Form | None = None) -> Asking:
        """What a program asks, without a page. Raises StoreError."""
        return self._asking(request, form or Form({}), seal_key(request))

    def check(self, request: Request, asking: Asking, seal: str) -> None:
        """Raises PeopleError for what a page of ours did not send."""
        check_origin(request)
        check_form(seal, asking.seal)

    def _answer(
        self,
        request: Request,
        given: Form | PeopleError | None,
        act: Act,
        again: View,
        *,
        sealed: bool = True,
    ) -> Response:
        key = seal_key(request)
        try:
            asking = self._asking(request, given, key)
            try:
                if isinstance(given, PeopleError):
                    raise given
                if given is not None and sealed:
                    check_form(given.fields.get(SEAL, ""), asking.seal)
                answer = act(asking)
            except PeopleError as error:
                missing = error.missing and (given is None or bool(asking.names))
                status = 404 if missing else STATUS.get(error.key, 400)
                answer = self._refused(replace(asking, refusal=error.text(asking.lang)), status, again)
        except StoreError as error:
            _log.warning("%s", error)
            asking = Asking(request.url.path, self._language(request, "", None), "", "", "")
            title, words = _LOST[asking.lang == "en"]
            main = f'<h1>{title}</h1><p class="lead">{words}</p>'
            answer = Shown(Page(title, main), 503)
        response = self._response(request, asking, answer)
        if isinstance(answer, Shown) and asking.seal and asking.seal in answer.page.main:
            with_seal_key(response, request, key)  # no cookie before there is a form
        return response

    def _asking(self, request: Request, given: Form | PeopleError | None, key: str) -> Asking:
        guest = self.guest(request)
        form = given if isinstance(given, Form) else Form({})
        fields = form.fields
        lang = self._language(request, fields.get("lang", ""), guest)
        return Asking(
            path=request.url.path,
            lang=lang,
            seal=seal_of(key, guest.token if guest else ""),
            network=address_of(request.scope),
            site=f"{request.url.scheme}://{request.url.netloc}",
            names={name: _asked(str(value)) for name, value in request.path_params.items()},
            query={name: _asked(value[:500]) for name, value in request.query_params.items()},
            form=fields,
            files=form.files,
            guest=guest,
            mark=mark_of(request),
        )

    def _language(self, request: Request, form: str, guest: Guest | None) -> str:
        asked = form or request.query_params.get("lang") or (guest.person.language if guest else None)
        return shown_language(self.house.content, asked)

    def _refused(self, asking: Asking, status: int, again: View) -> Answer:
        """The page again, with the reason beside its form; by itself where that page is not for who asks."""
        try:
            answer = again(asking)
        except PeopleError:
            answer = None
        if not isinstance(answer, Shown) or escape(asking.refusal) not in answer.page.main:
            title = asking.word(*(_NOWHERE if status == 404 else _REFUSED))
            back = asking.word("返回", "Back")
            main = f"""<h1>{title}</h1><p class="refused" role="alert">{escape(asking.refusal)}</p>
<p class="doors"><a href="{escape(asking.address(_home(asking.path)))}">{back}</a></p>"""
            answer = Shown(Page(title, main), path=_home(asking.path))
        return replace(answer, status=status)

    def _response(self, request: Request, asking: Asking, answer: Answer) -> Response:
        if isinstance(answer, Moved):
            response: Response = RedirectResponse(answer.to, 303, headers=_HEADERS)
            if answer.token is not None:
                give_token(response, request, self.kind, answer.token)
            if answer.mark:
                give_mark(response, request, answer.mark)
            return response
        if isinstance(answer, Download):
            how = "inline" if answer.inline else "attachment"
            given = _SEALED | {"Content-Disposition": f"{how}; filename*=utf-8''{quote(answer.name)}"}
            if isinstance(answer.data, Path):
                return FileResponse(answer.data, media_type=answer.kind, headers=given)
            return Response(answer.data, media_type=answer.kind, headers=given)
        page = answer.page
        frame = Frame(self.house.content.hall, asking.lang, page.here, answer.path or asking.path, page.query)
        text = frame.page(page.title, page.main, styles=("reading", "forms"), script=page.script)
        headers = dict(_HEADERS)
        if page.script:
            headers["Content-Security-Policy"] += f";{_ASKING}"
        return HTMLResponse(text, answer.status, headers=headers)


def _asked(text: str) -> str:
    """What an address asks for, without the letter that PostgreSQL refuses: nothing is called by it."""
    return text.replace("\0", "\ufffd")


def _home(path: str) -> str:
    """The first page of that part of the platform."""
    return "/" + path.split("/")[1]
