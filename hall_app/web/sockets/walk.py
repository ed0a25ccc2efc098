"""The walk socket: one visitor a connection. Text in, text out; what is not understood is left alone."""

from __future__ import annotations

import asyncio
import contextlib
import math
import time
from collections.abc import Coroutine
from typing import Any

import msgspec
from fastapi import FastAPI
from starlette.websockets import WebSocket, WebSocketDisconnect

from hall_app.house.house import House
from hall_app.visit.places import KEPT, Places, Ticket
from hall_app.visit.visitors import Visitor
from hall_app.web.limits.addresses import Addresses
from hall_app.web.limits.budgets import WALK, Allowance
from hall_app.web.limits.doorkeeper import address_of
from hall_app.web.sockets.origin import key_of, known_key, same_origin, with_key
from hall_app.web.sockets.relay import Views
from hall_app.web.sockets.tasks import until_first

__all__ = ["add_walk_socket"]

_HELLO_WITHIN = 15.0  # [s]; the page waits 3 s at most for viser's mark
_TICK = 1 / 60  # [s]
_LOOK = 10.0  # [s] between two looks of one who waits for somebody who has been away
_LONGEST_PAGE = 64  # characters
_UNSUPPORTED = 1003
_POLICY_VIOLATION = 1008
_TRY_AGAIN_LATER = 1013
# What is paid by the message; "in" is by the input.
_KINDS = frozenset({"keys", "goto", "open", "close", "compare", "client", "stands"})


def add_walk_socket(app: FastAPI, house: House, views: Views, addresses: Addresses) -> None:
    """Serve `/walk`: hello, the queue where the hall is full, the walk."""

    @app.websocket("/walk")
    async def walk(socket: WebSocket) -> None:
        address = address_of(socket.scope)
        if not same_origin(socket) or not addresses.take("socket", address):
            await socket.close(_POLICY_VIOLATION)
            return
        silent = addresses.silent(address)
        if silent is None:
            await socket.close(_TRY_AGAIN_LATER)
            return
        key = key_of(socket)
        line = _Line(socket, addresses, address)
        with contextlib.suppress(WebSocketDisconnect, RuntimeError):
            try:
                async with asyncio.timeout(_HELLO_WITHIN) as patience:
                    silent.throw_out = lambda: _end_now(patience)
                    await socket.accept(headers=with_key(socket, key))
                    while (hello := await line.receive()).get("t") != "hello":
                        pass  # sent while a lost connection came back
            except TimeoutError:
                await socket.close(_POLICY_VIOLATION, "no hello")
                return
            finally:
                silent.end()
            ticket = house.places.ask(key, address, _page(hello))
            if ticket is None:
                await socket.close(_TRY_AGAIN_LATER, "the hall is full")
                return
            views.dismiss(key)
            line.ticket = ticket
            try:
                await _queue(line, ticket, house.places)
                views.look_again()
                await _Visit(house, line, hello).run(ticket.given_up)
            finally:
                _part(ticket, house.places, views, comes_back=line.welcome and known_key(socket) is not None)
            if ticket.given_up.is_set():
                await socket.close(_TRY_AGAIN_LATER, "away")  # the page asks again when there is somebody


def _end_now(patience: asyncio.Timeout) -> None:
    with contextlib.suppress(RuntimeError):  # it ends already
        patience.reschedule(0)


def _page(hello: dict[str, Any]) -> str:
    """By which a page is known again on another line; "" for none."""
    page = hello.get("page")
    return page if isinstance(page, str) and len(page) <= _LONGEST_PAGE else ""


def _part(ticket: Ticket, places: Places, views: Views, *, comes_back: bool) -> None:
    """Keep the place of a browser that may be back in a moment; whoever has no key could not be known again."""

    def gone() -> None:
        places.expire()
        views.dismiss(ticket.key)

    if not comes_back or ticket.given_up.is_set():
        ticket.leave()
        gone()
        return
    ticket.step_out()
    asyncio.get_running_loop().call_later(KEPT + 0.1, gone)


class _Line:
    """One socket within its budget: every message is paid for, what exceeds is dropped, who goes on is closed."""

    def __init__(self, socket: WebSocket, addresses: Addresses, address: str) -> None:
        self._socket, self._addresses, self._address = socket, addresses, address
        self._allowance = Allowance(WALK, time.monotonic())
        self.ticket: Ticket | None = None
        self.welcome = True  # not thrown out

    async def receive(self) -> dict[str, Any]:
        """The next message that is served. Raises WebSocketDisconnect when the socket is closed, from here or there."""
        while True:
            event = await self._socket.receive()
            if event["type"] == "websocket.disconnect":
                raise WebSocketDisconnect(event.get("code", 1005))
            text = event.get("text")
            if text is None:
                await self._socket.close(_UNSUPPORTED, "text only")
                raise WebSocketDisconnect(_UNSUPPORTED)
            await self._addresses.shares.turn(self._address)
            now = time.monotonic()
            if await self._served("messages", now) and await self._served("bytes", now, len(text)):
                message = _read(text)
                if await self._served(*_price(message, now)) and message:
                    if self.ticket is not None:
                        self.ticket.here()
                    return message

    async def _served(self, kind: str, now: float, amount: float = 1) -> bool:
        verdict = self._allowance.take(kind, now, amount)
        if verdict == "leave":
            self.welcome = False
            self._addresses.throw_out(self._address)
            await self._socket.close(_POLICY_VIOLATION, f"too much: {kind}")
            raise WebSocketDisconnect(_POLICY_VIOLATION)
        return verdict == "serve"

    async def say(self, message: dict[str, Any]) -> None:
        await self._socket.send_text(msgspec.json.encode(message).decode())


