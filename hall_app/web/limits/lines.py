"""uvicorn with the doors narrowed: what one connection may cost before the application hears of it.

Its protocols read little at a time, its server takes connections in a few at a time and looks after them.
"""

from __future__ import annotations

import asyncio
import socket
from collections.abc import Collection
from typing import Any

import uvicorn
from uvicorn.protocols.http.httptools_impl import HttpToolsProtocol
from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol

from hall_app.web.limits.addresses import Addresses, name_of
from hall_app.web.limits.budgets import Bucket, Rate
from hall_app.web.limits.open_lines import OpenLine, OpenLines

__all__ = ["AT_A_TIME", "LONGEST", "Listener", "Socket", "line_class"]

LONGEST = 64 << 10  # [bytes] of one message: what a browser sends us is small
_BITE = 4 << 10  # [bytes] read at a time: a flood of tiny frames leaves the others their turn
_REST = 0.01  # [s] between two bites from a page that was thrown out
_FAREWELL = 1.0  # [s] for a page that was thrown out to hang up by itself
_CONTROL = Rate(60, 5)  # pings, pongs and fragments; a browser sends a pong in 20 s
_POLICY_VIOLATION = 1008
AT_A_TIME = 16  # connections accepted before the first is counted: asyncio's loop takes a whole backlog
_WAITING = 2048  # that the system keeps for us meanwhile
_SWEEP = 50  # of uvicorn's ticks, ten a second
_PIPELINED = 16  # requests of one connection that wait for the one before; browsers send none ahead


class _InBites(asyncio.BufferedProtocol):
    """Reads little at a time, whatever the protocol makes of it."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self._bite = bytearray(_BITE)

    def get_buffer(self, sizehint: int) -> bytearray:
        return self._bite

    def buffer_updated(self, nbytes: int) -> None:
        self.data_received(bytes(self._bite[:nbytes]))  # type: ignore[attr-defined]


class Socket(_InBites, WebSocketsSansIOProtocol):
    """A WebSocket that reads nothing more once it has been thrown out."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self._thrown_out = False
        self.line: OpenLine | None = None
        self._control = Bucket(_CONTROL.burst, self.loop.time())

    def connection_lost(self, exc: Exception | None) -> None:
        super().connection_lost(exc)
        if self.line is not None:
            self.line.end()

    def buffer_updated(self, nbytes: int) -> None:
        if not self._thrown_out:
            super().buffer_updated(nbytes)
            return
        # Read on, or the close frame would be lost with what is unread; but look at nothing, and leave others the loop.
        self.transport.pause_reading()
        self.loop.call_later(_REST, self._read_on)

    def _read_on(self) -> None:
        if not self.transport.is_closing():
            self.transport.resume_reading()

    def handle_ping(self) -> None:
        if self._bearable():
            super().handle_ping()

    def handle_pong(self, event: Any) -> None:
        if self._bearable():
            super().handle_pong(event)

    def handle_cont(self, event: Any) -> None:
        if self._bearable():
            super().handle_cont(event)

    def _bearable(self) -> bool:
        self._control = self._control.filled(_CONTROL, self.loop.time()).less(1)
        if self._control.left < 0:
            self.transport.abort()
        return self._control.left >= 0

    async def send(self, message: Any) -> None:
        if message["type"] == "websocket.close" and message.get("code") == _POLICY_VIOLATION:
            self.close_timeout, self._thrown_out = _FAREWELL, True
        await super().send(message)


def line_class(addresses: Addresses, lines: OpenLines, proxies: Collection[str]) -> type[HttpToolsProtocol]:
    """The protocol of a TCP connection: cut at once where its address opens too many. Proxies open any number."""
    trusted = {name_of(proxy) for proxy in proxies}

    class Line(_InBites, HttpToolsProtocol):
        line: OpenLine | None = None

        def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
            super().connection_made(transport)
            address = self.client[0] if self.client else ""
            proxy = name_of(address) in trusted
            if not proxy and not addresses.take("line", address):
                transport.abort()
                return
            self.line = lines.come(transport, address, proxy=proxy)

        def connection_lost(self, exc: Exception | None) -> None:
            super().connection_lost(exc)
            if self.line is not None:
                self.line.end()

        def on_headers_complete(self) -> None:
            if len(self.pipeline) >= _PIPELINED:
                raise BufferError("too many requests ahead")  # ends the parser: a bad request, and the line
            super().on_headers_complete()

        def on_message_complete(self) -> None:
            super().on_message_complete()
            if self.line is not None and self.cycle is not None and not self.cycle.response_complete:
                self.line.asked()

        def on_response_complete(self) -> None:
            more = bool(self.pipeline)
            super().on_response_complete()
            if self.line is not None and not more:
                self.line.answered()

        def handle_websocket_upgrade(self) -> None:
            if self.line is not None:
                self.line.asked()
            super().handle_websocket_upgrade()
            upgraded = self.transport.get_protocol()
            if isinstance(upgraded, Socket):
                upgraded.line = self.line  # the connection is the socket's from now on

    return Line


class Listener(uvicorn.Server):
    """A server that keeps `lines` in bounds."""

    def __init__(self, config: uvicorn.Config, lines: OpenLines) -> None:
        super().__init__(config)
        self._lines = lines

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await super().startup(sockets)
        for server in getattr(self, "servers", ()):
            for listening in server.sockets:
                with listening.dup() as same:
                    same.listen(_WAITING)  # asyncio has told the system AT_A_TIME

    async def on_tick(self, counter: int) -> Any:
        if counter % _SWEEP == 0:
            self._lines.sweep()
        return await super().on_tick(counter)
