"""Simulated visitors of a running hall, in a process of their own: they walk, look round and fetch plain pages.

    python tests/bench/crowd_load.py PORT '{"visitors": 100, "seconds": 10}'

Each visitor holds a walk socket (random keys, 30 batches a second of 60 Hz inputs) and, with "viser", viser's socket,
whose scene it reads and to which it tells its camera; it asks for what comes after the first view as a page does.
Prints one JSON line: round trips in milliseconds.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
import random
import re
import statistics
import struct
import sys
import time
from typing import Any

import msgspec
import zstandard
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed
from websockets.typing import Subprotocol

BATCHES = 30  # a second
LATER = 12  # exhibits that a page asks for, one by one
VISER = Subprotocol("viser-v1.1.1")
PAGES = ("/api/scene", "/api/texts", "/catalogue", "/static/hall.js")


def quantiles(values: list[float]) -> dict[str, float]:
    """p50, p95, max [ms] of seconds."""
    ordered = sorted(1000 * value for value in values)
    if not ordered:
        return {"count": 0}
    at = {"p50": 0.5, "p95": 0.95, "p99": 0.99}
    found = {name: ordered[min(len(ordered) - 1, int(q * len(ordered)))] for name, q in at.items()}
    return {"count": len(ordered), **found, "max": ordered[-1], "mean": statistics.fmean(ordered)}


def camera(rng: random.Random) -> bytes:
    """What viser's client sends while the view moves."""
    return msgspec.msgpack.encode(
        {
            "type": "ViewerCameraMessage",
            "wxyz": [1.0, 0.0, 0.0, 0.0],
            "position": [rng.random(), 1.6, rng.random()],
            "fov": 1.0,
            "near": 0.01,
            "far": 1000.0,
            "image_height": 720,
            "image_width": 1280,
            "look_at": [0.0, 1.6, 0.0],
            "up_direction": [0.0, 1.0, 0.0],
        }
    )


def mark_in(message: bytes) -> str | None:
    """By which viser's message tells a page which client it is."""
    with contextlib.suppress(zstandard.ZstdError, struct.error):
        _, packed = struct.unpack_from("<QQ", message)
        body = zstandard.ZstdDecompressor().decompress(message[16 : 16 + packed])
        if found := re.search(rb"/_visitor/(\d+\.[0-9a-f]+)", body):
            return found[1].decode()
    return None


class Visitor:
    """One visitor: joins, walks, leaves."""

    def __init__(self, port: int, number: int, plan: dict[str, Any], found: dict[str, list[float]]) -> None:
        self.port, self.plan, self.found = port, plan, found
        self.rng = random.Random(number)
        self.sent: dict[int, float] = {}
        self.inside = asyncio.Event()
        self.mark: asyncio.Future[str] = asyncio.get_running_loop().create_future()

    async def look(self) -> None:
        """viser's socket as the page opens it: read all there is, tell the camera."""
        address = f"ws://127.0.0.1:{self.port}/"
        async with connect(address, subprotocols=[VISER], max_size=None, proxy=None) as socket:

            async def read() -> None:
                async for message in socket:
                    self.found["scene_bytes"].append(len(message))
                    if not self.mark.done() and (mark := mark_in(message)):
                        self.mark.set_result(mark)

            reading = asyncio.create_task(read())
            try:
                while True:
                    await socket.send(camera(self.rng))
                    await asyncio.sleep(1 / self.plan["cameras"])
            finally:
                reading.cancel()

    async def walk(self) -> None:
        began = time.perf_counter()
        async with connect(f"ws://127.0.0.1:{self.port}/walk", proxy=None) as socket:
            hello = {"t": "hello", "client": None, "display": "page", "able": "predict", "at": None}
            await socket.send(json.dumps(hello))
            while json.loads(await asyncio.wait_for(socket.recv(), 60)).get("t") != "hi":
                pass
            self.found["joins"].append(time.perf_counter() - began)
            self.inside.set()
            beside = [asyncio.create_task(act(socket)) for act in (self._hear, self._ask_for_more)]
            try:
                await self._stride(socket)
            finally:
                for task in beside:
                    task.cancel()

    async def _ask_for_more(self, socket: ClientConnection) -> None:
        await socket.send(json.dumps({"t": "client", "client": await self.mark}))
        for _ in range(LATER):
            await socket.send('{"t": "stands"}')
            await asyncio.sleep(0.3)

    async def _stride(self, socket: ClientConnection) -> None:
        number, due, keys, yaw = 0, time.perf_counter() + self.rng.random() / BATCHES, (1, 0), 0.0
        while True:
            await asyncio.sleep(max(0.0, due - time.perf_counter()))
            due += 1 / BATCHES
            if self.rng.random() < 0.05:
                keys = (self.rng.choice((-1, 1)), self.rng.choice((-1, 0, 1)))
                yaw = self.rng.uniform(-3, 3)
            inputs = [[number + k, 1 / 60, *keys, yaw, 1.6] for k in (1, 2)]
            number += 2
            self.sent[number] = time.perf_counter()
            await socket.send(json.dumps({"t": "in", "in": inputs}))

    async def _hear(self, socket: ClientConnection) -> None:
        async for text in socket:
            message = json.loads(text)
            if message["t"] != "pose":
                continue
            now = time.perf_counter()
            for number in [
                number for number in self.sent if number <= message["seq"]
            ]:  # one answer for several
                self.found["walks"].append(now - self.sent.pop(number))


