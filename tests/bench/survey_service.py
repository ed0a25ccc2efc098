"""A real `survey serve` in a process of its own, for the bench."""

from __future__ import annotations

import http.client
import os
import resource
import signal
import socket
import sqlite3
import subprocess
import sys
import time
import uuid
from contextlib import closing
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
ASSETS = ROOT / "assets"


def submission(questionnaire) -> dict:
    """A valid body: every item scored, a suggestion on the first module."""
    return {
        "id": str(uuid.uuid4()),
        "version": questionnaire.version,
        "language": "zh",
        "consent": True,
        "scores": dict.fromkeys(questionnaire.item_ids, 4),
        "suggestions": {questionnaire.modules[0].id: "更亮一些"},
    }


class Service:
    """Started and answering. `before`: words in front of the command, such as strace's."""

    def __init__(self, data: Path, *, before: tuple[str, ...] = (), content: Path = ASSETS) -> None:
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            self.port = probe.getsockname()[1]
        command = [*before, sys.executable, "-m", "survey.cli", "serve", "--rate", "0"]
        command += ["--port", str(self.port), "--content", str(content), "--data", str(data)]
        environment = os.environ | {"PYTHONPATH": str(ROOT)}
        self.process = subprocess.Popen(
            command, stdout=subprocess.DEVNULL, cwd=ROOT, env=environment, start_new_session=True
        )
        deadline = time.monotonic() + 120
        while not self._answers():
            if self.process.poll() is not None or time.monotonic() > deadline:
                raise RuntimeError("survey serve did not start")
            time.sleep(0.05)

    def _answers(self) -> bool:
        try:
            return self.request("GET", "/api/v1/healthz")[0] == 200
        except OSError:
            return False

    def request(self, method: str, path: str, body: bytes | None = None) -> tuple[int, bytes]:
        with closing(http.client.HTTPConnection("127.0.0.1", self.port, timeout=60)) as line:
            line.request(method, path, body, {"Content-Type": "application/json"})
            reply = line.getresponse()
            return reply.status, reply.read()

    def limit_files(self, size: int) -> None:
        """Let the process write no file beyond `size` bytes from now on; resource.RLIM_INFINITY lifts it."""
        resource.prlimit(self.process.pid, resource.RLIMIT_FSIZE, (size, resource.RLIM_INFINITY))

    def stop(self, how: signal.Signals = signal.SIGINT) -> None:
        if self.process.poll() is None:
            os.killpg(self.process.pid, how)
        self.process.wait(60)


def stored(data: Path) -> dict[str, int]:
    """submission → number of its scores, read behind the product's back; the file must be sound."""
    with closing(sqlite3.connect(data / "survey.sqlite")) as database:
        if database.execute("PRAGMA integrity_check").fetchone() != ("ok",):
            raise RuntimeError("the database is not sound")
        query = "SELECT s.id, count(a.item) FROM submission s LEFT JOIN answer a ON a.submission = s.id GROUP BY s.id"
        return dict(database.execute(query).fetchall())
