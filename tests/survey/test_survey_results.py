"""The public means: what the scores give at each step, nothing between two, and counted once for each."""

from __future__ import annotations

import threading
from concurrent.futures import ThreadPoolExecutor, wait
from contextlib import closing
from pathlib import Path
from statistics import fmean

import numpy as np
import pytest
from alembic import command
from alembic.config import Config
from sqlalchemy import event, text
from survey_samples import submission

from survey.errors import StoreError
from survey.questionnaire import Answer
from survey.store import migrations
from survey.store.database import tables
from survey.store.publication import Figure

URL = "/api/v1/questionnaires/garment/results"


def fill(store, asked, n: int, seed: int) -> list[Answer]:
    """n answers with a third of their scores not seen."""
    rng = np.random.default_rng(seed)
    answers = []
    for _ in range(n):
        scores = {item: int(rng.integers(1, 6)) if rng.random() > 0.3 else None for item in asked.item_ids}
        answers.append(Answer.of(asked, submission(asked, scores=scores)))
    for waiting in [store.enqueue(asked, answer) for answer in answers]:
        waiting.result(30)
    return answers


@pytest.fixture
def statements(hall):
    """The statements that the store has sent since the list was cleared."""
    sent: list[str] = []

    def note(connection, cursor, statement, *rest):
        sent.append(statement)

    engine = hall.store._engine
    event.listen(engine, "before_cursor_execute", note)
    yield sent
    event.remove(engine, "before_cursor_execute", note)


def shown(hall, key="garment") -> dict:
    return hall.client.get(URL.replace("garment", key)).json()


def row_of(found: dict, item: str) -> dict:
    return next(row for row in found["items"] if row["id"] == item)


@pytest.mark.parametrize("key", ["garment", "platform-user"])
def test_a_step_shows_the_means_of_all_that_stands_and_between_two_nothing_moves(hall, key):
    asked = hall.mounted.questionnaires[key]
    fill(hall.store, asked, 9, 1)
    first = shown(hall, key)
    assert (first["n"], first["items"], first["modules"]) == (0, None, None)
    standing = fill(hall.store, asked, 40, 2)
    found = shown(hall, key)
    given = [dict(stored.answer.scores) for stored in hall.store.rows(asked)]
    assert found["n"] == len(given) == 49
    for row in found["items"]:
        scores = [score for scores in given if (score := scores.get(row["id"])) is not None]
        assert (row["n"], row["decimals"], row["withheld"]) == (len(scores), 1, None)
        assert row["mean"] == pytest.approx(fmean(scores), abs=0.05 + 1e-9)
        assert row["mean"] == round(row["mean"], 1)
    for row in found["modules"]:
        of_items = [row_of(found, item.id) for module in asked.modules if module.id == row["id"]
                    for item in asked.items_of(module)]  # fmt: skip
        assert row["mean"] == pytest.approx(
            sum(item["mean"] * item["n"] for item in of_items) / sum(item["n"] for item in of_items),
            abs=0.0501,
        )
    fill(hall.store, asked, 9, 3)
    assert hall.store.withdraw(key, standing[0].id)
    assert shown(hall, key) == found
    fill(hall.store, asked, 1, 4)
    assert shown(hall, key)["n"] == hall.store.count(key, asked.version) == 58
    hall.store.purge(key, asked.version)
    assert (shown(hall, key)["n"], shown(hall, key)["items"]) == (0, None)


def test_a_restart_and_another_process_show_the_same(hall):
    fill(hall.store, hall.garment, 14, 5)
    first = shown(hall)
    other = type(hall.store)(hall.data)
    try:
        assert other.public(hall.garment) == hall.store.public(hall.garment)
        fill(other, hall.garment, 10, 6)
        assert other.public(hall.garment).n == 24
    finally:
        other.close()
    assert shown(hall)["n"] == 24
    assert first["n"] == 14


def test_two_processes_at_once_take_one_step(hall):
    """Whoever comes second finds that the step is taken, and shows it."""
    fill(hall.store, hall.garment, 12, 7)
    other = type(hall.store)(hall.data)
    ours, theirs = hall.store._publishing, other._publishing
    published = type(ours)._published

    def late(key, draft):
        assert theirs.of(hall.garment).step == 1
        fill(other, hall.garment, 3, 8)
        return published(ours, key, draft)

    ours._published = late
    try:
        found = ours.of(hall.garment)
        assert (found.step, found.n) == (1, 12)
        assert found == theirs.of(hall.garment)
    finally:
        other.close()