async def fetch(port: int, path: str) -> float:
    """Seconds of one plain request on a connection of its own."""
    began = time.perf_counter()
    reader, writer = await asyncio.open_connection("127.0.0.1", port)
    writer.write(f"GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nConnection: close\r\n\r\n".encode())
    while await reader.read(1 << 16):
        pass
    writer.close()
    return time.perf_counter() - began


def unanswered(visitors: list[Visitor]) -> list[float]:
    """How long inputs have been waiting for an answer [s], those that wait for long."""
    now = time.perf_counter()
    return [now - at for visitor in visitors for at in visitor.sent.values() if now - at > 0.1]


async def load(port: int, plan: dict[str, Any]) -> dict[str, Any]:
    """Let them in within `ramp` seconds, then measure for `seconds`."""
    plan = {"viser": True, "cameras": 20, "ramp": 2.0, "seconds": 10.0, "gets": 0.0, **plan}
    found: dict[str, list[float]] = {
        name: [] for name in ("walks", "joining", "joins", "gets", "scene_bytes")
    }
    lost: list[str] = []

    async def lasting(act: Any) -> None:
        try:
            await act
        except (ConnectionClosed, OSError, TimeoutError) as error:
            lost.append(f"{type(error).__name__}: {error}"[:120])

    visitors = [Visitor(port, number, plan, found) for number in range(plan["visitors"])]
    tasks = []
    for visitor in visitors:
        if plan["viser"]:
            tasks.append(asyncio.create_task(lasting(visitor.look())))
        tasks.append(asyncio.create_task(lasting(visitor.walk())))
        await asyncio.sleep(plan["ramp"] / max(1, len(visitors)))
    with contextlib.suppress(asyncio.TimeoutError):
        await asyncio.wait_for(asyncio.gather(*(visitor.inside.wait() for visitor in visitors)), 90)
    found["joining"], found["walks"][:] = [*found["walks"], *unanswered(visitors)], []
    sys.stdout.write("ready\n")
    sys.stdout.flush()
    end = time.perf_counter() + plan["seconds"]
    count = 0
    while time.perf_counter() < end:
        if plan["gets"]:
            found["gets"].append(await fetch(port, PAGES[count % len(PAGES)]))
            count += 1
        await asyncio.sleep(1 / plan["gets"] if plan["gets"] else 0.1)
    found["walks"].extend(unanswered(visitors))
    for task in tasks:
        task.cancel()
    await asyncio.gather(*tasks, return_exceptions=True)
    return {
        "inside": sum(visitor.inside.is_set() for visitor in visitors),
        "joining_walk_ms": quantiles(found["joining"]),  # of those inside, until all are
        "walk_ms": quantiles(found["walks"]),
        "get_ms": quantiles(found["gets"]),
        "join_ms": quantiles(found["joins"]),
        "scene_megabytes": sum(found["scene_bytes"]) / 1e6 / max(1, len(visitors)),
        "lost": len(lost),
        "why": sorted(set(lost))[:3],
    }


if __name__ == "__main__":
    print(json.dumps(asyncio.run(load(int(sys.argv[1]), json.loads(sys.argv[2])))))
