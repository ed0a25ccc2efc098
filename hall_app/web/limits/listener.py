"""uvicorn's server: connections are taken in a few at a time, and looked after while they are open."""

from __future__ import annotations

import socket
from typing import Any

import uvicorn

from hall_app.web.limits.open_lines import OpenLines

__all__ = ["AT_A_TIME", "Listener"]

AT_A_TIME = (
    16  # connections accepted before the first of them is counted: asyncio's loop takes a whole backlog
)
_WAITING = 2048  # that the system keeps for us meanwhile
_SWEEP = 50  # of uvicorn's ticks, ten a second


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
