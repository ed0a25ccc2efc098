"""The store itself: schema migrations, freezing, purging, backup, a file that goes away, full and locked disks."""

from __future__ import annotations

import os
import shutil
import sqlite3
import threading
from contextlib import closing
from pathlib import Path

import pytest
from sqlalchemy import update
from survey_samples import ASSETS, submission

from survey import Answer, read_questionnaire
from survey.errors import AnswerError, StoreError
from survey.questionnaire import Questionnaire
from survey.store import Receipt, Store, migrations
from survey.store.commit import BATCH_SIZE, Writer
from survey.store.database import HEAD, now, tables

GARMENT = read_questionnaire(ASSETS / "questionnaires" / "garment.toml")


def an_answer(**changes) -> Answer:
    return Answer.of(GARMENT, submission(GARMENT, **changes))


@pytest.fixture
def store(tmp_path):
    with closing(Store(tmp_path)) as made:
        yield made


def columns(file: Path) -> dict[str, set[tuple]]:
    with closing(sqlite3.connect(file)) as database:
        names = [
            name
            for (name,) in database.execute("SELECT name FROM sqlite_master WHERE type IN ('table', 'index')")
        ]
        return {
            name: {
                (row[1], row[2], row[3], row[5]) for row in database.execute(f"PRAGMA table_info('{name}')")
            }
            for name in names
            if not name.startswith("sqlite_autoindex")
        }


def test_the_head_is_the_newest_migration():
    files = sorted((Path(migrations.__file__).parent / "versions").glob("0*.py"))
    assert files[-1].name.partition("_")[0] == HEAD


def test_a_store_of_the_first_version_is_upgraded_and_keeps_its_answers(tmp_path, store):
    old = tmp_path / "old"
    old.mkdir()
    with closing(sqlite3.connect(old / "survey.sqlite")) as database:
        database.executescript((Path(__file__).parent / "first_store.sql").read_text("utf-8"))
        before = database.execute("SELECT id, digest FROM submission ORDER BY id").fetchall()
    assert before
    with closing(Store(old)) as upgraded:
        upgraded.submit(GARMENT, an_answer())
    assert columns(old / "survey.sqlite") == columns(tmp_path / "survey.sqlite")
    with closing(sqlite3.connect(old / "survey.sqlite")) as database:
        after = database.execute("SELECT id, digest FROM submission").fetchall()
    assert set(before) < set(after)


def test_a_store_of_a_later_version_is_refused_and_left_alone(tmp_path, store):
    store.close()
    with closing(sqlite3.connect(tmp_path / "survey.sqlite")) as database:
        database.execute("UPDATE alembic_version SET version_num = '9999'")
        database.commit()
    with pytest.raises(StoreError, match="9999.*newer") as refused:
        Store(tmp_path)
    assert str(refused.value).startswith(f"{tmp_path / 'survey.sqlite'}: ")
    with closing(sqlite3.connect(tmp_path / "survey.sqlite")) as database:
        assert database.execute("SELECT version_num FROM alembic_version").fetchall() == [("9999",)]


def test_frozen_answers_cannot_be_withdrawn_and_later_ones_can(store):
    early, late = an_answer(), an_answer()
    store.submit(GARMENT, early)
    assert (store.freeze("garment"), store.freeze("garment")) == (1, 0)
    store.submit(GARMENT, late)
    with pytest.raises(AnswerError) as refused:
        store.withdraw("garment", early.id)
    assert refused.value.status == 409
    assert store.withdraw("garment", late.id)
    assert [row.answer.id for row in store.rows(GARMENT)] == [early.id]


def test_what_is_withdrawn_stays_a_tombstone_without_answers(store, tmp_path):
    answer = an_answer(suggestions={"fabric": "gone"}, exhibit="pibo")
    store.submit(GARMENT, answer)
    store.submit(GARMENT, an_answer())
    assert store.tombstones() == ()
    assert store.withdraw("garment", answer.id)
    assert store.tombstones() == (answer.id,)
    with pytest.raises(AnswerError) as refused:
        store.submit(GARMENT, answer)
    assert refused.value.status == 410
    with closing(sqlite3.connect(tmp_path / "survey.sqlite")) as database:
        row = database.execute("SELECT digest, exhibit FROM submission WHERE id = ?", (answer.id,)).fetchone()
        assert row == ("", None)
        for table in ("answer", "suggestion"):
            left = f"SELECT count(*) FROM {table} WHERE submission = ?"
            assert database.execute(left, (answer.id,)).fetchone() == (0,)


