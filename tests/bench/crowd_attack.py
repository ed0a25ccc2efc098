"""One attacker at full speed against a running hall, in a process of its own.

    python tests/bench/crowd_attack.py PORT KIND SECONDS [ADDRESS]

ADDRESS is where it comes from (127.0.0.2 by default: another address than the other visitors'). It never waits: it
writes as fast as the socket takes, comes back at once when it is thrown out, over LINES connections at a time.
"""

from __future__ import annotations

import asyncio
import base64
import contextlib
import json
import os
import re
import struct
import sys
import time
from collections.abc import Sequence

import msgspec
from crowd_load import VISER, camera

LINES = 32  # connections at a time where connections are the attack
IDLE = 1500  # connections that say nothing
KEPT = 300  # connections that are kept and ask on
INSIDE = 60  # visitors of one address who do all that their budgets allow
AHEAD = 3000  # requests sent ahead of any answer
GET = ("/catalogue", "/api/scene")
FORM = ("/questionnaires/platform-user", "/privacy")
CHUNK = 512  # messages handed to the socket at once

HELLO = {"t": "hello", "client": None, "display": "page", "able": "predict", "at": None}
CLICK = {
    "type": "SceneNodeClickMessage", "name": "/exhibits/mirror", "instance_index": None, "ray_origin": [0, 0, 0],
    "ray_direction": [0, 0, 1], "screen_pos": [0.5, 0.5], "modifier": None, "owner": "",
}  # fmt: skip
WALK = {
    "goto": [{"t": "goto", "x": 1.0, "z": 2.0}, {"t": "goto", "x": -3.0, "z": 1.0}],
    "keys": [{"t": "keys", "forward": 1, "right": 0, "yaw": 0.1, "eye": 1.6}],
    "open": [{"t": "open", "id": "mirror"}, {"t": "open", "id": "beizi"}],
    "close": [{"t": "close"}],
    "client": [{"t": "client", "client": "1.0123456789abcdef"}],
    "unknown": [{"t": "nobody knows"}],
}
KINDS = (
    *WALK, "in", "unreadable", "large", "ping", "silent", "reconnect", "hello", "camera", "click", "viser",
    "idle", "get", "kept", "form", "ahead", "within",
)  # fmt: skip


def frame(payload: bytes, opcode: int = 1) -> bytes:
    """One masked frame, as a browser sends it."""
    size = len(payload)
    head = bytes([0x80 | opcode])
    if size < 126:
        head += bytes([0x80 | size])
    elif size < 1 << 16:
        head += bytes([0x80 | 126]) + struct.pack("!H", size)
    else:
        head += bytes([0x80 | 127]) + struct.pack("!Q", size)
    return head + bytes(4) + payload  # a mask of zeros leaves the payload as it is


def text(message: object) -> bytes:
    return frame(json.dumps(message).encode())


