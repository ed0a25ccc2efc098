"""The survey as a service of its own, without the hall."""

from __future__ import annotations

import gc
import socket
from collections.abc import AsyncIterator, Sequence
from contextlib import asynccontextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from survey.errors import Problem, SurveyError
from survey.questionnaire import Offers
from survey.web.mounting import Mounted, mount
from survey.web.privacy import Running

if TYPE_CHECKING:
    from fastapi import FastAPI

__all__ = ["serve", "survey_app"]

PARTING = 3  # seconds that requests under way have left when the service is ended


def survey_app(
    content: Path,
    data: Path | str,
    running: Running,
    offers: Offers = None,
) -> tuple[FastAPI, Mounted, list[Problem]]:
    """An app with the API, the form pages and nothing else; the problems of left-out questionnaires."""
    from fastapi import FastAPI
    from fastapi.responses import RedirectResponse

    @asynccontextmanager
    async def life(_app: FastAPI) -> AsyncIterator[None]:
        yield
        mounted.close()

    # The interactive documentation loads its script from elsewhere, so only the document itself is offered.
    app = FastAPI(
        title="Survey", lifespan=life, docs_url=None, redoc_url=None, openapi_url="/api/v1/openapi.json"
    )
    problems: list[Problem] = []
    mounted = mount(
        app,
        content=content,
        data=data,
        problems=problems,
        running=running,
        offers=offers,
    )

    @app.get("/", include_in_schema=False)
    def home() -> RedirectResponse:
        return RedirectResponse("questionnaires")

    return app, mounted, problems


def serve(app: FastAPI, host: str, port: int, proxies: Sequence[str] = ()) -> None:
    """Serve until interrupted. Raises SurveyError when the port is taken.

    proxies: addresses whose X-Forwarded-For is believed; nobody's otherwise, not even this machine's.
    """
    import uvicorn

    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((host, port))
        except OSError as error:
            raise SurveyError(
                f"{host}:{port}: cannot listen ({error.strerror}) – choose another --port"
            ) from None
    # What stands now stands until the end: the collector need not walk through it again and again while it holds
    # everybody up.
    gc.collect()
    gc.freeze()
    trusting = {"proxy_headers": bool(proxies), "forwarded_allow_ips": list(proxies)}
    # No access log: it would keep the visitors' addresses, which we promise not to.
    told = {"log_level": "warning", "access_log": False, "timeout_graceful_shutdown": PARTING}
    uvicorn.run(app, host=host, port=port, **told, **trusting)