@pytest.mark.slow
def test_an_answer_that_another_process_is_freezing_is_not_erased(postgres):
    url, answer = postgres(), an_answer()
    with closing(Store(url)) as store, closing(Store(url)) as other:
        store.submit(GARMENT, answer)
        refusals = []

        def withdraw():
            with pytest.raises(AnswerError) as refused:
                store.withdraw("garment", answer.id)
            refusals.append(refused.value.status)

        taking_back = threading.Thread(target=withdraw)
        with other._write() as connection:
            connection.execute(update(tables.submission).values(frozen=now()))
            taking_back.start()
            taking_back.join(1.0)  # it waits for the freeze
            assert taking_back.is_alive()
        taking_back.join()
        assert refusals == [409]
        assert store.rows(GARMENT)[0].answer == answer


def test_purging_erases_frozen_answers_too(store):
    store.submit(GARMENT, an_answer())
    store.freeze("garment")
    assert store.purge("garment", GARMENT.version) == 1
    assert store.rows(GARMENT) == ()


def test_a_backup_is_whole_and_opens_as_a_store(store, tmp_path):
    answers = [an_answer() for _ in range(5)]
    for answer in answers:
        store.submit(GARMENT, answer)
    copy = tmp_path / "copy.sqlite"
    assert store.copy_to(copy) == 5
    with pytest.raises(StoreError, match="exists already"):
        store.copy_to(copy)
    with closing(Store(f"sqlite:///{copy}")) as restored:
        assert {row.answer for row in restored.rows(GARMENT)} == set(answers)


def test_a_backup_where_it_cannot_be_written_leaves_nothing(store, tmp_path):
    with pytest.raises(StoreError, match="backup failed"):
        store.copy_to(tmp_path / "nowhere" / "copy.sqlite")
    assert not (tmp_path / "nowhere").exists()


def test_a_file_moved_away_is_missed_and_taken_up_again_when_it_is_back(store, tmp_path):
    file, away = tmp_path / "survey.sqlite", tmp_path / "away.sqlite"
    kept, refused = an_answer(), an_answer()
    store.submit(GARMENT, kept)
    os.replace(file, away)
    for _ in range(2):
        with pytest.raises(StoreError, match=r"survey\.sqlite: the database file is gone"):
            store.submit(GARMENT, refused)
        with pytest.raises(StoreError, match="gone"):
            store.alive()
    assert not file.exists()  # an empty one would look like a survey without answers
    os.replace(away, file)
    store.submit(GARMENT, refused)
    assert {row.answer for row in store.rows(GARMENT)} == {kept, refused}


def test_a_backup_put_in_the_place_of_a_deleted_file_is_taken_up(store, tmp_path):
    kept = an_answer()
    store.submit(GARMENT, kept)
    store.copy_to(tmp_path / "copy.sqlite")
    (tmp_path / "survey.sqlite").unlink()
    with pytest.raises(StoreError, match="gone"):
        store.submit(GARMENT, an_answer())
    shutil.copy(tmp_path / "copy.sqlite", tmp_path / "survey.sqlite")
    with pytest.raises(StoreError, match="survey.sqlite-wal is still that of the earlier one"):
        store.submit(GARMENT, an_answer())
    for rest in ("-wal", "-shm"):
        (tmp_path / f"survey.sqlite{rest}").unlink(missing_ok=True)
    assert [row.answer for row in store.rows(GARMENT)] == [kept]
    store.submit(GARMENT, an_answer())


def test_an_empty_file_in_its_place_is_no_store(store, tmp_path):
    store.submit(GARMENT, an_answer())
    for file in tmp_path.glob("survey.sqlite*"):
        file.unlink()
    (tmp_path / "survey.sqlite").touch()
    with pytest.raises(StoreError, match="no store of answers"):
        store.submit(GARMENT, an_answer())


def test_a_full_database_refuses_and_takes_answers_again_when_there_is_room(store, tmp_path):
    kept = an_answer()
    store.submit(GARMENT, kept)
    with store._write() as connection:  # the pool's only connection so far: the writer takes it again
        pages = connection.exec_driver_sql("PRAGMA page_count").scalar_one()
        connection.exec_driver_sql(f"PRAGMA max_page_count={pages}")
    taken, refused = [], []
    for _ in range(200):
        answer = an_answer(suggestions={"fabric": "字" * 1900})
        try:
            store.submit(GARMENT, answer)
            taken.append(answer)
        except StoreError as error:
            refused.append((answer, str(error)))
    assert len(refused) > 100
    assert all("full" in told for _, told in refused)
    assert {row.answer for row in store.rows(GARMENT)} == {kept, *taken}
    with store._read() as connection:
        connection.exec_driver_sql(f"PRAGMA max_page_count={100 * pages}")
    for answer, _ in refused:
        store.submit(GARMENT, answer)
    assert {row.answer for row in store.rows(GARMENT)} == {kept, *taken, *(answer for answer, _ in refused)}


