"""A real `hall serve` in a process of its own, as a visitor's browser meets it."""

import contextlib
import json
import os
import signal
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.request
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

# [s] after which a hall hangs: one that opens may have kernels to compile, on a machine that has much else to do.
OPENING, ENDING = 600, 60


@dataclass(frozen=True)
class RunningHall:
    """Its address, folders, log file and process."""

    url: str
    port: int
    content: Path
    data: Path
    log: Path
    process: subprocess.Popen

    def said(self) -> str:
        return self.log.read_text("utf-8").replace("\r", "\n")


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


@contextlib.contextmanager
def running_hall(
    content: Path,
    work: Path,
    *options: str,
    patience: float = OPENING,
    program: Sequence[str] = (sys.executable, "-m", "hall_app"),
    env: Mapping[str, str] | None = None,
    light: bool = False,
    port: int | None = None,
) -> Iterator[RunningHall]:
    """Start it, wait until it answers, end it with Ctrl-C's signal; `program` in place of `hall`, more `env`.

    light: whether to compute the light of a room that is not baked, minutes of work; port: a free one when None.
    """
    port = port or free_port()
    data, log = work / "data", work / "serve.log"
    work.mkdir(parents=True, exist_ok=True)
    command = [
        *program,
        "serve",
        "--content",
        content,
        "--data",
        data,
        "--port",
        str(port),
        *(() if light else ("--no-light",)),
    ]
    with log.open("wb") as sink:
        process = subprocess.Popen(
            [*command, *options],
            stdout=sink,
            stderr=subprocess.STDOUT,
            env={**os.environ, "PYTHONUNBUFFERED": "1", **(env or {})},
        )
        hall = RunningHall(f"http://127.0.0.1:{port}", port, content, data, log, process)
        try:
            _wait_until_it_answers(hall, patience)
            yield hall
        finally:
            process.send_signal(signal.SIGINT)
            try:
                process.wait(ENDING)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
                raise AssertionError("hall serve did not end on Ctrl-C:\n" + hall.said()) from None


def wait_for_exhibit(hall: RunningHall, identity: str, patience: float = OPENING) -> None:
    """Until an exhibit that the hall has to bake first stands in it."""
    end = time.monotonic() + patience
    while time.monotonic() < end:
        with urllib.request.urlopen(f"{hall.url}/api/scene", timeout=60) as answer:
            if identity in [one["id"] for one in json.load(answer)["exhibits"]]:
                return
        time.sleep(0.5)
    raise AssertionError(f"{identity} was not baked within {patience} s:\n{hall.said()}")


def _wait_until_it_answers(hall: RunningHall, patience: float) -> None:
    end = time.monotonic() + patience
    while time.monotonic() < end:
        if hall.process.poll() is not None:
            raise AssertionError(f"hall serve ended with {hall.process.returncode}:\n{hall.said()}")
        with contextlib.suppress(urllib.error.URLError, ConnectionError, TimeoutError):
            with urllib.request.urlopen(f"{hall.url}/api/scene", timeout=5):
                return
        time.sleep(0.1)
    raise AssertionError(f"hall serve did not answer within {patience} s:\n{hall.said()}")
