"""An answer comes in, once however often it is sent, and may be taken back."""

from __future__ import annotations

import asyncio
from dataclasses import dataclass
from typing import Annotated

from fastapi import APIRouter, Path, Request, Response
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import JSONResponse

from survey.errors import AnswerError, StoreError
from survey.questionnaire import Answer, Offers, Questionnaire, submission_id
from survey.store import PATIENCE, Store
from survey.store import Receipt as Committed
from survey.web.api.body import read_json
from survey.web.api.lookup import Questionnaires, find_questionnaire
from survey.web.api.rate_limit import Limit
from survey.web.api.replies import PlainRoute, Receipt, Submission, Withdrawal
from survey.web.api.schema import NO_CODE, UUID_PATTERN

__all__ = ["add_submitting"]

_PATH = "/questionnaires/{key}/submissions"
_TAKES = {
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
        json_schema_extra={"format": "uuid", "pattern": UUID_PATTERN, "not": NO_CODE},
    ),
]


def add_submitting(
    routes: APIRouter, store: Store, questionnaires: Questionnaires, limit: Limit, offers: Offers
) -> None:
    """The routes by which an answer is submitted and withdrawn."""
    routes.add_api_route(
        _PATH,
        _Submitting(store, questionnaires, limit, offers).submit,
        methods=["POST"],
        status_code=201,
        summary="Submit an answer",
        openapi_extra=_TAKES,
        responses={
            201: {"model": Receipt, "description": "Committed"},
            200: {"model": Receipt, "description": "It had been committed before"},
        },
        route_class_override=PlainRoute,
    )

    @routes.delete(
        _PATH + "/{submission}",
        status_code=204,
        summary="Take an answer back by its code",
        responses={202: {"model": Withdrawal, "description": "Deleted, and soon nowhere to be read"}},
    )
    async def withdraw(key: str, submission: Code) -> Response:
        known = submission_id(submission)
        # Answers to a questionnaire that has left the hall can still be taken back.
        gone = await run_in_threadpool(store.take_back, key, known)
        if gone is None:
            raise AnswerError(
                "id", "no such answer", "check the code that was shown after sending", status=404
            )
        erased = asyncio.wrap_future(gone)
        await asyncio.wait([erased], timeout=PATIENCE)
        if erased.done() and erased.result():
            return Response(status_code=204)
        told = Withdrawal(id=known, remains="in unused parts of the database's files, for a short while")
        return JSONResponse(told.model_dump(), 202)


@dataclass(frozen=True)
class _Submitting:
    """Where answers go, and how many at a time. offers: what the place has, None: ask everything."""

    store: Store
    questionnaires: Questionnaires
    limit: Limit
    offers: Offers

    async def submit(self, request: Request) -> JSONResponse:
        """Acknowledged once it is committed. The same id and body again: 200 and still one answer."""
        key = request.path_params["key"]
        data, unreadable = await _body(request)
        taken = False
        try:
            try:
                questionnaire, answer = self._as_asked(key, data, unreadable)
                taken = await self._within(request, answer)
                receipt = await self._commit(questionnaire, answer)
            except AnswerError as refusal:
                # A browser that never heard of its receipt repeats an answer to what was asked then: the version
                # may be gone by now, and the place may ask more, or less.
                questionnaire, answer = await run_in_threadpool(self._as_given, key, data, refusal)
                receipt = await self._commit(questionnaire, answer)
        except StoreError:
            # It will be sent again, by everybody who was here: a full disk must not use up what a class may give.
            if taken:
                self.limit.give_back(_address(request))
            raise
        if receipt.replayed and taken:
            self.limit.give_back(_address(request))
        body = {"id": receipt.id, "questionnaire": key, "version": questionnaire.version}
        return JSONResponse(body, 200 if receipt.replayed else 201)

    async def _commit(self, questionnaire: Questionnaire, answer: Answer) -> Committed:
        return await asyncio.wrap_future(self.store.enqueue(questionnaire, answer))

    def _as_asked(
        self, key: str, data: object, unreadable: AnswerError | None
    ) -> tuple[Questionnaire, Answer]:
        """The whole version, and the answer to what of it is asked here. Raises AnswerError."""
        questionnaire = find_questionnaire(self.questionnaires, key)
        if unreadable is not None:
            raise unreadable
        asked = questionnaire.asking(self.offers)
        if not asked.items:
            problem, remedy = "nothing that it asks about is here yet", "choose another questionnaire"
            raise AnswerError("questionnaire", problem, remedy, status=404)
        return questionnaire, Answer.of(asked, data)

    def _as_given(self, key: str, data: object, refusal: AnswerError) -> tuple[Questionnaire, Answer]:
        """What was asked of the stored answer with the body's id, and the body as an answer to it.

        Raises the refusal where there is none, or the body is no answer to that; 410 where it was withdrawn.
        """
        try:
            submission = submission_id(data.get("id") if isinstance(data, dict) else None)
        except AnswerError:
            raise refusal from None
        asked = self.store.asked_of(key, submission)
        if asked is None:
            raise refusal
        try:
            return asked, Answer.of(asked, data)
        except AnswerError:
            raise refusal from None

    async def _within(self, request: Request, answer: Answer) -> bool:
        """Whether the answer was counted. Raises AnswerError 429 where the address gave too many new answers."""
        wait = self.limit.take(_address(request))
        if wait and not await run_in_threadpool(self.store.known, answer.id):
            problem, remedy = "too many answers from one address", f"send the same again in {wait} s"
            raise AnswerError("", problem, remedy, status=429, wait=wait)
        return wait == 0


async def _body(request: Request) -> tuple[object, AnswerError | None]:
    """The body, or why it is none: whether the questionnaire exists is told first."""
    try:
        return await read_json(request), None
    except AnswerError as error:
        return None, error


def _address(request: Request) -> str:
    return request.client.host if request.client else ""
