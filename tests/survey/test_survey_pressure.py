"""Many at once, and a kill in the middle: what was acknowledged is there once and whole."""

from __future__ import annotations

import http.client
import json
import signal
import socket
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from survey_samples import ASSETS, looked_up, submission

from survey import read_questionnaire
from survey.store.database import open_engine

GARMENT = read_questionnaire(ASSETS / "questionnaires" / "garment.toml")
SETTINGS = {
    "journal_mode": "wal",
    "synchronous": 2,
    "foreign_keys": 1,
    "busy_timeout": 15_000,
    "secure_delete": 1,
    "temp_store": 2,
}
URL = "/api/v1/questionnaires/garment/submissions"


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class Service:
    """A real `survey serve` in a process of its own."""

    def __init__(self, data) -> None:
        self.data, self.port = data, free_port()
        command = [sys.executable, "-m", "survey.cli", "serve", "--port", str(self.port)]
        command += ["--content", str(ASSETS), "--data", str(data), "--rate", "0"]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self._wait()

    def _wait(self) -> None:
        deadline = time.monotonic() + 60
        while time.monotonic() < deadline and self.process.poll() is None:
            try:
                if self.request("GET", "/api/v1/healthz")[0] == 200:
                    return
            except OSError:
                time.sleep(0.05)
        raise AssertionError(f"survey serve did not start: {self.stop(signal.SIGKILL)}")

    def request(self, method: str, path: str, body: bytes | None = None) -> tuple[int, bytes]:
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=30)
        try:
            connection.request(method, path, body, {"Content-Type": "application/json"})
            reply = connection.getresponse()
            return reply.status, reply.read()
        finally:
            connection.close()

    def stop(self, how: signal.Signals) -> str:
        self.process.send_signal(how)
        out, _ = self.process.communicate(timeout=30)
        return out


@pytest.fixture
def service(tmp_path):
    running = Service(tmp_path / "data")
    yield running
    if running.process.poll() is None:
        running.stop(signal.SIGKILL)


def rows_of(data) -> dict[str, int]:
    """submission → number of its answers, read behind the product's back."""
    if isinstance(data, Path):
        assert looked_up(data, "PRAGMA integrity_check") == [("ok",)]
    query = (
        "SELECT s.id, count(a.item) FROM submission s LEFT JOIN answer a ON a.submission = s.id GROUP BY s.id"
    )
    return {key: number for key, number in looked_up(data, query)}


def test_many_threads_submit_and_replay_and_each_answer_is_there_once(hall):
    bodies = [submission(GARMENT, suggestions={"form": str(number)}) for number in range(40)]
    sent = [body for body in bodies for _ in range(4)]
    gate = threading.Barrier(8)

    def send(share):
        gate.wait()
        return [hall.client.post(hall.url, json=body).status_code for body in share]

    with ThreadPoolExecutor(8) as pool:
        codes = [code for share in pool.map(send, [sent[start::8] for start in range(8)]) for code in share]
    assert sorted(set(codes)) == [200, 201]
    assert codes.count(201) == len(bodies)
    assert rows_of(hall.data) == {body["id"]: 12 for body in bodies}


def test_one_id_with_different_bodies_at_once_has_a_single_winner(hall):
    base = submission(GARMENT)
    bodies = [base | {"suggestions": {"form": str(number)}} for number in range(8)]
    with ThreadPoolExecutor(8) as pool:
        codes = list(pool.map(lambda body: hall.client.post(hall.url, json=body).status_code, bodies))
    assert sorted(codes) == [201] + [409] * 7
    assert rows_of(hall.data) == {base["id"]: 12}


@pytest.mark.nightly
def test_results_are_read_whole_while_answers_are_taken_back(hall):
    bodies = [submission(GARMENT) for _ in range(60)]
    for body in bodies:
        assert hall.client.post(hall.url, json=body).status_code == 201
    headers = {"authorization": f"Bearer {hall.store.tokens.make('reader')}"}
    gone = threading.Event()

    def read():
        codes = []
        while not gone.is_set():
            reply = hall.client.get("/api/v1/questionnaires/garment/rows", headers=headers)
            codes.append(reply.status_code)
        return codes

    with ThreadPoolExecutor(3) as pool:
        readers = [pool.submit(read) for _ in range(3)]
        for body in bodies:
            assert hall.client.delete(f"{hall.url}/{body['id']}").status_code == 204
        gone.set()
        assert {code for reader in readers for code in reader.result()} == {200}


