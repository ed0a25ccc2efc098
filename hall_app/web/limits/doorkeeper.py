"""The doorkeeper before the application: an address that asks too much is answered without further work."""

from __future__ import annotations

from starlette.types import ASGIApp, Receive, Scope, Send

from hall_app.web.limits.addresses import Addresses, name_of

__all__ = ["Doorkeeper", "address_of"]

_LATER = (
    "Too many requests from this address. Please try again in a minute. 请求过多，请一分钟后再试。\n".encode()
)
_HEADERS = [
    (b"content-type", b"text/plain; charset=utf-8"),
    (b"retry-after", b"60"),
    (b"content-length", str(len(_LATER)).encode()),
]


class Doorkeeper:
    """ASGI middleware: 429 for requests beyond the address's budget, no handshake for sockets beyond it.

    What it lets through begins when it is its address's turn.
    """

    def __init__(self, app: ASGIApp, addresses: Addresses) -> None:
        self.app, self.addresses = app, addresses

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        kind = {"http": "request", "websocket": "attempt"}.get(scope["type"])
        if kind is None:
            await self.app(scope, receive, send)
            return
        address = address_of(scope)
        await self.addresses.shares.turn(address)
        if self.addresses.take(kind, address):
            await self.app(scope, receive, send)
        elif kind == "request":
            await send({"type": "http.response.start", "status": 429, "headers": _HEADERS})
            await send({"type": "http.response.body", "body": _LATER})
        else:
            await send({"type": "websocket.close", "code": 1008})


def address_of(scope: Scope) -> str:
    """Whom a connection counts for; behind a proxy named in the settings, whom that names."""
    client = scope.get("client")
    return name_of(client[0]) if client else ""
