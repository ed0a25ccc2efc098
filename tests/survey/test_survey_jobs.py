"""Exports and analyses are made by a process of their own, which holds no visitor up and is never left behind."""

from __future__ import annotations

import asyncio
import contextlib
import csv
import http.client
import io
import json
import os
import signal
import socket
import sqlite3
import stat
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from pathlib import Path

import event_loop
import pytest
from openpyxl import load_workbook
from survey_samples import ASSETS, submission

from survey import Answer, Store, StoreError, read_questionnaire
from survey.export import exported, pseudonym
from survey.job import NICE
from survey.web.api import JOBS_AT_WORK, JOBS_OPEN, Jobs, Run

GARMENT = read_questionnaire(ASSETS / "questionnaires" / "garment.toml")
BASE = "/api/v1/questionnaires/garment"
PATIENCE = 120.0  # seconds after which something that must happen has not

linux = pytest.mark.skipif(not Path("/proc/self/task").is_dir(), reason="looks for processes under /proc")


def fill(store: Store, number: int, text: str = "") -> None:
    futures = [
        store.enqueue(
            GARMENT, Answer.of(GARMENT, submission(GARMENT, suggestions={"form": text} if text else {}))
        )
        for _ in range(number)
    ]
    for future in futures:
        future.result(PATIENCE)


def until(condition, what: str):
    """The first true value of the condition."""
    deadline = time.monotonic() + PATIENCE
    while time.monotonic() < deadline:
        if found := condition():
            return found
        time.sleep(0.002)
    raise AssertionError(what)


def children(pid: int) -> set[int]:
    """The processes at work for the service. One that is only just being started holds the service up: not yet."""
    found: set[int] = set()
    for thread in Path(f"/proc/{pid}/task").glob("*"):
        with contextlib.suppress(OSError):
            found |= set(map(int, (thread / "children").read_text().split()))
    return {child for child in found if "survey.job" in command_of(child)}


def command_of(pid: int) -> str:
    try:
        return Path(f"/proc/{pid}/cmdline").read_text()
    except OSError:
        return ""


def runs(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


class Service:
    """`survey serve` in a process of its own, with a token."""

    def __init__(self, data: Path, *before: str) -> None:
        with closing(Store(data)) as store:
            self.token = store.tokens.make("researcher")
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            self.port = probe.getsockname()[1]
        command = [
            *before,
            sys.executable,
            "-m",
            "survey.cli",
            "serve",
            "--port",
            str(self.port),
            "--rate",
            "0",
        ]
        command += ["--content", str(ASSETS), "--data", str(data)]
        self.process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
        until(self.answers, "survey serve did not start")

    def answers(self) -> bool:
        try:
            return self.request("GET", "/api/v1/healthz")[0] == 200
        except OSError:
            return False

    def request(self, method: str, path: str, body: object = None) -> tuple[int, dict[str, str], bytes]:
        with closing(http.client.HTTPConnection("127.0.0.1", self.port, timeout=PATIENCE)) as line:
            headers = {"Content-Type": "application/json", "Authorization": f"Bearer {self.token}"}
            line.request(method, path, None if body is None else json.dumps(body), headers)
            reply = line.getresponse()
            return reply.status, {k.lower(): v for k, v in reply.getheaders()}, reply.read()

    def ask(self, path: str) -> socket.socket:
        """Ask and do not listen."""
        line = socket.create_connection(("127.0.0.1", self.port), timeout=PATIENCE)
        line.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 16)
        head = f"GET {path} HTTP/1.1\r\nHost: x\r\nAuthorization: Bearer {self.token}\r\n\r\n"
        line.sendall(head.encode())
        return line


@pytest.fixture
def service(tmp_path):
    with closing(Store(tmp_path / "data")) as store:
        fill(store, 12)
    running = Service(tmp_path / "data")
    yield running
    for pid in children(running.process.pid):
        with contextlib.suppress(OSError):
            os.kill(pid, signal.SIGKILL)
    if running.process.poll() is None:
        running.process.kill()
    running.process.wait(PATIENCE)


