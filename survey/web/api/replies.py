"""Refusals as JSON {"field", "problem", "remedy"}, and the models that document what the API takes and gives."""

from __future__ import annotations

from collections.abc import Callable, Coroutine
from typing import Annotated, Any, Literal

from fastapi import Request, Response
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from fastapi.routing import APIRoute
from pydantic import BaseModel, ConfigDict, Field

from survey.errors import AnswerError, StoreError
from survey.questionnaire import SLUG, TEXT_LIMIT
from survey.web.api.schema import NO_CODE, UUID_PATTERN

__all__ = ["ExplainingRoute", "PlainRoute", "Receipt", "Refusal", "Submission", "Withdrawal", "refused"]

RETRY_SECONDS = 5

Handler = Callable[[Request], Coroutine[Any, Any, Response]]


class Refusal(BaseModel):
    """Why a request was refused: which field, what is wrong, what to do."""

    field: str
    problem: str
    remedy: str


class Receipt(BaseModel):
    """The answer is stored."""

    id: str
    questionnaire: str
    version: int


class Withdrawal(BaseModel):
    """The answer is deleted, and where its last bytes can still be read until nobody reads the database."""

    id: str
    remains: str


class Submission(BaseModel):
    """What to send. This model documents; the questionnaire itself decides which items and points exist."""

    model_config = ConfigDict(extra="forbid")

    id: str = Field(
        pattern=UUID_PATTERN,
        json_schema_extra={"format": "uuid", "not": NO_CODE},
        description="made by the sender; repeat it to retry",
    )
    version: int = Field(ge=1)
    language: Literal["zh", "en"]
    consent: Literal[True]
    scores: dict[str, Annotated[int, Field(ge=1)] | None] = Field(description="every item; null: not seen")
    suggestions: dict[str, Annotated[str, Field(max_length=TEXT_LIMIT)]] = Field(
        default={}, description="by module"
    )
    exhibit: str | None = Field(
        default=None, pattern=f"^{SLUG}$", description="at which exhibit it was asked"
    )


def refused(error: AnswerError) -> JSONResponse:
    """The refusal as a response. After a body that was not read to its end the connection is closed."""
    headers = {"Connection": "close"} if error.status in (413, 415) else {}
    if error.status == 401:
        headers["WWW-Authenticate"] = "Bearer"
    if error.wait:
        headers["Retry-After"] = str(error.wait)
    body = {"field": error.field, "problem": error.problem, "remedy": error.remedy}
    return JSONResponse(body, error.status, headers)


def _explained(error: RequestValidationError) -> AnswerError:
    first = error.errors()[0]
    field = str(first["loc"][-1])[:60]
    if first["type"] == "extra_forbidden":
        return AnswerError(field, "unknown parameter", "leave it out or correct its spelling")
    return AnswerError(field, str(first["msg"]).lower(), f"correct {field}")


def _unavailable(error: StoreError, *, reading: bool) -> JSONResponse:
    """503. reading: nothing was sent that could have been stored, so the error's own remedy is told."""
    problem, remedy = error.problem, "nothing was stored; send the same again later"
    if reading:
        problem, _, own = problem.partition(" – ")
        remedy = own or "ask again later"
    body = {"field": "", "problem": problem, "remedy": remedy}
    return JSONResponse(body, 503, {"Retry-After": str(RETRY_SECONDS)})


class ExplainingRoute(APIRoute):
    """A route that answers every foreseeable failure with a Refusal, so that any app can mount the router."""

    def get_route_handler(self) -> Handler:
        handle = self.handler()

        async def explaining(request: Request) -> Response:
            try:
                return await handle(request)
            except AnswerError as error:
                return refused(error)
            except RequestValidationError as error:
                return refused(_explained(error))
            except StoreError as error:
                return _unavailable(error, reading=request.method in ("GET", "HEAD"))

        return explaining

    def handler(self) -> Handler:
        """What answers where nothing fails."""
        return super().get_route_handler()


class PlainRoute(ExplainingRoute):
    """A route whose function takes the request alone and returns a response.

    FastAPI would look for its parameters at each request, a third of what a submission costs apart from its commit.
    """

    def handler(self) -> Handler:
        return self.endpoint
