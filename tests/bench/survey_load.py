"""A load generator for the survey service: keep-alive clients on plain sockets, in a process of their own.

Run as `python survey_load.py PORT CLIENTS SECONDS QUESTIONNAIRE.json`; prints one JSON line.
"""

from __future__ import annotations

import asyncio
import json
import sys
import time
import uuid
from pathlib import Path

PATH = "/api/v1/questionnaires/{key}/submissions"


class Client(asyncio.Protocol):
    """One visitor after the other on one connection: sends the next answer when the receipt is there."""

    def __init__(self, port: int, asked: dict, until: float, found: dict) -> None:
        self.asked, self.until, self.found, self.done = asked, until, found, asyncio.Event()
        self.head = (
            f"POST {PATH.format(key=asked['id'])} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n"
            "Content-Type: application/json\r\nContent-Length: "
        ).encode()
        self.body = json.dumps(asked["body"])
        self.heard = b""

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        assert isinstance(transport, asyncio.Transport)
        self.transport = transport
        self.send()

    def send(self) -> None:
        if time.perf_counter() >= self.until:
            self.done.set()
            self.transport.close()
            return
        body = self.body.replace(self.asked["body"]["id"], str(uuid.uuid4()), 1).encode()
        self.start = time.perf_counter()
        self.transport.write(self.head + str(len(body)).encode() + b"\r\n\r\n" + body)

    def data_received(self, data: bytes) -> None:
        self.heard += data
        head, gap, rest = self.heard.partition(b"\r\n\r\n")
        if not gap or len(rest) < int(head.lower().partition(b"content-length: ")[2].partition(b"\r\n")[0]):
            return
        self.heard = b""
        code = head[9:12].decode()
        self.found["codes"][code] = self.found["codes"].get(code, 0) + 1
        self.found["times"].append(time.perf_counter() - self.start)
        self.send()

    def connection_lost(self, error: Exception | None) -> None:
        self.done.set()


async def load(port: int, clients: int, seconds: float, asked: dict) -> dict:
    loop, found = asyncio.get_running_loop(), {"codes": {}, "times": []}
    start = time.perf_counter()
    until = start + seconds
    made = [
        await loop.create_connection(lambda: Client(port, asked, until, found), "127.0.0.1", port)
        for _ in range(clients)
    ]
    await asyncio.gather(*(client.done.wait() for _, client in made))
    return found | {"seconds": time.perf_counter() - start}


if __name__ == "__main__":
    port, clients, seconds, path = sys.argv[1:]
    asked = json.loads(Path(path).read_text("utf-8"))
    print(json.dumps(asyncio.run(load(int(port), int(clients), float(seconds), asked))))