def halted_request(service: Service, path: str, pool: ThreadPoolExecutor):
    """A request that is under way, and the process that is at it, stopped."""
    before = children(service.process.pid)
    waiting = pool.submit(service.request, "GET", path)

    def new():
        for pid in children(service.process.pid) - before:
            os.kill(pid, signal.SIGSTOP)
            return pid
        return 0

    return waiting, until(new, "no process was started")


@pytest.mark.nightly
def test_the_service_does_none_of_it_itself(hall, monkeypatch):
    fill(hall.store, 12)
    researcher = {"authorization": f"Bearer {hall.store.tokens.make('researcher')}"}

    def refuse(*_args, **_more):
        raise AssertionError("the service itself was at work")

    for name in ("survey.export.put", "survey.job.main", "survey.scores.sources.stored_scores"):
        monkeypatch.setattr(name, refuse)
    for path in ("rows", "suggestions", "export/csv", "export/xlsx", "analysis"):
        reply = hall.client.get(f"{BASE}/{path}", headers=researcher)
        # All scores are the same, which only the analysis minds.
        assert reply.status_code == (422 if path == "analysis" else 200), path


@linux
def test_the_process_makes_way_and_ends_with_its_input():
    process = subprocess.Popen(
        [sys.executable, "-m", "survey.job"], stdin=subprocess.PIPE, stderr=subprocess.DEVNULL
    )
    behind = min(os.getpriority(os.PRIO_PROCESS, 0) + NICE, 19)
    until(lambda: os.getpriority(os.PRIO_PROCESS, process.pid) == behind, "it does not make way")
    assert process.stdin is not None
    process.stdin.close()
    assert process.wait(PATIENCE) != 0


def test_csv_and_json_are_byte_for_byte_what_the_answers_make(hall):
    texts = ["=1+1", 'say "hi", 你好', "two\nlines", "", ""]
    for number, text in enumerate(texts):
        body = submission(hall.garment, score=1 + number, exhibit=None if number else "pibo")
        body["scores"]["pleat"] = None
        body["suggestions"] = {"fabric": text} if text else {}
        assert hall.client.post(hall.url, json=body).status_code == 201
    researcher = {"authorization": f"Bearer {hall.store.tokens.make('researcher')}"}
    rows = hall.store.rows(hall.garment)
    for kind in ("csv", "json", "codebook", "r"):
        reply = hall.client.get(f"{BASE}/export/{kind}", headers=researcher)
        assert reply.content == exported(kind, hall.garment, rows)
        assert reply.headers["content-length"] == str(len(reply.content))
    # Written out by hand, so that both cannot be wrong alike.
    out = io.StringIO(newline="")
    table = csv.writer(out)
    modules = [module.id for module in hall.garment.modules if module.suggestion]
    meta = ["submission", "version", "language", "exhibit", "received"]
    table.writerow([*meta, *hall.garment.item_ids, *(f"suggestion_{module}" for module in modules)])
    document = []
    for row in rows:
        answer, texts_of = row.answer, dict(row.answer.suggestions)
        time_of = row.received.strftime("%Y-%m-%dT%H:%M:%SZ")
        known = [pseudonym(answer.id), answer.version, answer.language]
        scores = ["" if point is None else point for _, point in answer.scores]
        cells = [texts_of.get(module, "") for module in modules]
        guarded = ["'" + cell if cell.startswith("=") else cell for cell in cells]
        table.writerow([*known, answer.exhibit or "", time_of, *scores, *guarded])
        told = [*known, answer.exhibit, time_of, dict(answer.scores), texts_of]
        document.append(dict(zip([*meta, "scores", "suggestions"], told, strict=True)))
    assert exported("csv", hall.garment, rows) == ("\ufeff" + out.getvalue()).encode()
    whole = {"questionnaire": hall.garment.document(), "answers": document}
    wanted = (json.dumps(whole, ensure_ascii=False, indent=1) + "\n").encode()
    assert exported("json", hall.garment, rows) == wanted
    book = load_workbook(io.BytesIO(hall.client.get(f"{BASE}/export/xlsx", headers=researcher).content))
    cells = [[cell.value for cell in line] for line in book["answers"].iter_rows()]
    mine = load_workbook(io.BytesIO(exported("xlsx", hall.garment, rows)))
    assert cells == [[cell.value for cell in line] for line in mine["answers"].iter_rows()]
    assert len(cells) == 1 + len(rows)


