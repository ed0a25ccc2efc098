"""The routes: read a questionnaire, submit an answer, take it back, see results; rows only with a token."""

from __future__ import annotations

import asyncio
from typing import Annotated, Any

from fastapi import APIRouter, Path, Request, Response
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import JSONResponse

from survey.answer import Answer, submission_id
from survey.api.body import read_json
from survey.api.finding import Questionnaires, find_questionnaire
from survey.api.limit import Limit
from survey.api.replies import ExplainingRoute, PlainRoute, Receipt, Refusal, Submission
from survey.api.research import add_research
from survey.api.schema import UUID_PATTERN, submission_schema
from survey.errors import AnswerError, StoreError
from survey.questionnaire import Questionnaire
from survey.results import public_results
from survey.store import Store

__all__ = ["described", "router"]

BASE = "/api/v1"
_REFUSALS: dict[int | str, dict[str, Any]] = {"4XX": {"model": Refusal}, 503: {"model": Refusal}}
_TAKES_SUBMISSION = {
    # The route's function takes the request alone, so its parameter is written down here.
    "parameters": [
        {"name": "key", "in": "path", "required": True, "schema": {"type": "string", "title": "Key"}}
    ],
    "requestBody": {
        "required": True,
        "content": {"application/json": {"schema": Submission.model_json_schema()}},
    },
}

Code = Annotated[
    str,
    Path(
        description="the id it was sent with",
        json_schema_extra={"format": "uuid", "pattern": UUID_PATTERN},
    ),
]


def router(store: Store, questionnaires: Questionnaires, limit: Limit | None = None) -> APIRouter:
    """All routes below /api/v1, to be included in any FastAPI app, with a prefix or without.

    questionnaires: looked up anew at each request, so a mapping that reloads its files is served as it is then.
    limit: of new answers per address, the usual one when None.
    """
    routes = APIRouter(prefix=BASE, route_class=ExplainingRoute, tags=["survey"], responses=_REFUSALS)
    # Routes are tried in their order, and most requests submit.
    _add_submitting(routes, store, questionnaires, limit or Limit())
    _add_reading(routes, store, questionnaires)
    add_research(routes, store, questionnaires)
    return routes


def described(questionnaire: Questionnaire) -> dict[str, Any]:
    """A questionnaire as the API and the form page hand it out: items spelled out, nothing left to expand."""
    head = questionnaire.model_dump(
        mode="json", include={"id", "version", "title", "intro", "consent", "retain_until", "scale"}
    )
    modules = [
        module.model_dump(mode="json", include={"id", "title", "intro", "suggestion"})
        | {"items": [item.model_dump(mode="json") for item in questionnaire.items_of(module)]}
        for module in questionnaire.modules
    ]
    return head | {"points": questionnaire.points, "modules": modules}


def _add_reading(routes: APIRouter, store: Store, questionnaires: Questionnaires) -> None:
    @routes.get("/healthz", summary="Is the store there?")
    def healthz() -> dict[str, str]:
        store.alive()
        return {"status": "ok"}

    @routes.get("/questionnaires", summary="All questionnaires")
    def listed() -> list[dict[str, Any]]:
        wanted = {"id", "version", "title"}
        return [found.model_dump(mode="json", include=wanted) for found in list(questionnaires.values())]

    @routes.get("/questionnaires/{key}", summary="One questionnaire with its items")
    def one(key: str) -> dict[str, Any]:
        return described(find_questionnaire(questionnaires, key))

    @routes.get("/questionnaires/{key}/submission.schema.json", summary="What a submission must look like")
    def schema(key: str) -> dict[str, Any]:
        return submission_schema(find_questionnaire(questionnaires, key))

    @routes.get("/questionnaires/{key}/results", summary="Means, from five answers on")
    def results(key: str) -> dict[str, Any]:
        questionnaire = find_questionnaire(questionnaires, key)
        return public_results(questionnaire, store.tally(questionnaire))


def _add_submitting(routes: APIRouter, store: Store, questionnaires: Questionnaires, limit: Limit) -> None:
    path = "/questionnaires/{key}/submissions"

    async def submit(request: Request) -> JSONResponse:
        """Acknowledged once it is committed. The same id and body again: 200 and still one answer."""
        key = request.path_params["key"]
        data, unreadable = await _body(request)
        taken = False
        try:
            questionnaire = find_questionnaire(questionnaires, key)
            if unreadable is not None:
                raise unreadable
            answer = Answer.of(questionnaire, data)
        except AnswerError as refusal:
            # A browser that never heard of its receipt repeats an answer to a version that may be gone by now.
            questionnaire = await run_in_threadpool(_answered, store, key, data)
            if questionnaire is None:
                raise
            answer = _as_then(questionnaire, data, refusal)
        else:
            taken = await _within(limit, request, store, answer)
        try:
            receipt = await asyncio.wrap_future(store.enqueue(questionnaire, answer))
        except StoreError:
            # It will be sent again, by everybody who was here: a full disk must not use up what a class may give.
            if taken:
                limit.give_back(_address(request))
            raise
        if receipt.replayed and taken:
            limit.give_back(_address(request))
        body = {"id": receipt.id, "questionnaire": key, "version": questionnaire.version}
        return JSONResponse(body, 200 if receipt.replayed else 201)

    routes.add_api_route(
        path,
        submit,
        methods=["POST"],
        status_code=201,
        summary="Submit an answer",
        openapi_extra=_TAKES_SUBMISSION,
        responses={
            201: {"model": Receipt, "description": "Committed"},
            200: {"model": Receipt, "description": "It had been committed before"},
        },
        route_class_override=PlainRoute,
    )

    @routes.delete(path + "/{submission}", status_code=204, summary="Take an answer back by its code")
    def withdraw(key: str, submission: Code) -> Response:
        known = submission_id(submission)
        # Answers to a questionnaire that has left the hall can still be taken back.
        if not store.withdraw(key, known):
            raise AnswerError(
                "id", "no such answer", "check the code that was shown after sending", status=404
            )
        return Response(status_code=204)


async def _body(request: Request) -> tuple[object, AnswerError | None]:
    """The body, or why it is none: whether the questionnaire exists is told first."""
    try:
        return await read_json(request), None
    except AnswerError as error:
        return None, error


def _answered(store: Store, key: str, data: object) -> Questionnaire | None:
    """The version that the answer with the body's id was given to, or None where there is no such answer."""
    try:
        return store.version_of(key, submission_id(data.get("id"))) if isinstance(data, dict) else None
    except AnswerError:
        return None


def _as_then(questionnaire: Questionnaire, data: object, refusal: AnswerError) -> Answer:
    try:
        return Answer.of(questionnaire, data)
    except AnswerError:
        raise refusal from None


def _address(request: Request) -> str:
    return request.client.host if request.client else ""


async def _within(limit: Limit, request: Request, store: Store, answer: Answer) -> bool:
    """Whether the answer was counted. Raises AnswerError 429 where the address gave too many new answers."""
    wait = limit.take(_address(request))
    if wait and not await run_in_threadpool(store.known, answer.id):
        problem, remedy = "too many answers from one address", f"send the same again in {wait} s"
        raise AnswerError("", problem, remedy, status=429, wait=wait)
    return wait == 0