@pytest.mark.parametrize("trouble", ["no database", "a folder", "no room for a folder"])
def test_a_store_that_cannot_be_opened_names_where_it_is(tmp_path, trouble):
    place = tmp_path / "data"
    file = place / "survey.sqlite"
    if trouble == "no room for a folder":
        place.write_text("a file")
        file = place
    else:
        place.mkdir()
        file.mkdir() if trouble == "a folder" else file.write_bytes(b"no database at all " * 100)
    with pytest.raises(StoreError, match=" – ") as refused:
        Store(place)
    assert str(refused.value).startswith(f"{file}: ")
    assert "\n" not in str(refused.value)


def test_an_answer_written_into_a_file_that_went_away_meanwhile_is_not_acknowledged(store, tmp_path):
    file, away = tmp_path / "survey.sqlite", tmp_path / "away.sqlite"

    def write_while_it_goes() -> None:
        with store._write() as connection:
            os.replace(file, away)
            connection.exec_driver_sql("DELETE FROM token")

    with pytest.raises(StoreError, match="gone"):
        write_while_it_goes()
    os.replace(away, file)
    store.submit(GARMENT, an_answer())


def test_one_entry_that_cannot_be_costs_the_others_nothing_and_the_writer_goes_on():
    gate, sizes = threading.Event(), []
    poisoned = an_answer()

    def commit(entries) -> list[Receipt | AnswerError]:
        gate.wait(10)
        sizes.append(len(entries))
        if any(answer is poisoned for _, answer in entries):
            raise ValueError("no database has a row for this")
        return [Receipt(answer.id, replayed=False) for _, answer in entries]

    writer = Writer(commit)
    answers = [an_answer(), an_answer(), poisoned, an_answer()]
    futures = [writer.put((GARMENT, answer)) for answer in answers]
    gate.set()
    for answer, future in zip(answers, futures, strict=True):
        if answer is poisoned:
            with pytest.raises(ValueError, match="no database"):
                future.result(10)
        else:
            assert future.result(10).id == answer.id
    late = an_answer()
    assert writer.put((GARMENT, late)).result(10).id == late.id
    writer.close()
    assert max(sizes) > 1


def acknowledged(entries) -> list[Receipt | AnswerError]:
    return [Receipt(answer.id, replayed=False) for _, answer in entries]


def test_a_transaction_is_never_longer_than_its_bound_and_keeps_the_order():
    gate, batches = threading.Event(), []

    def commit(entries) -> list[Receipt | AnswerError]:
        gate.wait(10)
        batches.append([answer.id for _, answer in entries])
        return acknowledged(entries)

    writer = Writer(commit)
    answers = [an_answer() for _ in range(BATCH_SIZE + 50)]
    futures = [writer.put((GARMENT, answer)) for answer in answers]
    gate.set()
    for future in futures:
        future.result(10)
    writer.close()
    assert max(map(len, batches)) <= BATCH_SIZE
    assert [one for batch in batches for one in batch] == [answer.id for answer in answers]


def test_who_hangs_up_before_the_write_is_not_written_and_holds_up_nobody():
    gate, begun, written = threading.Event(), threading.Event(), []

    def commit(entries) -> list[Receipt | AnswerError]:
        begun.set()
        gate.wait(10)
        written.extend(answer.id for _, answer in entries)
        return acknowledged(entries)

    writer = Writer(commit)
    first, gone, last = (an_answer() for _ in range(3))
    heard = [writer.put((GARMENT, first))]
    assert begun.wait(10)
    assert writer.put((GARMENT, gone)).cancel()
    heard.append(writer.put((GARMENT, last)))
    gate.set()
    assert [future.result(10).id for future in heard] == [first.id, last.id]
    writer.close()
    assert written == [first.id, last.id]


def test_times_of_receipt_are_whole_seconds(store):
    answers = [an_answer() for _ in range(3)]
    for answer in answers:
        store.submit(GARMENT, answer)
    assert {row.received.microsecond for row in store.rows(GARMENT)} == {0}


def test_a_version_that_reads_differently_takes_no_answer_beside_the_first_ones(store):
    first = an_answer()
    store.submit(GARMENT, first)
    title = {"zh": GARMENT.title.zh, "en": "Something else"}
    other = Questionnaire.model_validate({**GARMENT.document(), "title": title})
    assert other.digest != GARMENT.digest
    with pytest.raises(AnswerError) as refused:
        store.submit(other, an_answer())
    assert (refused.value.field, refused.value.status) == ("version", 409)
    assert [row.answer for row in store.rows(GARMENT)] == [first]
    assert store.submit(other, first).replayed
