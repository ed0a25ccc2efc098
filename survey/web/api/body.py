"""Reading a request's body: never more of it than allowed, and JSON without its ambiguities."""

from __future__ import annotations

import json

from fastapi import Request

from survey.errors import AnswerError

__all__ = ["BODY_LIMIT", "read_json"]

BODY_LIMIT = 1_000_000  # bytes
HEARD_OUT = 4_000_000  # bytes of a refused body that are read and thrown away


async def read_json(request: Request) -> object:
    """The decoded body.

    Raises AnswerError: 415 for another content type, 413 for a body over the limit, no more of which is kept,
    400 for what is no JSON; a key that stands twice, NaN and Infinity are none.
    """
    kind = request.headers.get("content-type", "").partition(";")[0].strip().lower()
    if kind != "application/json":
        # A browser asks before it sends this type from a foreign page, and that is refused.
        raise AnswerError(
            "", "the body is not announced as JSON", "send Content-Type: application/json", status=415
        )
    announced = request.headers.get("content-length", "")
    if announced.isdecimal() and int(announced) > HEARD_OUT:
        raise _too_large()
    body, size = bytearray(), 0
    async for part in request.stream():
        size += len(part)
        if size <= BODY_LIMIT:
            body += part
        elif size > HEARD_OUT:
            raise _too_large()
    if size > BODY_LIMIT:
        # Only now: who still sends when the connection closes sees it break and never hears why.
        raise _too_large()
    try:
        return json.loads(body.decode("utf-8"), object_pairs_hook=_unique, parse_constant=_refuse)
    except (ValueError, RecursionError) as error:
        # int() refuses thousands of digits with a ValueError, too; its text tells nothing to a visitor.
        what = str(error) if isinstance(error, json.JSONDecodeError | _NotJson) else "undecodable"
        raise AnswerError(
            "", f"the body is no JSON ({what})", "send one JSON object in UTF-8", status=400
        ) from None


class _NotJson(ValueError):
    pass


def _unique(pairs: list[tuple[str, object]]) -> dict[str, object]:
    table = dict(pairs)
    if len(table) != len(pairs):
        raise _NotJson("a key stands twice")
    return table


def _refuse(constant: str) -> object:
    raise _NotJson(f"{constant} is no JSON number")


def _too_large() -> AnswerError:
    return AnswerError(
        "", f"the body is over {BODY_LIMIT // 1_000_000} MB", "shorten the suggestions", status=413
    )