def _price(message: dict[str, Any], now: float) -> tuple[str, float, float]:
    """The bucket a message is paid from, when, and how much."""
    kind = message.get("t")
    if kind == "in":
        inputs = message.get("in")
        return "inputs", now, len(inputs) if isinstance(inputs, list) else 1
    return kind if isinstance(kind, str) and kind in _KINDS else "other", now, 1


def _read(text: str) -> dict[str, Any]:
    """The message; {} for what is no JSON object."""
    try:
        message = msgspec.json.decode(text)
    except (msgspec.MsgspecError, ValueError, RecursionError):
        return {}
    return message if isinstance(message, dict) else {}


async def _queue(line: _Line, ticket: Ticket, places: Places) -> None:
    """Until it is this visitor's turn, say the place whenever it changes. What a waiting page asks for is dropped."""
    told, hearing = 0, asyncio.ensure_future(line.receive())
    try:
        while not ticket.inside:
            ticket.changed.clear()
            if ticket.place != told:
                told = ticket.place
                await line.say({"t": "queue", "place": told})
            places.give_away()
            changed = asyncio.ensure_future(ticket.changed.wait())
            await asyncio.wait({changed, hearing}, timeout=_LOOK, return_when=asyncio.FIRST_COMPLETED)
            changed.cancel()
            if hearing.done():
                hearing.result()  # raises when the page has gone
                hearing = asyncio.ensure_future(line.receive())
    finally:
        hearing.cancel()
        await asyncio.gather(hearing, return_exceptions=True)


class _Visit:
    """One connection from its welcome to goodbye."""

    def __init__(self, house: House, line: _Line, hello: dict[str, Any]) -> None:
        self.house, self.line = house, line
        able = hello.get("able") == "predict" and house.walk_mode == "predict"
        display = "viser" if hello.get("display") == "viser" else "page"
        self.visitor: Visitor = house.welcome(
            time.monotonic(), "predict" if able else "server", display, hello.get("at")
        )
        self.visitor.client = house.scene.marks.client_of(hello.get("client"))

    async def run(self, given_up: asyncio.Event) -> None:
        """Until the page goes, or its place is given up."""
        acts: list[Coroutine[Any, Any, Any]] = [self._listen(), self._speak(), given_up.wait()]
        if self.visitor.walk.mode == "server":
            acts.append(self._integrate())
        try:
            self._greet()
            await until_first(*acts)
        finally:
            self.house.farewell(self.visitor)

    def _greet(self) -> None:
        pose = self.visitor.walk.pose
        self.visitor.say(
            {
                "t": "hi",
                "mode": self.visitor.walk.mode,
                "x": pose.x,
                "z": pose.z,
                "eye": pose.eye,
                "yaw": pose.yaw,
                "revision": self.house.content.revision,
            }
        )
        self.house.stage.stood_at(self.visitor, pose.x, pose.z)

    async def _speak(self) -> None:
        outbox = self.visitor.outbox
        while (message := await outbox.get()) is not None:
            if message["t"] == "pose" and not outbox.empty():
                following = outbox.get_nowait()
                if following is None or following["t"] != "pose":  # a later pose says all that this one does
                    await self.line.say(message)
                message = following
            if message is None:
                return
            await self.line.say(message)

    async def _listen(self) -> None:
        act = {
            "in": self._inputs,
            "keys": self._keys,
            "goto": self._goto,
            "open": self._open,
            "compare": lambda message: self.house.stage.compare(self.visitor, message.get("on") is True),
            "client": self._client,
            "stands": self._stands,
            "close": lambda message: self.house.stage.close(self.visitor),
        }
        while True:
            message = await self.line.receive()
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
        reply = self.visitor.walk.keys(*held, now=time.monotonic())
        self.visitor.say(reply.message())  # the page's sign that the hall is there

    def _goto(self, message: dict[str, Any]) -> None:
        self.visitor.say(self.visitor.walk.goto(message.get("x"), message.get("z")).message())
        self._stood()

    def _client(self, message: dict[str, Any]) -> None:
        """viser's socket came after the hello, or had to connect again: the page is another client there now."""
        client = self.house.scene.marks.client_of(message.get("client"))
        if client == self.visitor.client:
            return
        self.visitor.client = client
        self._bring()
        if self.visitor.opened is not None:
            opened, self.visitor.opened = self.visitor.opened, None
            self.house.stage.open(self.visitor, opened)

    def _stands(self, message: dict[str, Any]) -> None:
        """The page shows its first view, and what came after it: the next may come."""
        self.visitor.stands = True
        self._bring()

    def _bring(self) -> None:
        if self.visitor.stands:
            pose = self.visitor.walk.pose
            self.house.scene.bring(self.visitor.client, pose.x, pose.z)

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
