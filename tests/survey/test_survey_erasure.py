"""Erased is erased: all bytes of all files are read after a withdrawal, a purge, an upgrade, a kill."""

from __future__ import annotations

import json
import random
import shutil
import signal
import sqlite3
import threading
import time
from collections.abc import Iterable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path

import pytest
from sqlalchemy import create_engine, text
from survey_samples import ASSETS, looked_up, submission
from test_survey_pressure import URL, Service

from survey import Answer, Store, read_questionnaire
from survey.cli import main
from survey.questionnaire import Questionnaire
from survey.store.erasure import BLOCK, erased_answer, left_over

GARMENT = read_questionnaire(ASSETS / "questionnaires" / "garment.toml")
BASE = "/api/v1/questionnaires/garment"
MODULES = [module.id for module in GARMENT.modules if module.suggestion]


def a_body(number: int, length: int = 0) -> dict:
    """A submission with texts that nobody else writes; length: of one of them, over several pages of the database."""
    more = "and said so at length; " * length
    said = {
        MODULES[0]: f"披帛的纹样第{number}号比实物暗了一些，袖口也看不清，编号{number}。",
        MODULES[1]: f"Visitor {number} found the drape too stiff, {more[:1900]} No. {number}.",
    }
    return submission(GARMENT, score=1 + number % 5, suggestions=said, exhibit="pibo")


def traces_of(body: dict) -> dict[str, bytes]:
    """What must not be found: texts in any usual coding, also parts of them; and the keys of its rows."""
    found = {}
    for module, said in body["suggestions"].items():
        for coding in ("utf-8", "utf-16-le", "utf-16-be"):
            found[f"{module} in {coding}"] = said.encode(coding)
        found[f"head of {module}"], found[f"end of {module}"] = said[:12].encode(), said[-12:].encode()
    rows = [*body["scores"], *body["suggestions"]]
    return found | {f"row {name}": (body["id"] + name).encode() for name in rows}


def all_bytes(folder: Path) -> bytes:
    return b"\0".join(path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file())


def found_in(data: bytes, bodies: Iterable[dict]) -> list[str]:
    return [name for body in bodies for name, trace in traces_of(body).items() if trace in data]


def posted(service: Service, body: dict) -> None:
    status, reply = service.request("POST", URL, json.dumps(body).encode())
    assert status == 201, reply


@pytest.fixture
def service(tmp_path):
    running = Service(tmp_path / "data")
    yield running
    if running.process.poll() is None:
        running.stop(signal.SIGKILL)


@contextmanager
def reading(service: Service) -> Iterator[None]:
    """Readers that never rest, of what everybody sees, while the block runs."""
    over, codes = threading.Event(), set()

    def read() -> None:
        while not over.is_set():
            codes.add(service.request("GET", f"{BASE}/results")[0])

    readers = [threading.Thread(target=read) for _ in range(3)]
    for reader in readers:
        reader.start()
    try:
        yield
    finally:
        over.set()
        for reader in readers:
            reader.join()
    assert codes == {200}


@contextmanager
def held(data: Path) -> Iterator[None]:
    """Another program reads a moment of the database and goes on reading it."""
    with closing(sqlite3.connect(data / "survey.sqlite", isolation_level=None)) as other:
        other.execute("BEGIN")
        other.execute("SELECT count(*) FROM submission").fetchone()
        yield
        other.execute("ROLLBACK")


def health(service: Service) -> dict:
    status, reply = service.request("GET", "/api/v1/healthz")
    assert status == 200
    return json.loads(reply)


def settled(service: Service) -> None:
    deadline = time.monotonic() + 60
    while "erasure" in health(service):
        assert time.monotonic() < deadline, "never done"
        time.sleep(0.05)


def test_a_withdrawn_answer_is_in_no_byte_of_any_file_while_others_read_and_write(service):
    bodies = [a_body(number, length=100 * (number % 3)) for number in range(40)]
    for body in bodies:
        posted(service, body)
    before = all_bytes(service.data)
    for body in bodies:
        assert len(found_in(before, [body])) >= len(body["scores"]) + 6  # or the test would look for nothing
    gone = []
    with reading(service):
        for body in bodies[::3]:
            status, _ = service.request("DELETE", f"{URL}/{body['id']}")
            assert status in (202, 204)
            if status == 202:  # the readers kept it in the log for five seconds
                settled(service)
            gone.append(body)
            assert found_in(all_bytes(service.data), gone) == []
            posted(service, a_body(1000 + len(gone)))
    assert health(service) == {"status": "ok"}
    assert looked_up(service.data, "SELECT count(*) FROM trace") == [(0,)]
    standing = [body for body in bodies if body not in gone]
    kept = dict(looked_up(service.data, "SELECT submission, count(*) FROM answer GROUP BY submission"))
    assert {body["id"] for body in standing} <= set(kept)
    assert not {body["id"] for body in gone} & set(kept)


