"""viser's socket, relayed: one public port, an Origin check, and as many views as there are visitors."""

from __future__ import annotations

import asyncio
import contextlib
import time
from typing import TYPE_CHECKING
from weakref import WeakValueDictionary

import msgspec
from fastapi import FastAPI
from starlette.websockets import WebSocket, WebSocketDisconnect, WebSocketState

from hall_app.show.pieces import Pieces
from hall_app.visit.places import WAITING_OF_ONE_ADDRESS, Places
from hall_app.web.limits.addresses import Addresses, name_of
from hall_app.web.limits.budgets import RELAY, Allowance
from hall_app.web.limits.doorkeeper import address_of
from hall_app.web.limits.lines import LONGEST
from hall_app.web.memory import Tidying
from hall_app.web.sockets.origin import key_of, same_origin, with_key
from hall_app.web.sockets.tasks import until_first

if TYPE_CHECKING:
    from websockets.asyncio.client import ClientConnection

__all__ = ["Turns", "Views", "add_relay"]

_POLICY_VIOLATION = 1008
_TRY_AGAIN_LATER = 1013
_CAMERA_EVERY = 0.5  # [s]; viser wants the first to know a client, nothing of ours asks for the others
_BEGINS_EVERY = 0.03  # [s] at the most, views of one address; one costs a third of it
_STRANGERS = 60.0  # [s] a view may last of which no page has said hello

Point = tuple[float, float, float]


# As viser's own, field by field: what does not fit it would raise, with a page of log for each.
class ViewerCameraMessage(msgspec.Struct, tag_field="type", tag=True, forbid_unknown_fields=True):
    wxyz: tuple[float, float, float, float]
    position: Point
    fov: float
    near: float
    far: float
    image_height: float
    image_width: float
    look_at: Point
    up_direction: Point


class SceneNodeClickMessage(msgspec.Struct, tag_field="type", tag=True, forbid_unknown_fields=True):
    name: str
    instance_index: int | None
    ray_origin: Point
    ray_direction: Point
    screen_pos: tuple[float, float]
    modifier: str | None
    owner: str = ""


_visitors = msgspec.msgpack.Decoder(ViewerCameraMessage | SceneNodeClickMessage)


class Turns:
    """Views of one address begin one after the other: a class that comes in at once leaves the others the loop."""

    def __init__(self) -> None:
        self._locks: WeakValueDictionary[str, asyncio.Lock] = WeakValueDictionary()

    async def take(self, address: str) -> None:
        lock = self._locks.setdefault(name_of(address), asyncio.Lock())
        await lock.acquire()
        asyncio.get_running_loop().call_later(_BEGINS_EVERY, lock.release)


class Look:
    """One browser's right to look: `begins` is set when there is room, `ends` when it has to go."""

    def __init__(self, key: str, address: str) -> None:
        self.key, self.address = key, address
        self.begins, self.ends = asyncio.Event(), asyncio.Event()


class Views:
    """Who looks into the hall through viser's socket.

    Whoever was admitted on the walk socket is let in, whoever waits in the queue is not, anybody else as long as
    there is room: a page looks a moment before it says hello. The others wait with an open socket that shows nothing:
    refused, viser would come again every second, and a browser lets a page that is often refused wait for ever longer.
    """

    def __init__(self, places: Places) -> None:
        self._places = places
        self._tidying = Tidying()
        self.turns = Turns()
        self._open: dict[Look, None] = {}
        self._waiting: dict[Look, None] = {}  # in the order of coming

    def __len__(self) -> int:
        return len(self._open)

    def room_for(self, key: str) -> bool:
        if inside := self._places.inside_with(key):
            return sum(key == look.key for look in self._open) <= inside  # one more: it comes back
        return len(self._open) < self._places.most and not self._places.waits(key)

    def ask(self, key: str, address: str) -> Look | None:
        """A look, now or when there is room; None where as many wait as may wait in the hall's queue."""
        look = Look(key, address)
        if not self.room_for(key):
            of_address = sum(address == other.address for other in self._waiting)
            if of_address >= WAITING_OF_ONE_ADDRESS or len(self._waiting) >= self._places.most_waiting:
                return None
        self._waiting[look] = None
        self.look_again()
        asyncio.get_running_loop().call_later(_STRANGERS, self.dismiss, key)
        return look

    def look_again(self) -> None:
        """Somebody came in, or went: those for whom there is room now begin."""
        for look in tuple(self._waiting):
            if self.room_for(look.key):
                del self._waiting[look]
                self._open[look] = None
                look.begins.set()

    def leave(self, look: Look) -> None:
        self._waiting.pop(look, None)
        if look in self._open:
            del self._open[look]
            self._tidying.soon()
            self.look_again()

    def dismiss(self, key: str) -> None:
        """Where no page of that key is inside any more: what it looks through is for those who are."""
        if not self._places.inside_with(key):
            for look in self._open:
                if look.key == key:
                    look.ends.set()


