"""Whether a form that comes in is one that this hall handed out to this browser, and how it is read."""

from __future__ import annotations

import hmac
from collections.abc import AsyncGenerator
from dataclasses import dataclass
from hashlib import sha256
from urllib.parse import parse_qsl, urlsplit

from starlette.datastructures import UploadFile
from starlette.formparsers import MultiPartException, MultiPartParser
from starlette.requests import Request

from hall_app.house.people import PeopleError
from hall_app.web.platform.counter.asking import Brought

__all__ = ["PLAIN", "SEAL", "Form", "Takes", "check_form", "check_origin", "form_of", "is_whole", "seal_of"]

SEAL = "seal"  # the hidden field
_FIELDS = 200
_MULTIPART = "multipart/form-data"


@dataclass(frozen=True)
class Takes:
    """largest: [bytes] of a form, its files included; files: how many it may bring."""

    largest: int = 20_000
    files: int = 0


@dataclass(frozen=True)
class Form:
    """What came: of fields that stand twice the values in a row, parted by blanks."""

    fields: dict[str, str]
    files: tuple[Brought, ...] = ()

    def close(self) -> None:
        for one in self.files:
            one.file.close()


PLAIN = Takes()


def seal_of(key: str, token: str) -> str:
    """What a form brings back. key: of the browser; token: of its session, "" for none.

    Signing in makes older forms void.
    """
    return hmac.new(key.encode(), f"form {token}".encode(), sha256).hexdigest()[:40]


async def form_of(request: Request, takes: Takes = PLAIN) -> Form:
    """Raises PeopleError for what is too large, and for what is no form."""
    kind = request.headers.get("content-type", "").partition(";")[0].strip().lower()
    if takes.files and kind == _MULTIPART:
        return await _with_files(request, takes)
    if kind != "application/x-www-form-urlencoded":
        raise PeopleError("form-kind")
    body = bytearray()
    async for part in _bounded(request, takes):
        body += part
    try:
        pairs = parse_qsl(body.decode("utf-8"), keep_blank_values=True, max_num_fields=_FIELDS)
    except ValueError:
        raise PeopleError("form-kind") from None
    return _whole(Form(_fields(pairs)))


async def _with_files(request: Request, takes: Takes) -> Form:
    """Files lie on the disk, beyond a megabyte, until the form is closed."""
    parser = MultiPartParser(
        request.headers,
        _bounded(request, takes),
        max_files=takes.files,
        max_fields=_FIELDS,
        max_part_size=takes.largest,
    )
    try:
        items = (await parser.parse()).multi_items()
    except PeopleError:
        raise
    except (MultiPartException, ValueError, KeyError):  # of the library that it stands on
        raise PeopleError("form-kind") from None
    plain = [(name, value) for name, value in items if isinstance(value, str)]
    brought = [
        Brought(name, value.filename or "", value.file, value.size or 0)
        for name, value in items
        if isinstance(value, UploadFile)
    ]
    return _whole(Form(_fields(plain), tuple(brought)))


def _whole(form: Form) -> Form:
    """Raises PeopleError."""
    if not all(map(is_whole, form.fields.values())):
        form.close()
        raise PeopleError("form-kind")
    return form


def is_whole(text: str) -> bool:
    """Whether no letter of it is half of one, and none is NUL: not every database takes these."""
    return not any(letter == "\0" or "\ud800" <= letter <= "\udfff" for letter in text)


async def _bounded(request: Request, takes: Takes) -> AsyncGenerator[bytes, None]:
    size = 0
    async for part in request.stream():
        size += len(part)
        if size > takes.largest:
            raise PeopleError("form-size")
        yield part


def _fields(pairs: list[tuple[str, str]]) -> dict[str, str]:
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
