"""One process, one port: the page, viser's socket, the walk, the media, the survey."""

from __future__ import annotations

import json
import threading
import time
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from functools import lru_cache
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlsplit

from fastapi import FastAPI, HTTPException, Request
from fastapi.responses import FileResponse, HTMLResponse, Response
from starlette.datastructures import MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from hall_app.content.files import is_there
from hall_app.content.models.pictures import PictureError, picture_size
from hall_app.content.views.scene import exhibit_json, media_file, media_type, scene_json, yaw_of
from hall_app.content.views.sources import is_source
from hall_app.content.views.writing import writing_file
from hall_app.house.house import House
from hall_app.house.people import People
from hall_app.show.pieces import Pieces
from hall_app.web.answers.head import HeadToo
from hall_app.web.answers.packed import FOR_GOOD, PRIVATE, REVALIDATED, Packed
from hall_app.web.answers.work import SLOW, Answers
from hall_app.web.collection.routes import OPEN, add_collection, collection_now
from hall_app.web.limits.addresses import Addresses
from hall_app.web.limits.doorkeeper import Doorkeeper
from hall_app.web.limits.portions import Portions
from hall_app.web.pages.catalogue import Small, catalogue_html, schema_records, shown_language
from hall_app.web.pages.client import viser_client
from hall_app.web.pages.door import content_security_policy, door_page
from hall_app.web.pages.lost import lost_answer
from hall_app.web.pages.static import page_files
from hall_app.web.pages.still import still_jpeg
from hall_app.web.pages.thumbnails import Thumbnails
from hall_app.web.platform import NoteLook, add_platform, programme_entries
from hall_app.web.reading import Pictures, add_reading
from hall_app.web.sockets.origin import key_of, with_key
from hall_app.web.sockets.relay import Views, add_relay
from hall_app.web.sockets.walk import add_walk_socket

__all__ = ["create_app"]

_HEADERS = {
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "same-origin",
    "Cross-Origin-Opener-Policy": "same-origin",
}

_HTML = "text/html; charset=utf-8"
_LOOK_EVERY = 1.0  # [s] between two looks at the survey
_THUMBNAILS = "thumbnails"  # in the data folder


def create_app(
    house: House,
    *,
    people: People | None = None,
    addresses: Addresses | None = None,
    lifespan: Callable[[FastAPI], Any] | None = None,
) -> FastAPI:
    """The hall's web application round a running house. The caller mounts the survey.

    people: who has an account, closed by the caller; None: a hall without accounts and what takes one.
    addresses: what has been asked for from where; of its own when None.
    """
    addresses = addresses or Addresses()
    app = FastAPI(
        title="Hall",
        docs_url=None,
        redoc_url=None,
        openapi_url="/api/openapi.json",
        responses={"4XX": {"description": "refused, and why"}, 503: {"description": "full, or about to end"}},
        lifespan=lifespan or _still,
    )

    app.add_middleware(_Guard)
    app.add_middleware(HeadToo)
    app.add_middleware(Doorkeeper, addresses=addresses)
    app.add_middleware(Portions)
    app.add_exception_handler(404, lambda request, error: lost_answer(house.content, request, error))
    answers = Answers()
    _add_page(app, house, answers)
    _add_files(app, house.scene.pieces)
    note_look = add_platform(app, house, people) if people is not None else _forget_look
    _add_api(app, house, answers, note_look)
    _add_media(app, house)
    add_collection(app, house)
    add_reading(
        app,
        house,
        lambda: Pictures(_small_pictures(house), lambda url: _size(house, url), house.bakes()),
        lambda: () if people is None else programme_entries(people),
    )
    views = Views(house.places)
    add_relay(app, house.scene.port, views, addresses, house.scene.pieces)
    add_walk_socket(app, house, views, addresses)
    # Done by the time a visitor asks.
    threading.Thread(target=_pack_first_view, args=(house.scene.pieces,), daemon=True).start()
    return app


@asynccontextmanager
async def _still(app: FastAPI) -> AsyncIterator[None]:
    yield


def _forget_look(request: Request, exhibit: str) -> None:
    pass