def test_a_commit_reaches_the_disk_before_it_returns(tmp_path):
    # A kill does not lose what the system already holds; only a power cut would show a missing sync.
    engine = open_engine(tmp_path / "data")
    with engine.connect() as connection:
        settings = {name: connection.exec_driver_sql(f"PRAGMA {name}").scalar_one() for name in SETTINGS}
    engine.dispose()
    assert settings == SETTINGS


@pytest.mark.nightly
@pytest.mark.slow
def test_a_kill_under_load_loses_no_acknowledged_answer(tmp_path):
    data = tmp_path / "data"
    acknowledged: dict[str, dict] = {}
    for _ in range(3):
        service = Service(data)
        enough = threading.Event()
        fresh: dict[str, dict] = {}
        workers = [threading.Thread(target=_keep_sending, args=(service, fresh, enough)) for _ in range(6)]
        for worker in workers:
            worker.start()
        assert enough.wait(30), "the service acknowledged too little"
        service.stop(signal.SIGKILL)
        for worker in workers:
            worker.join(30)
        acknowledged |= fresh
        stored = rows_of(data)
        assert set(acknowledged) <= set(stored)
        assert set(stored.values()) == {12}
    survivor = Service(data)
    try:
        # A visitor's browser that never heard of its receipt sends again: still one row each.
        for body in list(acknowledged.values())[-20:]:
            assert survivor.request("POST", URL, json.dumps(body).encode())[0] == 200
        before = len(rows_of(data))
        status, _ = survivor.request("POST", URL, json.dumps(submission(GARMENT)).encode())
        assert (status, len(rows_of(data))) == (201, before + 1)
    finally:
        survivor.stop(signal.SIGKILL)


def _keep_sending(service: Service, acknowledged: dict[str, dict], enough: threading.Event) -> None:
    while True:
        body = submission(GARMENT)
        try:
            status, _ = service.request("POST", URL, json.dumps(body).encode())
        except (OSError, http.client.HTTPException):
            return
        assert status == 201
        acknowledged[body["id"]] = body
        if len(acknowledged) >= 60:
            enough.set()


def test_a_huge_body_is_refused_from_its_announcement_alone(service):
    with socket.create_connection(("127.0.0.1", service.port), timeout=20) as line:
        head = f"POST {URL} HTTP/1.1\r\nHost: x\r\nContent-Type: application/json\r\nContent-Length: 9000000000\r\n\r\n"
        line.sendall(head.encode() + b"{")
        assert b" 413 " in line.recv(4096)


def test_who_sends_too_much_hears_why(service):
    body = json.dumps(submission(GARMENT) | {"suggestions": {"fabric": "a" * 3_000_000}}).encode()
    status, reply = service.request("POST", URL, body)  # sends all of it before it listens
    assert status == 413
    assert set(json.loads(reply)) == {"field", "problem", "remedy"}


def test_an_endless_chunked_body_is_cut_off(service):
    with socket.create_connection(("127.0.0.1", service.port), timeout=20) as line:
        head = f"POST {URL} HTTP/1.1\r\nHost: x\r\nContent-Type: application/json\r\nTransfer-Encoding: chunked\r\n\r\n"
        line.sendall(head.encode())
        chunk = b"10000\r\n" + b" " * 65_536 + b"\r\n"
        sent = 0
        try:
            while sent < 400:
                line.sendall(chunk)
                sent += 1
        except OSError:
            pass
        assert sent < 400, "26 MB were swallowed"
    assert service.request("GET", "/api/v1/healthz")[0] == 200


def test_the_service_says_where_it_is_and_ends_on_an_interrupt(service):
    out = service.stop(signal.SIGINT)
    assert "3 questionnaires, 0 problems" in out
    assert f"http://127.0.0.1:{service.port}/questionnaires" in out
    assert "Traceback" not in out
    with pytest.raises(OSError, match="refused"):
        service.request("GET", "/api/v1/healthz")
