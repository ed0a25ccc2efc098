"""A body that is compressed once, not per visitor, and answered as the browser understands it."""

from __future__ import annotations

import gzip
import threading
from dataclasses import dataclass, field
from hashlib import sha256
from typing import Literal

from fastapi import Request
from fastapi.responses import Response

from hall_app.show.compression import best_frame
from hall_app.web.answers.work import SLOW

__all__ = ["FOR_GOOD", "PRIVATE", "REVALIDATED", "Coding", "Packed", "accepted"]

Coding = Literal["zstd", "gzip", "identity"]

FOR_GOOD = "public, max-age=31536000, immutable"  # where the address names the version
REVALIDATED = "no-cache"
PRIVATE = "private, no-cache"  # with a word for this browser alone

_SMALL = 512  # [bytes] below that, packing gains nothing


def accepted(header: str) -> tuple[Coding, ...]:
    """Content codings of an Accept-Encoding header that we offer, best first; "identity" is always last."""
    wanted = {}
    for part in header.lower().split(","):
        name, _, quality = part.partition(";")
        try:
            wanted[name.strip()] = float(quality.strip().removeprefix("q=") or 1)
        except ValueError:
            continue  # no number: not asked for
    return (*(coding for coding in ("zstd", "gzip") if wanted.get(coding, 0) > 0), "identity")


@dataclass
class Packed:
    """body: as it is; media_type: with its charset. Each coding is made at its first request and kept."""

    body: bytes
    media_type: str
    _coded: dict[str, bytes] = field(default_factory=dict, repr=False)
    _making: threading.Lock = field(default_factory=threading.Lock, repr=False)

    def __post_init__(self) -> None:
        self.digest = sha256(self.body).hexdigest()[:16]

    def coded(self, coding: Coding) -> bytes:
        """The body under `coding`; slow the first time."""
        if coding == "identity" or len(self.body) < _SMALL:
            return self.body
        with self._making:
            if coding not in self._coded:
                self._coded[coding] = (
                    best_frame(self.body) if coding == "zstd" else gzip.compress(self.body, 9, mtime=0)
                )
            return self._coded[coding]

    async def answer(self, request: Request, cache: str = REVALIDATED) -> Response:
        """200 or, where the browser has it already, 304."""
        coding = accepted(request.headers.get("accept-encoding", ""))[0]
        if len(self.body) < _SMALL:
            coding = "identity"
        tag = f'"{self.digest}-{coding}"'
        told = {"ETag": tag, "Vary": "Accept-Encoding", "Cache-Control": cache}
        if tag in (
            name.strip().removeprefix("W/") for name in request.headers.get("if-none-match", "").split(",")
        ):
            return Response(status_code=304, headers=told)
        if coding == "identity":
            return Response(self.body, media_type=self.media_type, headers=told)
        told["Content-Encoding"] = coding
        data = self._coded.get(coding)
        if data is None:
            data = await SLOW.of((self.digest, coding), lambda: self.coded(coding))
        return Response(data, media_type=self.media_type, headers=told)