def test_a_file_is_nobody_else_s_and_has_no_name():
    run = Run({})
    found = os.fstat(run.body.fileno())
    assert stat.S_IMODE(found.st_mode) & 0o077 == 0
    assert found.st_nlink == 0
    run.body.close()


@pytest.mark.nightly
def test_a_slow_reader_holds_neither_the_service_nor_the_database(service, tmp_path):
    with closing(Store(tmp_path / "data")) as store:
        fill(store, 1500, "很" * 2000)
    with closing(service.ask(f"{BASE}/export/csv")) as slow:
        assert slow.recv(12) == b"HTTP/1.1 200"
        # The file waits to be fetched; the process is gone, and with it its look at the database.
        until(lambda: not children(service.process.pid), "the process waits for the reader")
        assert service.request("POST", f"{BASE}/submissions", submission(GARMENT))[0] == 201
        assert service.request("GET", f"{BASE}/export/json")[0] == 200
        with closing(sqlite3.connect(tmp_path / "data" / "survey.sqlite")) as database:
            busy, _, _ = database.execute("PRAGMA wal_checkpoint(TRUNCATE)").fetchone()
            assert busy == 0
        with slow.makefile("rb") as rest:
            head, body = rest.read(2_000_000).split(b"\r\n\r\n", 1)
            assert b"content-length" in head.lower()
            size = int(head.lower().partition(b"content-length: ")[2].partition(b"\r\n")[0])
            assert len(body + rest.read(size - len(body))) == size > 5_000_000


@linux
def test_visitors_are_served_while_it_is_made_and_no_secret_stands_on_its_command_line(service, tmp_path):
    with ThreadPoolExecutor(1) as pool:
        waiting, pid = halted_request(service, f"{BASE}/export/xlsx", pool)
        assert str(tmp_path) not in command_of(pid)
        assert service.request("POST", f"{BASE}/submissions", submission(GARMENT))[0] == 201
        assert service.request("GET", f"{BASE}/results")[0] == 200
        assert not waiting.done()
        os.kill(pid, signal.SIGCONT)
        status, _, content = waiting.result(PATIENCE)
    assert status == 200
    assert load_workbook(io.BytesIO(content))["answers"].max_row in (13, 14)


@pytest.mark.nightly
@linux
@pytest.mark.parametrize("path", ["export/csv", "analysis"])
def test_who_hangs_up_ends_it(service, path):
    line = service.ask(f"{BASE}/{path}")
    pid = until(lambda: next(iter(children(service.process.pid)), 0), "no process was started")
    os.kill(pid, signal.SIGSTOP)
    line.close()
    until(lambda: not runs(pid), "the process outlives whoever asked")
    assert service.request("GET", f"{BASE}/export/csv")[0] == 200