def test_an_answer_taken_back_while_a_step_is_made_is_in_no_step(hall):
    answers = fill(hall.store, hall.garment, 10, 9)
    ours = hall.store._publishing
    published = type(ours)._published

    def late(key, draft):
        hall.store.withdraw("garment", answers[0].id)
        return published(ours, key, draft)

    ours._published = late
    assert (shown(hall)["n"], shown(hall)["items"]) == (0, None)
    del ours._published
    assert shown(hall)["n"] == 0
    fill(hall.store, hall.garment, 1, 10)
    assert shown(hall)["n"] == 10


def test_a_database_that_takes_nothing_still_shows_the_last_step(hall):
    fill(hall.store, hall.garment, 20, 11)
    first = shown(hall)
    fill(hall.store, hall.garment, 20, 12)

    def full(*_):
        raise StoreError("the disk is full", "here")

    hall.store._publishing._published = full
    assert shown(hall) == first
    del hall.store._publishing._published
    assert shown(hall)["n"] == 40


def test_an_upgrade_publishes_what_the_last_release_showed(hall):
    """It showed exact means of all that stood: a first step over these and one answer more would tell that answer."""
    fill(hall.store, hall.garment, 14, 20)
    item = hall.garment.item_ids[0]
    with hall.store._read() as connection:
        exact = connection.execute(
            text("SELECT count(score), sum(score) FROM answer WHERE item = :item AND score > 0"),
            {"item": item},
        ).one()
    hall.store.close()
    config = Config()
    config.set_main_option("script_location", str(Path(migrations.__file__).parent))
    engine = tables.open_engine(hall.data)
    with engine.begin() as connection:
        config.attributes["connection"] = connection
        command.downgrade(config, "0003")
    engine.dispose()
    with closing(type(hall.store)(hall.data)) as store:
        first = store.public(hall.garment)
        assert (first.step, first.n) == (1, 14)
        shown = first.items[item]
        assert shown.figure == Figure.of(*exact)
        assert (shown.withheld is None) == (exact[0] >= 10)
        fill(store, hall.garment, 9, 21)
        assert store.public(hall.garment) == first
        fill(store, hall.garment, 1, 22)
        assert store.public(hall.garment).n == 24


def test_what_did_not_change_is_not_counted_again_and_no_row_is_loaded(hall, statements):
    fill(hall.store, hall.garment, 12, 13)
    statements.clear()
    first = shown(hall)
    assert len([sent for sent in statements if "GROUP BY" in sent]) == 1
    statements.clear()
    for _ in range(3):
        assert shown(hall) == first
    assert statements
    assert not [sent for sent in statements if "answer" in sent or "document" in sent]


def test_nobody_waits_while_a_step_over_many_answers_is_taken(hall, statements, monkeypatch):
    """It takes seconds over many answers, and every thread that waited would be one less for the visitors' forms."""
    fill(hall.store, hall.garment, 12, 14)
    publishing, slow = hall.store._publishing, threading.Event()
    looked = publishing._looked

    def slowly(questionnaire):
        assert slow.wait(30)
        return looked(questionnaire)

    publishing._looked = slowly
    with ThreadPoolExecutor(12) as pool:
        asked = [pool.submit(hall.store.public, hall.garment) for _ in range(12)]
        assert not wait(asked, 0.3).done  # there is nothing yet that could be shown
        slow.set()
        assert {future.result(30).n for future in asked} == {12}
        assert len([sent for sent in statements if "GROUP BY" in sent]) == 1
        fill(hall.store, hall.garment, 12, 15)
        monkeypatch.setattr("survey.store.publication.steps.MANY", 12)
        slow.clear()
        asked = [pool.submit(hall.store.public, hall.garment) for _ in range(12)]
        assert {future.result(30).n for future in asked} == {12}
        slow.set()
        publishing._looks[hall.garment.id, hall.garment.version].result(30)
    monkeypatch.undo()
    assert hall.store.public(hall.garment).n == 24


def test_of_many_answers_a_step_waits_for_a_hundredth(hall):
    fill(hall.store, hall.garment, 2000, 15)
    assert shown(hall)["n"] == 2000
    assert row_of(shown(hall), hall.garment.item_ids[0])["decimals"] == 2
    fill(hall.store, hall.garment, 19, 16)
    assert shown(hall)["n"] == 2000
    fill(hall.store, hall.garment, 1, 17)
    assert shown(hall)["n"] == 2020


def test_the_database_keeps_no_sum_beside_what_stands(hall):
    """An exact sum of an earlier step less those that stand would be what was taken back."""
    fill(hall.store, hall.garment, 12, 18)
    shown(hall)
    with hall.store._read() as connection:
        rows = connection.execute(text("SELECT n, units, decimals FROM figure WHERE n > 0")).all()
    assert rows
    assert all(decimals == 1 and 10 <= units <= 50 for _, units, decimals in rows)