class _Guard:
    """Gives every answer the headers that keep a page to itself."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        async def guarded(message: Message) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                policy = {"Content-Security-Policy": content_security_policy(page_files())}
                for name, value in (_HEADERS | policy).items():
                    headers.setdefault(name, value)
            await send(message)

        await self.app(scope, receive, guarded if scope["type"] == "http" else send)


def _pack_first_view(pieces: Pieces) -> None:
    pack, _ = pieces.plan_pack()
    for coding in ("zstd", "gzip"):
        viser_client().script.coded(coding)
    _begin_pack(pieces, pack)
    pieces.make_later()


def _begin_pack(pieces: Pieces, pack: str) -> None:
    """Ready by the time the page asks for it."""
    if pieces.made("packs", pack) is None:
        SLOW.begin(("packs", pack), lambda: pieces.pack(pack))


def _add_page(app: FastAPI, house: House, answers: Answers) -> None:
    @app.get("/", response_class=HTMLResponse, include_in_schema=False)
    async def page(request: Request, withoutHooks: bool = False) -> Response:
        files, hall, exhibits = page_files(), house.content.hall, len(house.shown())
        pack = house.scene.pieces.plan_pack()
        _begin_pack(house.scene.pieces, pack[0])
        environment = house.room.environment

        def made() -> Packed:
            still = still_jpeg(environment, yaw_of(hall.start.facing)) if environment else None
            without = withoutHooks
            text = door_page(files, hall, exhibits=exhibits, pack=pack, still=still, without_hooks=without)
            return Packed(text.encode(), _HTML)

        state = (*house.state, files.stamp, pack)
        answer = await (await doors.of(state, withoutHooks, made)).answer(request, PRIVATE)
        answer.raw_headers += with_key(request, key_of(request))  # the body stays one for all
        return answer

    doors = Answers()  # of their own: the page's files and the pack change apart from the hall

    @app.get("/catalogue", response_class=HTMLResponse, include_in_schema=False)
    async def catalogue(request: Request, lang: str | None = None) -> Response:
        content, shown, bakes = house.content, house.shown(), house.bakes()
        spoken, small = shown_language(content, lang), _small_pictures(house)
        collection = collection_now(
            house, ""
        )  # addresses from / on: the page is one for all names of the machine

        def made() -> Packed:
            records = schema_records(collection())
            return Packed(catalogue_html(content, shown, bakes, spoken, small, records).encode(), _HTML)

        return await (await answers.of(house.state, ("catalogue", spoken), made)).answer(request)


def _add_files(app: FastAPI, pieces: Pieces) -> None:
    """The page's files, viser's client and the scene's pieces; where the address names the version, they keep."""

    @app.get("/static/{path:path}", include_in_schema=False)
    async def static(request: Request, path: str) -> Response:
        found = page_files().find(path)
        if found is None:
            raise HTTPException(404, "no such file of the page")
        file, this_version = found
        return await file.answer(request, FOR_GOOD if this_version else REVALIDATED)

    @app.get("/viser/{digest}/{name}", include_in_schema=False)
    async def viser(request: Request, digest: str, name: str) -> Response:
        client = viser_client()
        files = {"viser.js": client.script, "viser.css": client.style, "zstd.wasm": client.decoder}
        if name not in files:
            raise HTTPException(404, "no such file of viser's client")
        return await files[name].answer(request, FOR_GOOD if digest == client.script.digest else REVALIDATED)

    @app.get("/scene/{kind}/{name}", include_in_schema=False)
    async def scene(kind: str, name: str) -> Response:
        try:
            data = pieces.made(kind, name)
            if data is None:
                make = {"packs": pieces.pack, "pieces": pieces.frame}[kind]
                data = await SLOW.of((kind, name), lambda: make(name))
        except KeyError:
            raise HTTPException(404, "no such piece of the scene: reload the page") from None
        return Response(data, media_type="application/octet-stream", headers={"Cache-Control": FOR_GOOD})


def _packed_json(value: object) -> Packed:
    return Packed(json.dumps(value, ensure_ascii=False, separators=(",", ":")).encode(), "application/json")


def _add_api(app: FastAPI, house: House, answers: Answers, note_look: NoteLook) -> None:
    @lru_cache(maxsize=1)
    def surveys(moment: int, questionnaire: str) -> tuple[bool, int]:
        """Whether it asks anything, and the problems of the survey, which looks at its files and its store."""
        return house.survey_asks(questionnaire), len(tuple(house.survey_problems()))

    @app.get("/api/scene")
    async def scene(request: Request) -> Response:
        """What the hall holds: plan, exhibits, walking constants."""
        content, nodes, bakes, walk = house.content, house.scene.nodes(), house.bakes(), house.walk_json()
        shown = {exhibit.id for exhibit in house.shown()}
        asks, faults = surveys(int(time.monotonic() / _LOOK_EVERY), content.hall.questionnaire or "")
        to_come = {"preparing": list(house.preparing), "problems": len(house.own_problems) + faults}

        def made() -> Packed:
            answer = scene_json(content, nodes=nodes, baked=bakes)
            answer["exhibits"] = [entry for entry in answer["exhibits"] if entry["id"] in shown]
            if not asks:
                answer["questionnaire"] = None
            return _packed_json({**answer, "walk": walk, **to_come})

        return await (await scenes.of((*house.state, asks, faults), "scene", made)).answer(request)

    scenes = Answers()  # of their own: they tell of the survey as well

    @app.get("/api/exhibits/{exhibit}")
    async def exhibit(request: Request, exhibit: str) -> Response:
        """Texts, media, record and measured figures of one exhibit."""
        content, models = house.content, house.models(exhibit)
        if models is None or content.exhibit(exhibit) is None:
            raise HTTPException(404, f"no exhibit {exhibit!r} in the hall")
        note_look(request, exhibit)

        def made() -> Packed:
            return _packed_json(exhibit_json(content, exhibit, baked=models.baked))

        return await (await answers.of(house.state, ("exhibit", exhibit), made)).answer(request)

    @app.get("/api/problems")
    async def problems() -> list[dict[str, str]]:
        """What is wrong with the content now; the last good version stays on show."""
        return [problem.as_json() for problem in house.problems]

    @app.get("/api/texts")
    async def texts(request: Request) -> Response:
        """Interface texts in both languages."""
        files = page_files()
        return await (await words.of(files.stamp, "texts", lambda: _packed_json(files.texts))).answer(request)

    words = Answers()

    @app.get(
        "/grid.bin",
        response_class=Response,
        responses={200: {"content": {"application/octet-stream": {}}}},
    )
    async def grid(request: Request) -> Response:
        """Clearance samples, int16 little endian; their frame is in /api/scene."""
        samples = house.grid

        def made() -> Packed:
            return Packed(samples.to_bytes(), "application/octet-stream")

        name = house.walk_json()["grid"]["url"]
        return await (await grids.of(name, "grid", made)).answer(request)

    grids = Answers()


