"""One process, one port: the page, viser's socket, the walk, the media, the survey."""

from __future__ import annotations

import asyncio
import tomllib
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from functools import lru_cache
from hashlib import sha256
from pathlib import Path
from typing import Any

from fastapi import FastAPI, HTTPException, Request
from fastapi.responses import FileResponse, HTMLResponse, JSONResponse, Response
from fastapi.staticfiles import StaticFiles
from starlette.types import ASGIApp, Receive, Scope, Send

from ..content.views import exhibit_json, media_file, media_type, scene_json
from ..house import House
from .catalogue import catalogue_html
from .page import PAGE_FOLDER, content_security_policy, hall_page
from .relay import add_relay
from .walk_socket import add_walk_socket

__all__ = ["create_app"]

_HEADERS = {
    "Content-Security-Policy": content_security_policy(),
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "same-origin",
    "Cross-Origin-Opener-Policy": "same-origin",
}


def create_app(house: House, *, lifespan: Callable[[FastAPI], Any] | None = None) -> FastAPI:
    """The hall's web application round a running house. The caller mounts the survey."""
    app = FastAPI(
        title="Hall",
        docs_url=None,
        redoc_url=None,
        openapi_url="/api/openapi.json",
        lifespan=lifespan or _still,
    )

    @app.middleware("http")
    async def guard(request: Request, call_next):
        response = await call_next(request)
        for name, value in _HEADERS.items():
            response.headers.setdefault(name, value)
        return response

    app.add_middleware(_HeadToo)
    _add_page(app, house)
    _add_api(app, house)
    _add_media(app, house)
    add_relay(app, house.scene.port)
    add_walk_socket(app, house)
    app.mount("/static", _Revalidated(directory=PAGE_FOLDER), name="static")
    return app


@asynccontextmanager
async def _still(app: FastAPI) -> AsyncIterator[None]:
    yield


class _HeadToo:
    """Answers HEAD wherever there is a GET; the server itself leaves the body out."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        asked = {**scope, "method": "GET"} if scope.get("method") == "HEAD" else scope
        await self.app(asked, receive, send)


class _Revalidated(StaticFiles):
    """Static files a browser asks for again: an update of the program shows on reloading."""

    def file_response(self, *args: Any, **kwargs: Any) -> Response:
        response = super().file_response(*args, **kwargs)
        response.headers["Cache-Control"] = "no-cache"
        return response


@lru_cache(maxsize=1)
def _page_stamp() -> str:
    """A name for this version of style and script."""
    total = sha256()
    for path in sorted(PAGE_FOLDER.rglob("*")):
        if path.is_file():
            total.update(path.read_bytes())
    return total.hexdigest()[:10]


def _add_page(app: FastAPI, house: House) -> None:
    @app.get("/", response_class=HTMLResponse, include_in_schema=False)
    async def page(withoutHooks: bool = False) -> HTMLResponse:
        hall = house.content.hall
        title = getattr(hall.title, hall.language)
        settings = {"withoutHooks": withoutHooks}
        text = hall_page(title, _page_stamp(), language=hall.language, settings=settings)
        return HTMLResponse(text, headers={"Cache-Control": "no-cache"})

    @app.get("/catalogue", response_class=HTMLResponse, include_in_schema=False)
    async def catalogue(lang: str | None = None) -> HTMLResponse:
        return HTMLResponse(catalogue_html(house.content, house.shown(), house.bakes(), lang))


def _add_api(app: FastAPI, house: House) -> None:
    @app.get("/api/scene")
    async def scene() -> dict[str, Any]:
        """What the hall holds: plan, exhibits, walking constants."""
        answer = scene_json(house.content, nodes=house.scene.nodes(), baked=house.bakes())
        answer["exhibits"] = [entry for entry in answer["exhibits"] if house.models(entry["id"])]
        return {**answer, "walk": house.walk_json(), "problems": len(house.problems)}

    @app.get("/api/exhibits/{exhibit}")
    async def exhibit(exhibit: str) -> dict[str, Any]:
        """Texts, media, record and measured figures of one exhibit."""
        models = house.models(exhibit)
        answer = exhibit_json(house.content, exhibit, baked=models.baked if models else None)
        if answer is None or models is None:
            raise HTTPException(404, f"no exhibit {exhibit!r} in the hall")
        return answer

    @app.get("/api/problems")
    async def problems() -> list[dict[str, str]]:
        """What is wrong with the content now; the last good version stays on show."""
        return [problem.as_json() for problem in house.problems]

    @app.get("/api/texts")
    async def texts() -> JSONResponse:
        """Interface texts in both languages."""
        return JSONResponse(tomllib.loads((PAGE_FOLDER / "texts.toml").read_text("utf-8")))

    @app.get("/grid.bin")
    async def grid(request: Request) -> Response:
        """Clearance samples, int16 little endian; their frame is in /api/scene."""
        packed = "gzip" in request.headers.get("accept-encoding", "")
        samples = await asyncio.to_thread(house.grid.packed if packed else house.grid.to_bytes)
        headers = {"Vary": "Accept-Encoding", **({"Content-Encoding": "gzip"} if packed else {})}
        return Response(samples, media_type="application/octet-stream", headers=headers)


def _add_media(app: FastAPI, house: House) -> None:
    @app.get("/media/{owner}/{path:path}", include_in_schema=False)
    async def media(owner: str, path: str) -> FileResponse:
        found = _media_file(house, owner, path)
        if found is None:
            raise HTTPException(404, "no such file in the hall")
        # The address carries the file's digest, so a browser may keep it; FileResponse answers Range requests.
        return FileResponse(
            found,
            media_type=media_type(found.name),
            headers={"Cache-Control": "public, max-age=31536000, immutable"},
        )


def _media_file(house: House, owner: str, path: str) -> Path | None:
    """A file of the hall or of an exhibit, None for anything outside or of a kind that is not shown."""
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
    return full if plain and media_type(full.name) != "application/octet-stream" else None