def flood(kind: str) -> tuple[bytes, str]:
    """What is written again and again, and where: "/walk" or "/"."""
    if kind in WALK:
        return b"".join(map(text, WALK[kind])) * (CHUNK // len(WALK[kind])), "/walk"
    if kind == "in":
        return text({"t": "in", "in": [[k, 0.001, 1, 0, 0.1, 1.6] for k in range(1, 1200)]}) * 8, "/walk"
    if kind == "unreadable":
        return frame(b"{" * 400) * CHUNK, "/walk"
    if kind == "large":
        return frame(b"[" + b"1," * 30_000 + b"1]") * 8, "/walk"
    if kind == "ping":
        return frame(b"", opcode=9) * CHUNK, "/walk"
    if kind == "camera":
        return frame(camera(__import__("random").Random(1)), opcode=2) * CHUNK, "/"
    return frame(msgspec.msgpack.encode(CLICK), opcode=2) * CHUNK, "/"  # "click"


class Attacker:
    """Counts what it manages."""

    def __init__(self, port: int, kind: str, seconds: float, address: str) -> None:
        self.port, self.kind, self.address = port, kind, address
        self.until = time.perf_counter() + seconds
        self.connected = self.refused = self.written = 0

    @property
    def going(self) -> bool:
        return time.perf_counter() < self.until

    async def join(self, path: str) -> tuple[asyncio.StreamReader, asyncio.StreamWriter] | None:
        """A WebSocket by hand; None where it is refused."""
        reader, writer = await asyncio.open_connection(
            "127.0.0.1", self.port, local_addr=(self.address, 0), limit=1 << 24
        )
        key = base64.b64encode(os.urandom(16)).decode()
        more = f"Sec-WebSocket-Protocol: {VISER}\r\n" if path == "/" else ""
        writer.write(
            f"GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{self.port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
            f"Sec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n{more}\r\n".encode()
        )
        head = await reader.readuntil(b"\r\n\r\n")
        if b" 101 " not in head.split(b"\r\n")[0]:
            self.refused += 1
            writer.close()
            return None
        self.connected += 1
        return reader, writer

    async def flood(self) -> None:
        """One socket, written full; again when it is closed."""
        chunk, path = flood(self.kind)
        while self.going:
            with contextlib.suppress(OSError, asyncio.IncompleteReadError, asyncio.TimeoutError):
                async with asyncio.timeout(max(0.1, self.until - time.perf_counter())):
                    joined = await self.join(path)
                    if joined is None:
                        continue
                    reader, writer = joined
                    swallowing = asyncio.create_task(swallow(reader))
                    if path == "/walk":
                        writer.write(text(HELLO))
                    try:
                        while self.going and not swallowing.done():
                            writer.write(chunk)
                            await writer.drain()
                            self.written += len(chunk)
                            await asyncio.sleep(0)
                    finally:
                        swallowing.cancel()
                        writer.transport.abort()

    async def come_and_go(self, path: str, *, hello: bool, stay: bool) -> None:
        """Connections one after the other; `stay`: they are held until the end."""
        held = []
        while self.going:
            with contextlib.suppress(OSError, asyncio.IncompleteReadError, asyncio.TimeoutError):
                async with asyncio.timeout(max(0.1, self.until - time.perf_counter())):
                    joined = await self.join(path)
                    if joined is None:
                        continue
                    if hello:
                        joined[1].write(text(HELLO))
                        await joined[0].read(64)
                    if stay and len(held) < 400:
                        held.append(joined)
                    else:
                        joined[1].transport.abort()
        for _, writer in held:
            writer.transport.abort()

    async def idle(self) -> None:
        """Connections that never say a word, as many as this process may hold."""
        held: list[asyncio.StreamWriter] = []
        while self.going:
            with contextlib.suppress(OSError):
                _, writer = await asyncio.open_connection(
                    "127.0.0.1", self.port, local_addr=(self.address, 0)
                )
                self.connected += 1
                held.append(writer)
            held = [writer for writer in held if not writer.transport.is_closing()]
            await asyncio.sleep(0 if len(held) < IDLE else 0.1)
        for writer in held:
            writer.transport.abort()

    async def within(self) -> None:
        """A visitor who walks, leaps and opens exhibits as often as his budget allows, and is never thrown out."""
        joined = await self.join("/walk")
        if joined is None:
            return
        reader, writer = joined
        swallowing = asyncio.create_task(swallow(reader))
        writer.write(text(HELLO))
        number = count = 0
        while self.going and not swallowing.done():
            inputs = [
                [number + k + 1, 0.002, (-1) ** (count // 40), 1, count * 0.05 % 6, 1.6] for k in range(14)
            ]
            number, count = number + len(inputs), count + 1
            writer.write(text({"t": "in", "in": inputs}))
            if count % 9 == 0:
                writer.write(text(WALK["goto"][count % 2]))
            if count % 36 == 0:
                writer.write(text(WALK["open"][count % 2]))
            await asyncio.sleep(1 / 35)
        swallowing.cancel()
        writer.transport.abort()

    async def ahead(self) -> None:
        """Requests of which no answer is waited for, on one connection after the other."""
        asks = f"GET /catalogue HTTP/1.1\r\nHost: 127.0.0.1:{self.port}\r\n\r\n".encode() * AHEAD
        while self.going:
            with contextlib.suppress(OSError):
                _, writer = await asyncio.open_connection(
                    "127.0.0.1", self.port, local_addr=(self.address, 0)
                )
                self.connected += 1
                try:
                    while self.going:
                        writer.write(asks)
                        await asyncio.wait_for(writer.drain(), max(0.1, self.until - time.perf_counter()))
                        self.written += len(asks)
                finally:
                    writer.transport.abort()

    async def get(self, paths: Sequence[str] = GET) -> None:
        """One plain request after the other over a connection that is kept."""
        while self.going:
            with contextlib.suppress(OSError, ValueError, asyncio.IncompleteReadError, asyncio.TimeoutError):
                async with asyncio.timeout(max(0.1, self.until - time.perf_counter())):
                    reader, writer = await asyncio.open_connection(
                        "127.0.0.1", self.port, local_addr=(self.address, 0)
                    )
                    self.connected += 1
                    try:
                        while self.going:
                            for path in paths:
                                await self._ask(reader, writer, path)
                    finally:
                        writer.transport.abort()

    async def _ask(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter, path: str) -> None:
        ask = f"GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{self.port}\r\n\r\n".encode()
        writer.write(ask)
        self.written += len(ask)
        head = await reader.readuntil(b"\r\n\r\n")
        self.refused += b" 429 " in head.split(b"\r\n")[0]
        length = re.search(rb"(?i)content-length: (\d+)", head)
        if length is None:
            raise ValueError("no length")
        await reader.readexactly(int(length[1]))

    async def run(self) -> None:
        if self.kind == "idle":
            await self.idle()
            return
        asking = {"get": (LINES, GET), "kept": (KEPT, GET), "form": (KEPT, FORM)}
        if self.kind in asking:
            lines, paths = asking[self.kind]
            await asyncio.gather(*(self.get(paths) for _ in range(lines)))
            return
        if self.kind == "within":
            await asyncio.gather(*(self.within() for _ in range(INSIDE)))
            return
        if self.kind == "ahead":
            await self.ahead()
            return
        if self.kind == "silent":
            await self.come_and_go("/walk", hello=False, stay=True)
            return
        ways = {"reconnect": ("/walk", False), "hello": ("/walk", True), "viser": ("/", False)}
        if self.kind in ways:
            path, hello = ways[self.kind]
            await asyncio.gather(*(self.come_and_go(path, hello=hello, stay=False) for _ in range(LINES)))
            return
        await self.flood()


async def swallow(reader: asyncio.StreamReader) -> None:
    with contextlib.suppress(OSError):
        while await reader.read(1 << 16):
            pass


if __name__ == "__main__":
    attacker = Attacker(int(sys.argv[1]), sys.argv[2], float(sys.argv[3]), (sys.argv[4:] or ["127.0.0.2"])[0])
    asyncio.run(attacker.run())
    done = {"connected": attacker.connected, "refused": attacker.refused, "megabytes": attacker.written / 1e6}
    print(json.dumps(done))
