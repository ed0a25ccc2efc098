"""The walk socket: one visitor a connection. Text in, text out; what is not understood is left alone."""

from __future__ import annotations

import asyncio
import contextlib
import json
import math
import time
from typing import Any

from fastapi import FastAPI
from starlette.websockets import WebSocket, WebSocketDisconnect

from ..house import House
from ..visitors import Visitor
from .origin import same_origin
from .relay import MOST_VISITORS

__all__ = ["add_walk_socket"]

_LONGEST = 64 << 10  # [bytes] of one message
_HELLO_WITHIN = 30.0  # [s]
_TICK = 1 / 60  # [s]


def add_walk_socket(app: FastAPI, house: House) -> None:
    """Serve `/walk`."""

    @app.websocket("/walk")
    async def walk(socket: WebSocket) -> None:
        if not same_origin(socket):
            await socket.close(1008)
            return
        await socket.accept()
        if len(house.visitors) >= MOST_VISITORS:
            await socket.close(1013, "the hall is full")
            return
        with contextlib.suppress(WebSocketDisconnect, asyncio.TimeoutError, RuntimeError):
            async with asyncio.timeout(_HELLO_WITHIN):
                while (hello := await _receive(socket)).get("t") != "hello":
                    pass  # sent while a lost connection came back
            await _Visit(house, socket, hello).run()


async def _receive(socket: WebSocket) -> dict[str, Any]:
    """The next message; {} for what is no JSON object."""
    event = await socket.receive()
    text = event.get("text")
    if event["type"] == "websocket.disconnect" or text is None or len(text) > _LONGEST:
        raise WebSocketDisconnect(1009)
    try:
        message = json.loads(text)
    except (ValueError, RecursionError):
        return {}
    return message if isinstance(message, dict) else {}


class _Visit:
    """One connection from hello to goodbye."""

    def __init__(self, house: House, socket: WebSocket, hello: dict[str, Any]) -> None:
        self.house, self.socket = house, socket
        able = hello.get("able") == "predict" and house.walk_mode == "predict"
        display = "viser" if hello.get("display") == "viser" else "page"
        self.visitor: Visitor = house.welcome(
            time.monotonic(), "predict" if able else "server", display, hello.get("at")
        )
        self.visitor.client = house.scene.marks.client_of(hello.get("client"))

    async def run(self) -> None:
        tasks = [asyncio.create_task(self._listen()), asyncio.create_task(self._speak())]
        if self.visitor.walk.mode == "server":
            tasks.append(asyncio.create_task(self._integrate()))
        try:
            pose = self.visitor.walk.pose
            self.visitor.say(
                {
                    "t": "hi",
                    "mode": self.visitor.walk.mode,
                    "x": pose.x,
                    "z": pose.z,
                    "eye": pose.eye,
                    "yaw": pose.yaw,
                }
            )
            self.house.stage.stood_at(self.visitor, pose.x, pose.z)
            await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        finally:
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)
            self.house.farewell(self.visitor)

    async def _speak(self) -> None:
        while (message := await self.visitor.outbox.get()) is not None:
            await self.socket.send_text(json.dumps(message, allow_nan=False))

    async def _listen(self) -> None:
        act = {
            "in": self._inputs,
            "keys": self._keys,
            "goto": self._goto,
            "open": self._open,
            "client": self._client,
            "close": lambda message: self.house.stage.close(self.visitor),
        }
        while True:
            message = await _receive(self.socket)
            kind = message.get("t")
            if isinstance(kind, str) and kind in act:
                act[kind](message)

    def _inputs(self, message: dict[str, Any]) -> None:
        items = message.get("in")
        if isinstance(items, list):
            reply = self.visitor.walk.inputs(items, time.monotonic())
            self.visitor.say(reply.message())
            self._stood()

    def _keys(self, message: dict[str, Any]) -> None:
        held = (message.get(name) for name in ("forward", "right", "yaw", "eye"))
        self.visitor.walk.keys(*held, now=time.monotonic())

    def _goto(self, message: dict[str, Any]) -> None:
        self.visitor.say(self.visitor.walk.goto(message.get("x"), message.get("z")).message())
        self._stood()

    def _client(self, message: dict[str, Any]) -> None:
        """viser's socket had to connect again: the page is another client there now."""
        self.visitor.client = self.house.scene.marks.client_of(message.get("client"))
        if self.visitor.opened is not None:
            self.house.stage.open(self.visitor, self.visitor.opened)

    def _open(self, message: dict[str, Any]) -> None:
        exhibit = message.get("id")
        if isinstance(exhibit, str):
            self.house.stage.open(self.visitor, exhibit)

    def _stood(self) -> None:
        pose = self.visitor.walk.pose
        self.house.stage.stood_at(self.visitor, pose.x, pose.z)

    async def _integrate(self) -> None:
        """Server mode: walk what is held, 60 times a second, and tell where that leads."""
        last: tuple[float, ...] = (math.nan,)
        while True:
            await asyncio.sleep(_TICK)
            reply = self.visitor.walk.tick(time.monotonic())
            pose = self.visitor.walk.pose
            now = (pose.x, pose.z, pose.yaw, pose.eye)
            if now == last:
                continue
            last = now
            self._stood()
            if self.visitor.display == "viser" and self.visitor.client is not None:
                eye = (pose.x, pose.eye, pose.z)
                self.house.scene.aim_camera(self.visitor.client, eye, pose.yaw)
            self.visitor.say(reply.message())
