"""What only a researcher may read, with a bearer token: rows, suggestions, files, the analysis."""

from __future__ import annotations

from functools import partial
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Depends, Query, Request, Response, Security
from fastapi.concurrency import run_in_threadpool
from fastapi.security import HTTPBearer
from pydantic import BaseModel, ConfigDict, Field

from survey.export import file_name
from survey.questionnaire import Questionnaire
from survey.store import Store
from survey.web.api.guard import journal, token_guard
from survey.web.api.jobs import Jobs
from survey.web.api.lookup import Questionnaires, find_version
from survey.web.api.replies import ExplainingRoute

__all__ = ["add_research"]

_BEARER = HTTPBearer(auto_error=False, description="`survey token` makes one")  # documents; the guard decides
_MEDIA = {
    "csv": "text/csv; charset=utf-8",
    "codebook": "text/csv; charset=utf-8",
    "json": "application/json",
    "r": "text/plain; charset=utf-8",
    "xlsx": "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet",
    "sav": "application/octet-stream",
}
_FILE: dict[int | str, dict[str, Any]] = {
    200: {"content": {kind.partition(";")[0]: {} for kind in _MEDIA.values()}, "description": "The file"}
}
# Rows are nobody's but the researcher's: no cache on the way keeps a copy.
_PRIVATE = {"Cache-Control": "no-store"}

Format = Literal["csv", "xlsx", "sav", "json", "codebook", "r"]


class Asked(BaseModel):
    """Of which version. A misspelt parameter is refused, for its default would be taken for what was meant."""

    model_config = ConfigDict(extra="forbid")

    version: int | None = Field(None, ge=1, le=10_000, description="the current one when left out")


class Exported(Asked):
    """Of which version, and how many answers must share what is told of a visitor."""

    k: int | None = Field(
        None, ge=2, le=1000, description="coarsen times, exhibits, languages until k answers share them all"
    )


class Wanted(Asked):
    """How to analyse, as `survey analyse` takes it."""

    drop: str = Field(
        "none", max_length=2000, pattern=r"^[^\x00]*$", description="none, a tag such as static, or ITEM,ITEM"
    )
    reverse: str = Field(
        "",
        max_length=2000,
        pattern=r"^[^\x00]*$",
        description="ITEM,ITEM turned as well as those that the questionnaire says; none: none at all",
    )
    rotation: Literal["varimax", "oblimin", "none"] = "varimax"
    factors: str = Field("kaiser", pattern=r"^(kaiser|parallel|[1-9][0-9]?)$", description="or a number")
    missing: Literal["listwise", "pairwise"] = "listwise"
    correlation: Literal["pearson", "polychoric"] = "pearson"
    bootstrap: int = Field(0, ge=0, le=1000, description="resamples of the intervals; 0: none")
    seed: int = Field(0, ge=0, lt=2**31, description="of everything random")


def add_research(routes: APIRouter, store: Store, questionnaires: Questionnaires, jobs: Jobs) -> None:
    """The guarded routes. Whatever reads all answers is done by a process of its own."""
    # Declared beside the store, so that a route of this group cannot be written without its guard.
    research = APIRouter(
        route_class=ExplainingRoute, dependencies=[Security(_BEARER), Depends(token_guard(store))]
    )

    note = journal(store)

    def found(key: str, asked: Asked) -> Questionnaire:
        store.alive()  # the process would take a database that another was put in the place of
        return find_version(questionnaires, store, key, asked.version)

    async def made(request: Request, key: str, task: str, asked: Asked) -> Response:
        """One of the tasks without a file's name."""
        questionnaire = await run_in_threadpool(found, key, asked)
        job = {"task": task, "questionnaire": questionnaire.document(), "settings": asked.model_dump()}
        noted = partial(note, request, questionnaire, task, None)
        return await jobs.response(request, job, "application/json", _PRIVATE, noted)

    @research.get("/questionnaires/{key}/rows", summary="All answers (token)", **_json("array"))
    async def rows(request: Request, key: str, asked: Annotated[Asked, Query()]) -> Response:
        return await made(request, key, "rows", asked)

    @research.get("/questionnaires/{key}/suggestions", summary="All suggestions (token)", **_json("array"))
    async def suggestions(request: Request, key: str, asked: Annotated[Asked, Query()]) -> Response:
        return await made(request, key, "suggestions", asked)

    @research.get(
        "/questionnaires/{key}/export/{kind}",
        summary="All answers as a file (token)",
        response_class=Response,
        responses=_FILE,
    )
    async def export(
        request: Request, key: str, kind: Format, asked: Annotated[Exported, Query()]
    ) -> Response:
        questionnaire = await run_in_threadpool(found, key, asked)
        name = file_name(kind, questionnaire, asked.k)
        headers = {"Content-Disposition": f'attachment; filename="{name}"'} | _PRIVATE
        job = {"task": kind, "questionnaire": questionnaire.document(), "k": asked.k}
        noted = partial(note, request, questionnaire, kind, asked.k)
        return await jobs.response(request, job, _MEDIA[kind], headers, noted)

    @research.get(
        "/questionnaires/{key}/analysis",
        summary="The analysis, as survey analyse --json (token)",
        **_json("object"),
    )
    async def analysis(request: Request, key: str, wanted: Annotated[Wanted, Query()]) -> Response:
        """Answers that cannot be analysed are a 422 that says why: too few, all the same, an unknown item …"""
        return await made(request, key, "analysis", wanted)

    routes.include_router(research)


def _json(kind: str) -> dict[str, Any]:
    """How a route says that it answers with a JSON array or object that FastAPI need not look through."""
    content = {"application/json": {"schema": {"type": kind}}}
    return {
        "response_class": Response,
        "responses": {200: {"content": content, "description": "Successful Response"}},
    }
