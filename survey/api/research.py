"""What only a researcher may read, with a bearer token: rows, suggestions, files, the analysis."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Depends, Query, Request, Response, Security
from fastapi.security import HTTPBearer

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
_FILE = {
    200: {"content": {kind.partition(";")[0]: {} for kind in _MEDIA.values()}, "description": "The file"}
}

Version = Annotated[int | None, Query(ge=1, le=10_000, description="the current one when left out")]
Format = Literal["csv", "xlsx", "sav", "json", "codebook", "r"]
Drop = Annotated[
    str, Query(max_length=2000, pattern=r"^[^\x00]*$", description="none, a tag such as static, or ITEM,ITEM")
]
Factors = Annotated[str, Query(pattern=r"^(kaiser|parallel|[1-9][0-9]?)$", description="or a number")]
Resamples = Annotated[int, Query(ge=0, le=1000, description="of the intervals; 0: none")]
Seed = Annotated[int, Query(ge=0, lt=2**31, description="of everything random")]


def add_research(routes: APIRouter, store: Store, questionnaires: Mapping[str, Questionnaire]) -> None:
    """The guarded routes."""
    # Declared beside the store, so that a route of this group cannot be written without its guard.
    research = APIRouter(
        route_class=ExplainingRoute, dependencies=[Security(_BEARER), Depends(_token_guard(store))]
    )

    def asked(key: str, version: int | None) -> tuple[Questionnaire, tuple[Stored, ...]]:
        current = questionnaires.get(key)
        if current is None or (version is not None and version != current.version):
            current = store.frozen(key, version) if version is not None else None
        if current is None:
            raise AnswerError(
                "version", "no such version has answers", "leave it out for the current one", status=404
            )
        return current, store.rows(current)

    @research.get("/questionnaires/{key}/rows", summary="All answers (token)")
    def rows(key: str, version: Version = None) -> list[dict[str, Any]]:
        return [_row(row) for row in asked(key, version)[1]]

    @research.get("/questionnaires/{key}/suggestions", summary="All suggestions (token)")
    def suggestions(key: str, version: Version = None) -> list[dict[str, Any]]:
        found = [
            (row, module, text) for row in asked(key, version)[1] for module, text in row.answer.suggestions
        ]
        return [
            {"submission": row.answer.id, "language": row.answer.language, "module": module, "text": text}
            for row, module, text in found
        ]

    @research.get(
        "/questionnaires/{key}/export/{kind}",
        summary="All answers as a file (token)",
        response_class=Response,
        responses=_FILE,
    )
    def export(key: str, kind: Format, version: Version = None) -> Response:
        questionnaire, found = asked(key, version)
        name = file_name(kind, questionnaire)
        headers = {"Content-Disposition": f'attachment; filename="{name}"', "Cache-Control": "no-store"}
        return Response(exported(kind, questionnaire, found), media_type=_MEDIA[kind], headers=headers)

    @research.get("/questionnaires/{key}/analysis", summary="The analysis, as survey analyse --json (token)")
    def analysis(
        key: str,
        version: Version = None,
        drop: Drop = "none",
        rotation: Literal["varimax", "oblimin", "none"] = "varimax",
        factors: Factors = "kaiser",
        missing: Literal["listwise", "pairwise"] = "listwise",
        bootstrap: Resamples = 0,
        seed: Seed = 0,
    ) -> dict[str, Any]:
        """Answers that cannot be analysed are a 422 that says why: too few, all the same, an item twice …"""
        # numpy, scipy and factor_analyzer are loaded when the first analysis is asked for.
        from survey.analysis import analyse
        from survey.analysis.errors import AnalysisError
        from survey.analysis.pipeline import Settings
        from survey.analysis.summary import summary
        from survey.working import dropped, scores_table

        questionnaire, found = asked(key, version)
        table = scores_table(questionnaire, found)
        settings = Settings(
            drop=dropped(drop, questionnaire),
            factors=int(factors) if factors.isdecimal() else factors,
            rotation=rotation,
            missing=missing,
            bootstrap=bootstrap,
            seed=seed,
        )
        try:
            return summary(analyse(table.scores, table.items, settings=settings))
        except AnalysisError as error:
            raise AnswerError(error.code, str(error), "change drop, missing or factors", status=422) from None

    routes.include_router(research)


def _token_guard(store: Store) -> Callable[..., None]:
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