@pytest.mark.nightly
@linux
def test_a_few_at_a_time_the_next_wait_and_more_are_told_when_to_come_again(service):
    with ThreadPoolExecutor(JOBS_OPEN + 2) as pool:
        halted = [halted_request(service, f"{BASE}/export/csv", pool) for _ in range(JOBS_AT_WORK)]
        others = [
            pool.submit(service.request, "GET", f"{BASE}/export/csv")
            for _ in range(JOBS_OPEN + 2 - JOBS_AT_WORK)
        ]
        refused = until(
            lambda: done if len(done := [o for o in others if o.done()]) == 2 else None, "not two"
        )
        for one in refused:
            status, headers, body = one.result()
            assert status == 503
            assert int(headers["retry-after"]) > 0
            assert set(json.loads(body)) == {"field", "problem", "remedy"}
        assert len(children(service.process.pid)) == JOBS_AT_WORK
        for _, pid in halted:
            os.kill(pid, signal.SIGCONT)
        for one in {*(waiting for waiting, _ in halted), *others} - set(refused):
            assert one.result(PATIENCE)[0] == 200
    assert service.request("GET", f"{BASE}/export/csv")[0] == 200


@pytest.mark.nightly
@linux
@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM])
def test_the_end_of_the_service_is_its_end(service, how):
    with ThreadPoolExecutor(1) as pool:
        waiting, pid = halted_request(service, f"{BASE}/export/csv", pool)
        service.process.send_signal(how)
        service.process.wait(PATIENCE)
        until(lambda: not runs(pid), "a process was left behind")
        with contextlib.suppress(OSError, http.client.HTTPException):
            assert waiting.result(PATIENCE)[0] == 503


@pytest.mark.nightly
@linux
def test_a_killed_service_leaves_no_process_either(service):
    with ThreadPoolExecutor(1) as pool:
        waiting, pid = halted_request(service, f"{BASE}/analysis", pool)
        service.process.kill()
        service.process.wait(PATIENCE)
        os.kill(pid, signal.SIGCONT)
        until(lambda: not runs(pid), "a process was left behind")
        assert isinstance(waiting.exception(PATIENCE), OSError | http.client.HTTPException)


@linux
def test_a_process_that_is_killed_is_told_as_503_and_one_that_fails_as_500(service):
    with ThreadPoolExecutor(1) as pool:
        waiting, pid = halted_request(service, f"{BASE}/export/csv", pool)
        os.kill(pid, signal.SIGKILL)
        status, headers, body = waiting.result(PATIENCE)
    assert status == 503
    assert headers["retry-after"]
    said = json.loads(body)
    assert said == {"field": "", "problem": "the export or analysis was broken off", "remedy": "ask again"}


def small_disk(folder: Path) -> list[str]:
    """What runs a command for which the folder is all there is for temporary files, half a megabyte of it."""
    script = 'mount -t tmpfs -o size=512k tmpfs "$1" && export TMPDIR="$1" && shift && exec "$@"'
    before = ["unshare", "-rm", "sh", "-c", script, "sh", str(folder)]
    try:
        subprocess.run([*before, "true"], check=True, capture_output=True)
    except (OSError, subprocess.CalledProcessError):
        pytest.skip("no file system of one's own can be mounted here")
    return before


@pytest.mark.nightly
@linux
def test_a_full_temporary_folder_is_told_with_its_remedy(tmp_path):
    small = tmp_path / "small"
    small.mkdir()
    before = small_disk(small)
    with closing(Store(tmp_path / "data")) as store:
        fill(store, 200, "很" * 2000)
    service, problem = Service(tmp_path / "data", *before), f"no room in the temporary folder {small}"
    try:
        for kind in ("csv", "json", "xlsx", "sav"):
            status, headers, body = service.request("GET", f"{BASE}/export/{kind}")
            assert (status, kind) == (503, kind)
            assert headers["retry-after"]
            assert json.loads(body) == {"field": "", "problem": problem, "remedy": "free some, or set TMPDIR"}
        # And the room that they took is free again.
        assert service.request("GET", f"{BASE}/export/codebook")[0] == 200
    finally:
        service.process.terminate()
        service.process.wait(PATIENCE)
    command = [sys.executable, "-m", "survey.cli", "export", "--questionnaire", "garment"]
    command += ["--content", str(ASSETS), "--data", str(tmp_path / "data")]
    for kind in ("csv", "xlsx", "sav"):
        made = subprocess.run(
            [*before, *command, "--format", kind], capture_output=True, text=True, check=False
        )
        told = f"survey: {problem} – free some, or set TMPDIR\n"
        assert (made.returncode, made.stdout, made.stderr) == (1, "", told)


