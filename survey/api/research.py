"""What only a researcher may read, with a bearer token: rows, suggestions, files, the analysis."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Depends, Query, Request, Response, Security
from fastapi.security import HTTPBearer
from pydantic import BaseModel, ConfigDict, Field

from survey.api.finding import Questionnaires, find_version
from survey.api.replies import ExplainingRoute
from survey.errors import AnswerError
from survey.export import exported, file_name
from survey.questionnaire import Questionnaire
from survey.store import Store, Stored

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


class Wanted(Asked):
    """How to analyse, as `survey analyse` takes it."""

    drop: str = Field(
        "none", max_length=2000, pattern=r"^[^\x00]*$", description="none, a tag such as static, or ITEM,ITEM"
    )
    rotation: Literal["varimax", "oblimin", "none"] = "varimax"
    factors: str = Field("kaiser", pattern=r"^(kaiser|parallel|[1-9][0-9]?)$", description="or a number")
    missing: Literal["listwise", "pairwise"] = "listwise"
    correlation: Literal["pearson", "polychoric"] = "pearson"
    bootstrap: int = Field(0, ge=0, le=1000, description="resamples of the intervals; 0: none")
    seed: int = Field(0, ge=0, lt=2**31, description="of everything random")


def add_research(routes: APIRouter, store: Store, questionnaires: Questionnaires) -> None:
    """The guarded routes."""
    # Declared beside the store, so that a route of this group cannot be written without its guard.
    research = APIRouter(
        route_class=ExplainingRoute, dependencies=[Security(_BEARER), Depends(_token_guard(store))]
    )

    def stored(key: str, asked: Asked) -> tuple[Questionnaire, tuple[Stored, ...]]:
        questionnaire = find_version(questionnaires, store, key, asked.version)
        return questionnaire, store.rows(questionnaire)

    @research.get("/questionnaires/{key}/rows", summary="All answers (token)")
    def rows(key: str, asked: Annotated[Asked, Query()], response: Response) -> list[dict[str, Any]]:
        response.headers.update(_PRIVATE)
        return [_row(row) for row in stored(key, asked)[1]]

    @research.get("/questionnaires/{key}/suggestions", summary="All suggestions (token)")
    def suggestions(key: str, asked: Annotated[Asked, Query()], response: Response) -> list[dict[str, Any]]:
        response.headers.update(_PRIVATE)
        return [
            {"submission": row.answer.id, "language": row.answer.language, "module": module, "text": text}
            for row in stored(key, asked)[1]
            for module, text in row.answer.suggestions
        ]

    @research.get(
        "/questionnaires/{key}/export/{kind}",
        summary="All answers as a file (token)",
        response_class=Response,
        responses=_FILE,
    )
    def export(key: str, kind: Format, asked: Annotated[Asked, Query()]) -> Response:
        questionnaire, found = stored(key, asked)
        name = file_name(kind, questionnaire)
        headers = {"Content-Disposition": f'attachment; filename="{name}"'} | _PRIVATE
        return Response(exported(kind, questionnaire, found), media_type=_MEDIA[kind], headers=headers)

    @research.get("/questionnaires/{key}/analysis", summary="The analysis, as survey analyse --json (token)")
    def analysis(key: str, wanted: Annotated[Wanted, Query()], response: Response) -> dict[str, Any]:
        """Answers that cannot be analysed are a 422 that says why: too few, all the same, an unknown item …"""
        response.headers.update(_PRIVATE)
        return _analysed(*stored(key, wanted), wanted)

    routes.include_router(research)


def _analysed(questionnaire: Questionnaire, found: tuple[Stored, ...], wanted: Wanted) -> dict[str, Any]:
    # numpy, scipy and factor_analyzer are loaded when the first analysis is asked for.
    from survey.analysis import analyse
    from survey.analysis.errors import AnalysisError
    from survey.analysis.pipeline import Settings
    from survey.analysis.summary import summary
    from survey.working import dropped, scores_table

    table = scores_table(questionnaire, found)
    settings = Settings(
        drop=dropped(wanted.drop, questionnaire),
        factors=_factors(wanted.factors),
        rotation=wanted.rotation,
        missing=wanted.missing,
        method=wanted.correlation,
        bootstrap=wanted.bootstrap,
        seed=wanted.seed,
    )
    try:
        return summary(analyse(table.scores, table.items, settings=settings))
    except AnalysisError as error:
        problem, _, remedy = str(error).partition(" – ")
        raise AnswerError(error.code, problem, remedy or "see survey/README.md", status=422) from None


def _factors(text: str) -> int | Literal["kaiser", "parallel"]:
    if text.isdecimal():
        return int(text)
    return "parallel" if text == "parallel" else "kaiser"


def _token_guard(store: Store) -> Callable[[Request], None]:
    def guard(request: Request) -> None:
        kind, _, secret = request.headers.get("authorization", "").partition(" ")
        if kind.lower() != "bearer" or not store.tokens.admits(secret.strip()):
            remedy = "send Authorization: Bearer TOKEN; `survey token` makes one"
            raise AnswerError("authorization", "no valid token", remedy, status=401)

    return guard


def _row(row: Stored) -> dict[str, Any]:
    answer = row.answer
    return {
        "submission": answer.id,
        "version": answer.version,
        "language": answer.language,
        "exhibit": answer.exhibit,
        "received": row.received.isoformat(),
        "scores": dict(answer.scores),
        "suggestions": dict(answer.suggestions),
    }