def add_relay(app: FastAPI, viser_port: int, views: Views, addresses: Addresses, pieces: Pieces) -> None:
    """Relay `/` to the viser server on 127.0.0.1:`viser_port`; what is large goes out as names of `pieces`."""

    @app.websocket("/")
    async def relay(socket: WebSocket) -> None:
        key, address = key_of(socket), address_of(socket.scope)
        protocol = next((p for p in socket.scope["subprotocols"] if p.startswith("viser-v")), None)
        if protocol is None or not same_origin(socket):
            await socket.close(_POLICY_VIOLATION)
            return
        look = views.ask(key, address) if addresses.take("socket", address) else None
        if look is None:
            await socket.close(_TRY_AGAIN_LATER)
            return
        try:
            await socket.accept(subprotocol=protocol, headers=with_key(socket, key))
            await _View(socket, addresses, address, pieces).run(viser_port, protocol, look, views.turns)
        finally:
            views.leave(look)


class _View:
    """One browser's view, within its budget."""

    def __init__(self, socket: WebSocket, addresses: Addresses, address: str, pieces: Pieces) -> None:
        self._socket, self._addresses, self._address = socket, addresses, address
        self._pieces = pieces
        self._upstream: ClientConnection | None = None  # to viser, once it is this browser's turn
        self._camera = b""  # the last it sent while it waited: viser knows a client by its camera

    async def run(self, viser_port: int, protocol: str, look: Look, turns: Turns) -> None:
        await until_first(self._hear(), self._show(viser_port, protocol, look, turns), look.ends.wait())
        await self._close(_TRY_AGAIN_LATER if look.ends.is_set() or self._upstream is None else 1000)

    async def _show(self, viser_port: int, protocol: str, look: Look, turns: Turns) -> None:
        """When it is this browser's turn: what viser sends."""
        import websockets

        await look.begins.wait()
        await turns.take(self._address)
        with contextlib.suppress(OSError):
            async with websockets.connect(
                f"ws://127.0.0.1:{viser_port}",
                subprotocols=[websockets.Subprotocol(protocol)],
                max_size=None,
                max_queue=1,  # what the browser has not taken stays with viser
                compression=None,  # viser has packed it already
                proxy=None,
            ) as upstream:
                if self._camera:
                    await upstream.send(self._camera)
                self._upstream = upstream
                await self._to_browser(upstream)

    async def _close(self, code: int, reason: str = "") -> None:
        states = (self._socket.client_state, self._socket.application_state)
        if all(state is WebSocketState.CONNECTED for state in states):
            with contextlib.suppress(RuntimeError):
                await self._socket.close(code, reason)

    async def _hear(self) -> None:
        """What the browser sends, within its budget; while it waits that is dropped."""
        allowance, next_camera = Allowance(RELAY, time.monotonic()), 0.0
        with contextlib.suppress(WebSocketDisconnect):
            while True:
                message = await self._socket.receive()
                if message["type"] == "websocket.disconnect":
                    return
                await self._addresses.shares.turn(self._address)
                data, now = message.get("bytes") or b"", time.monotonic()
                kind = message_kind(data)
                asked = ["messages"]
                asked += {"ViewerCameraMessage": [], "SceneNodeClickMessage": ["click"]}.get(
                    kind or "", ["other"]
                )
                verdicts = [allowance.take("bytes", now, len(data)), *(allowance.take(a, now) for a in asked)]
                if "leave" in verdicts:
                    self._addresses.throw_out(self._address)
                    await self._close(_POLICY_VIOLATION, "too much")
                    return
                if "drop" in verdicts or kind is None:
                    continue
                if self._upstream is None:
                    self._camera = data if kind == "ViewerCameraMessage" else self._camera
                    continue
                if kind == "ViewerCameraMessage":
                    if now < next_camera:
                        continue
                    next_camera = now + _CAMERA_EVERY
                await self._upstream.send(data)

    async def _to_browser(self, upstream: ClientConnection) -> None:
        import websockets

        with contextlib.suppress(websockets.ConnectionClosed, WebSocketDisconnect, RuntimeError):
            async for message in upstream:
                if isinstance(message, str):
                    await self._socket.send_text(message)
                else:
                    await self._socket.send_bytes(self._pieces.lean(message))


def message_kind(data: bytes) -> str | None:
    """The kind of what a visitor does: no uploads, no changes of panels, above all no request for a public tunnel."""
    if len(data) > LONGEST:
        return None
    try:
        return type(_visitors.decode(data)).__name__
    except (msgspec.MsgspecError, ValueError, RecursionError):
        return None