def _add_media(app: FastAPI, house: House) -> None:
    @app.get("/media/{owner}/{path:path}", include_in_schema=False)
    async def media(owner: str, path: str) -> FileResponse:
        found = _media_file(house, owner, path)
        if found is None:
            raise HTTPException(404, "no such file in the hall")
        # FileResponse answers Range requests.
        kind = media_type(found.name)
        return FileResponse(
            found, media_type=kind, headers={"Cache-Control": FOR_GOOD, **OPEN} | _policy(kind)
        )

    @app.get("/thumbnails/{owner}/{path:path}", include_in_schema=False)
    async def thumbnail(owner: str, path: str) -> FileResponse:
        found = _media_file(house, owner, path)
        if found is None or not media_type(found.name).startswith("image/"):
            raise HTTPException(404, "no such picture in the hall")
        thumbnails = Thumbnails(house.data / _THUMBNAILS)
        small = thumbnails.made(found) or await SLOW.of(("thumbnail", found), lambda: thumbnails.file(found))
        cache = FOR_GOOD if small != found else REVALIDATED  # a disk that is full today is not for a year
        kind = media_type(small.name)
        return FileResponse(small, media_type=kind, headers={"Cache-Control": cache} | _policy(kind))


def _policy(kind: str) -> dict[str, str]:
    """Headers that keep a drawing a drawing: opened by itself, an SVG could run scripts as a page of the hall."""
    rules = "default-src 'none'; img-src data:; style-src 'unsafe-inline'; sandbox"
    return {"Content-Security-Policy": rules} if kind == "image/svg+xml" else {}


def _small_pictures(house: House) -> Callable[[str], Small | None]:
    """Address of a picture under /media -> its thumbnail."""
    thumbnails = Thumbnails(house.data / _THUMBNAILS)

    def small(url: str) -> Small | None:
        found = _addressed(house, url)
        size = thumbnails.size(found) if found is not None else None
        return Small(url.replace("/media/", "/thumbnails/", 1), *size) if size is not None else None

    return small


def _addressed(house: House, url: str) -> Path | None:
    """The file at an address under /media."""
    owner, _, path = unquote(urlsplit(url).path.removeprefix("/media/")).partition("/")
    return _media_file(house, owner, path)


def _size(house: House, url: str) -> tuple[int, int] | None:
    """(width, height) [pixels] of a picture under /media, None where it cannot be told."""
    found = _addressed(house, url)
    try:
        return picture_size(found.read_bytes()) if found is not None else None
    except (OSError, PictureError):
        return None


def _media_file(house: House, owner: str, path: str) -> Path | None:
    """A file of the hall, an article, a weave or an exhibit; None for what is outside or of a kind not shown."""
    if owner in ("articles", "weaves", "research"):
        found = writing_file(house.content, f"{owner}/{path}")
        shown = found is not None and media_type(found.name).startswith("image/") and is_there(found)
        return found if shown else None
    if owner == "hall":
        base = house.content.folder / "media"
        full = house.content.folder / path
    else:
        exhibit, models = house.content.exhibit(owner), house.models(owner)
        if exhibit is None:
            return None
        baked = models.baked if models else None
        full = media_file(exhibit, path, baked)
        base = baked if baked is not None and full.is_relative_to(baked) else exhibit.folder
    try:
        full = full.resolve()
        plain = full.is_relative_to(base.resolve()) and full.is_file()
    except (OSError, ValueError):  # a name no file system takes
        return None
    if not plain or media_type(full.name) == "application/octet-stream":
        return None
    return None if is_source(house.content, full) else full