@pytest.mark.nightly
@pytest.mark.slow
def test_no_copy_stays_where_the_database_moved_rows_about(tmp_path):
    # As their neighbours go, SQLite pulls rows together on fewer pages and leaves a copy of some where they were, here
    # of three whole texts (SQLite 3.40). Overwriting what is deleted, and a checkpoint, do not reach it.
    chance = random.Random(19)
    letters = ["".join(chance.choices("abcdefghij", k=chance.randrange(400))) for _ in range(200)]
    said = [f"No. {number}: {some} ({number}. end)" for number, some in enumerate(letters)]
    bodies = [submission(GARMENT, suggestions={MODULES[0]: text}) for text in said]
    with closing(Store(tmp_path)) as store:
        for sent in [store.enqueue(GARMENT, Answer.of(GARMENT, body)) for body in bodies]:
            sent.result(60)
        chance.shuffle(bodies)
        for body in bodies[:130]:
            digest = Answer.of(GARMENT, body).digest.encode()
            assert store.withdraw("garment", body["id"])
            gone = store.take_back("garment", body["id"])  # once more, where five seconds were not enough
            assert gone is not None
            assert gone.result(60)
            data = all_bytes(tmp_path)
            assert found_in(data, [body]) == []
            assert digest not in data


@pytest.mark.nightly
def test_while_somebody_reads_it_says_that_something_stays_and_sees_to_it(service):
    body = a_body(1)
    posted(service, body)
    with held(service.data):
        status, reply = service.request("DELETE", f"{URL}/{body['id']}")
        assert status == 202
        told = json.loads(reply)
        assert told["id"] == body["id"]
        assert "database's files" in told["remains"]
        assert health(service) == {"status": "ok", "erasure": "owed"}
        assert service.request("DELETE", f"{URL}/{body['id']}")[0] == 202  # asked again: still so
        posted(service, a_body(2))  # nobody has to wait for that
        assert looked_up(service.data, "SELECT count(*) FROM suggestion") == [(2,)]
    settled(service)
    assert found_in(all_bytes(service.data), [body]) == []
    assert service.request("DELETE", f"{URL}/{body['id']}")[0] == 204
    assert "what was erased can still be read in it" in (said := service.stop(signal.SIGINT))
    assert "what was erased is gone from it now" in said


@pytest.mark.nightly
def test_what_a_kill_left_over_goes_with_the_next_start(service):
    body = a_body(1)
    posted(service, body)
    with held(service.data):
        assert service.request("DELETE", f"{URL}/{body['id']}")[0] == 202
        service.stop(signal.SIGKILL)
        assert found_in(all_bytes(service.data), [body])
    again = Service(service.data)
    try:
        settled(again)
        assert found_in(all_bytes(service.data), [body]) == []
    finally:
        again.stop(signal.SIGKILL)


def kept_until(day: str) -> Questionnaire:
    return Questionnaire.model_validate(GARMENT.document() | {"retain_until": day})


def filled(where: Path | str, asked: Questionnaire, bodies: Iterable[dict]) -> None:
    with closing(Store(where)) as store:
        for body in bodies:
            store.submit(asked, Answer.of(asked, body))


def test_a_purge_leaves_nothing_in_any_file_while_the_service_runs(tmp_path, capsys):
    bodies, data = [a_body(number, length=number) for number in range(60)], tmp_path / "data"
    filled(data, kept_until("2001-01-01"), bodies)
    service = Service(data)
    try:
        assert len(found_in(all_bytes(data), bodies)) > 12 * len(bodies)
        with reading(service):
            assert main(["purge", "--yes", "--data", str(data)]) == 0
        out = capsys.readouterr().out
        assert "60 answers erased" in out
        assert "nothing of it is left" in out
        assert found_in(all_bytes(data), bodies) == []
        assert health(service) == {"status": "ok"}
        assert looked_up(data, "SELECT count(*) FROM submission WHERE digest = ''") == [(60,)]
    finally:
        service.stop(signal.SIGKILL)


