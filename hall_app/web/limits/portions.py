"""Answers in portions: what a browser has not taken yet stays one body shared by all, not a copy for each."""

from __future__ import annotations

from starlette.types import ASGIApp, Message, Receive, Scope, Send

__all__ = ["PORTION", "Portions"]

PORTION = 64 << 10  # [bytes]


class Portions:
    """ASGI middleware: the server waits between portions until the last one has been taken."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        async def portioned(message: Message) -> None:
            body = message.get("body", b"")
            if message["type"] != "http.response.body" or len(body) <= PORTION:
                await send(message)
                return
            view, more = memoryview(body), message.get("more_body", False)
            for begin in range(0, len(view), PORTION):
                last = begin + PORTION >= len(view)
                portion = bytes(view[begin : begin + PORTION])
                await send({"type": message["type"], "body": portion, "more_body": more or not last})

        await self.app(scope, receive, portioned if scope["type"] == "http" else send)
