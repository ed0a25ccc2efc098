"""viser's socket, relayed: one public port, an Origin check and a cap on visitors in front of it."""

import asyncio
import contextlib

from fastapi import FastAPI
from starlette.websockets import WebSocket, WebSocketDisconnect, WebSocketState

from .origin import same_origin

__all__ = ["MOST_VISITORS", "add_relay"]

# About 20 MB of send buffer a client while a scene is replayed (field measurements): 30 fit a small machine.
MOST_VISITORS = 30

_POLICY_VIOLATION = 1008
_TRY_AGAIN_LATER = 1013
_LARGEST_FROM_BROWSER = 64 << 10  # [bytes] clicks and camera poses are small
_VISITOR_MESSAGES = frozenset({"ViewerCameraMessage", "SceneNodeClickMessage"})


def add_relay(app: FastAPI, viser_port: int, path: str = "/") -> None:
    """Relay `path` to the viser server on 127.0.0.1:`viser_port`."""
    open_sockets: set[WebSocket] = set()

    @app.websocket(path)
    async def relay(socket: WebSocket) -> None:
        if not same_origin(socket):
            await socket.close(_POLICY_VIOLATION)
            return
        if len(open_sockets) >= MOST_VISITORS:
            await socket.close(_TRY_AGAIN_LATER)
            return
        protocol = next((p for p in socket.scope["subprotocols"] if p.startswith("viser-v")), None)
        if protocol is None:
            await socket.close(_POLICY_VIOLATION)
            return
        open_sockets.add(socket)
        try:
            await _pump(socket, viser_port, protocol)
        finally:
            open_sockets.discard(socket)


async def _pump(socket: WebSocket, viser_port: int, protocol: str) -> None:
    import websockets

    try:
        upstream = await websockets.connect(
            f"ws://127.0.0.1:{viser_port}",
            subprotocols=[websockets.Subprotocol(protocol)],
            max_size=None,
            compression=None,  # viser has compressed already
            proxy=None,
        )
    except OSError:
        await socket.close(_TRY_AGAIN_LATER)
        return
    async with upstream:
        await socket.accept(subprotocol=protocol)
        tasks = {
            asyncio.create_task(_to_viser(socket, upstream)),
            asyncio.create_task(_to_browser(socket, upstream)),
        }
        _, pending = await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        for task in pending:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
    if (
        socket.client_state is WebSocketState.CONNECTED
        and socket.application_state is WebSocketState.CONNECTED
    ):
        with contextlib.suppress(RuntimeError):
            await socket.close()


async def _to_viser(socket: WebSocket, upstream) -> None:
    with contextlib.suppress(WebSocketDisconnect):
        while True:
            message = await socket.receive()
            if message["type"] == "websocket.disconnect":
                return
            data = message.get("bytes")
            if isinstance(data, bytes) and len(data) <= _LARGEST_FROM_BROWSER and _wanted(data):
                await upstream.send(data)


def _wanted(data: bytes) -> bool:
    """Only what a visitor does: no uploads, no changes of panels, above all no request for a public tunnel."""
    import msgspec

    try:
        message = msgspec.msgpack.decode(data)
    except msgspec.DecodeError:
        return False
    kind = message.get("type") if isinstance(message, dict) else None
    return isinstance(kind, str) and kind in _VISITOR_MESSAGES


async def _to_browser(socket: WebSocket, upstream) -> None:
    import websockets

    with contextlib.suppress(websockets.ConnectionClosed, WebSocketDisconnect, RuntimeError):
        async for message in upstream:
            if isinstance(message, str):
                await socket.send_text(message)
            else:
                await socket.send_bytes(message)
