"""Whether a form that comes in is one that this hall handed out to this browser, and how it is read."""

from __future__ import annotations

import hmac
from hashlib import sha256
from urllib.parse import parse_qsl, urlsplit

from starlette.requests import Request

from hall_app.house.people import PeopleError

__all__ = ["SEAL", "check_form", "check_origin", "form_of", "seal_of"]

SEAL = "seal"  # the hidden field
LARGEST = 20_000  # [bytes] of a form
_FIELDS = 200


def seal_of(key: str, token: str) -> str:
    """What a form brings back. key: of the browser; token: of its session, "" for none.

    Signing in makes older forms void.
    """
    return hmac.new(key.encode(), f"form {token}".encode(), sha256).hexdigest()[:40]


async def form_of(request: Request) -> dict[str, str]:
    """The fields of a plain form; of those that stand twice the values in a row, parted by blanks.

    Raises PeopleError.
    """
    kind = request.headers.get("content-type", "").partition(";")[0].strip().lower()
    if kind != "application/x-www-form-urlencoded":
        raise PeopleError("form-size")
    body = bytearray()
    async for part in request.stream():
        body += part
        if len(body) > LARGEST:
            raise PeopleError("form-size")
    try:
        pairs = parse_qsl(body.decode("utf-8"), keep_blank_values=True, max_num_fields=_FIELDS)
    except ValueError:
        raise PeopleError("form-size") from None
    fields: dict[str, str] = {}
    for name, value in pairs:
        fields[name] = f"{fields[name]} {value}" if name in fields else value
    return fields


def check_origin(request: Request) -> None:
    """Raises PeopleError for what another site's page sends. A browser says with every POST where it comes from."""
    origin, own = request.headers.get("origin"), request.headers.get("host", "").lower()
    if origin is None:
        good = request.headers.get("sec-fetch-site") == "same-origin"
    else:
        try:
            good = bool(own) and urlsplit(origin).netloc.lower() == own
        except ValueError:
            good = False
    if not good:
        raise PeopleError("form")


def check_form(given: str, seal: str) -> None:
    """Raises PeopleError."""
    if not hmac.compare_digest(given.encode(), seal.encode()):
        raise PeopleError("form")