def test_a_purge_that_somebody_holds_up_fails_and_the_next_one_is_done(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("survey.commands.storage.purge.SETTLING", 0.3)
    bodies, data = [a_body(1)], tmp_path / "data"
    filled(data, kept_until("2001-01-01"), bodies)
    with closing(Store(data)), held(data):  # the service; without it the last to go would take the WAL along
        assert main(["purge", "--yes", "--data", str(data)]) == 1
        assert "can still be read in the file, somebody holds it – purge again" in capsys.readouterr().err
        assert found_in(all_bytes(data), bodies)
    assert main(["purge", "--yes", "--data", str(data)]) == 0
    assert found_in(all_bytes(data), bodies) == []


def test_what_an_earlier_release_erased_goes_with_the_upgrade(tmp_path):
    old, body = tmp_path / "old", a_body(1, length=50)
    old.mkdir()
    shutil.copy(Path(__file__).parent / "first_store.sql", tmp_path)
    with closing(sqlite3.connect(old / "survey.sqlite")) as database:
        database.execute("PRAGMA secure_delete=OFF")
        database.executescript((tmp_path / "first_store.sql").read_text("utf-8"))
        row = (body["id"], "garment", 1, "zh", None, "", "2020-01-01 00:00:00.000000", None)
        database.execute("INSERT INTO submission VALUES (?, ?, ?, ?, ?, ?, ?, ?)", row)
        said = [(body["id"], module, text) for module, text in body["suggestions"].items()]
        scores = [(body["id"], item, score) for item, score in body["scores"].items()]
        database.executemany("INSERT INTO suggestion VALUES (?, ?, ?)", said)
        database.executemany("INSERT INTO answer VALUES (?, ?, ?)", scores)
        database.commit()
        for table in ("answer", "suggestion"):
            database.execute(f"DELETE FROM {table} WHERE submission = ?", (body["id"],))
        database.commit()
    assert found_in(all_bytes(old), [body])
    with closing(Store(old)) as store:
        assert found_in(all_bytes(old), [body]) == []
        assert not store.erasure_owed()
        assert store.count("garment", 1) == 6  # five of the first release, and the one whose rows went


@pytest.mark.nightly
def test_a_backup_holds_nothing_that_was_withdrawn_before(service, tmp_path):
    gone, kept = a_body(1), a_body(2)
    posted(service, gone)
    posted(service, kept)
    with held(service.data):  # so that the source still has it
        assert service.request("DELETE", f"{URL}/{gone['id']}")[0] == 202
        assert main(["backup", str(tmp_path / "copy.sqlite"), "--data", str(service.data)]) == 0
        assert found_in(all_bytes(service.data), [gone])
    copied = (tmp_path / "copy.sqlite").read_bytes()
    assert found_in(copied, [gone]) == []
    assert found_in(copied, [kept])


@pytest.mark.nightly
@pytest.mark.slow
def test_on_postgresql_a_purge_leaves_nothing_in_its_tables(postgres, capsys):
    url, bodies = postgres(), [a_body(number, length=number) for number in range(30)]
    filled(url, kept_until("2001-01-01"), bodies)
    engine = create_engine(url, isolation_level="AUTOCOMMIT")

    def on_the_disk() -> bytes:
        with engine.connect() as connection:
            connection.execute(text("CHECKPOINT"))
            number = connection.execute(
                text("SELECT oid FROM pg_database WHERE datname = current_database()")
            )
            folder = Path(connection.execute(text("SHOW data_directory")).scalar_one()) / "base"
        return all_bytes(folder / str(number.scalar_one()))

    try:
        short = [trace for body in bodies[:5] for name, trace in traces_of(body).items() if "utf-8" in name]
        assert [trace for trace in short if trace in on_the_disk()]
        assert main(["purge", "--yes", "--db", url]) == 0
        out = capsys.readouterr().out
        assert "nothing of it is left in the database's files" in out
        assert "archived WAL" in out
        assert found_in(on_the_disk(), bodies) == []
        with closing(Store(url)) as store:
            assert not store.erasure_owed()
            assert store.count("garment", GARMENT.version) == 0
    finally:
        engine.dispose()


@pytest.mark.parametrize("shift", [-40, -1, 0, 5])
def test_what_lies_across_two_blocks_is_found(tmp_path, shift):
    file, said = tmp_path / "file", "袖口看不清，下摆也太短了一些"
    at = BLOCK + shift
    file.write_bytes(b"\0" * at + said.encode() + b"\0" * BLOCK)
    erased = erased_answer("key", "0b2c7e7e-8f0e-4e1c-9d0a-3f5b6a7c8d9e", "", (), {"form": said})
    assert left_over(file, [erased])
    other = erased_answer("key", "0b2c7e7e-8f0e-4e1c-9d0a-3f5b6a7c8d9e", "", (), {"form": said[::-1]})
    assert not left_over(file, [other])