@pytest.mark.nightly
@linux
def test_a_full_disk_leaves_the_earlier_file_where_it_was(tmp_path):
    small = tmp_path / "small"
    small.mkdir()
    before = small_disk(small)
    with closing(Store(tmp_path / "data")) as store:
        fill(store, 200, "很" * 2000)
    command = [sys.executable, "-m", "survey.cli", "export", "--questionnaire", "garment"]
    command += ["--content", str(ASSETS), "--data", str(tmp_path / "data")]
    # One shell for all of it: the small disk is gone with the command that it was mounted for.
    script = (
        'cd "$TMPDIR"; echo earlier > a.csv; TMPDIR="$0" "$@" --out a.csv; echo "status $?"; cat a.csv; ls -A'
    )
    line = [*before, "sh", "-c", script, str(tmp_path), *command]
    made = subprocess.run(line, capture_output=True, text=True, check=False)
    assert made.stdout.splitlines() == ["status 1", "earlier", "a.csv"]
    assert made.stderr == (
        "survey: a.csv: cannot be written (No space left on device) – make room or give another --out\n"
    )
    with Path("/dev/full").open("wb") as full:
        lost = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    assert lost.returncode == 1
    assert lost.stderr.startswith("survey: standard output: cannot be written (No space left on device) – ")
    assert lost.stderr.count("\n") == 1


@pytest.mark.parametrize("database", ["sqlite"], indirect=True)
def test_a_process_that_fails_is_an_error_of_the_service(hall, monkeypatch):
    monkeypatch.setattr(
        "survey.web.api.jobs._COMMAND", (sys.executable, "-c", "raise SystemExit('no such luck')")
    )
    researcher = {"authorization": f"Bearer {hall.store.tokens.make('researcher')}"}
    assert hall.client.get(f"{BASE}/export/csv", headers=researcher).status_code == 500


def test_a_store_that_is_lost_is_told_as_before(hall):
    if isinstance(hall.data, str):
        pytest.skip("a file that can be moved")
    researcher = {"authorization": f"Bearer {hall.store.tokens.make('researcher')}"}
    file = hall.data / "survey.sqlite"
    moved = file.rename(file.with_name("elsewhere"))
    refused = hall.client.get(f"{BASE}/export/csv", headers=researcher)
    assert refused.status_code == 503
    assert set(refused.json()) == {"field", "problem", "remedy"}
    moved.rename(file)


class _Gone:
    """A request whose client hung up."""

    async def receive(self) -> dict[str, str]:
        await asyncio.sleep(0.05)
        return {"type": "http.disconnect"}


def test_close_ends_what_is_under_way_and_another_may_begin(tmp_path, monkeypatch):
    with closing(Store(tmp_path)) as store:
        fill(store, 3)
    made = Jobs(tmp_path)
    forever = (sys.executable, "-c", "import sys, time; sys.stdin.readline(); time.sleep(3600)")
    job = {"task": "csv", "questionnaire": GARMENT.document()}

    class Patient:
        async def receive(self) -> dict[str, str]:
            await asyncio.sleep(3600)
            raise AssertionError

    async def asked(request):
        reply = await made.response(request, job, "text/csv", {})
        return "".join([str(part) async for part in reply.body_iterator])

    with monkeypatch.context() as patched:
        patched.setattr("survey.web.api.jobs._COMMAND", forever)
        with pytest.raises(StoreError, match="broken off"):
            event_loop.run(asked(_Gone()))
        ending = threading.Timer(0.3, made.close)
        ending.start()
        with pytest.raises(StoreError, match="broken off"):
            event_loop.run(asked(Patient()))
    assert event_loop.run(asked(Patient())).count(r"\r\n") == 4
