"""The store read column by column says the same as its answers one by one, whatever lies beside them."""

from __future__ import annotations

import uuid
from contextlib import closing
from datetime import datetime

import numpy as np
import pytest
from sqlalchemy import create_engine
from survey_samples import ASSETS, submission

from survey import Answer, Store, read_questionnaire
from survey.errors import StoreError
from survey.export import of_columns, of_rows
from survey.scores import stored_scores
from survey.store.answers import ABSENT, UNSCORED, Archive, read_columns, read_heads, read_texts
from survey.store.database import tables

GARMENT = read_questionnaire(ASSETS / "questionnaires" / "garment.toml")
USER = read_questionnaire(ASSETS / "questionnaires" / "platform-user.toml")
PART = USER.asking(frozenset({"culture"}))


@pytest.fixture
def filled(database):
    """Answers to two questionnaires, to another version of one, to a part of the other; some withdrawn."""
    rng = np.random.default_rng(5)
    older = GARMENT.model_copy(update={"version": GARMENT.version + 1})
    with closing(Store(database)) as store:
        for number in range(60):
            asked, whole = [(GARMENT, GARMENT), (older, older), (USER, USER), (PART, USER)][number % 4]
            scores = {item: int(rng.integers(0, 6)) or None for item in asked.item_ids}
            texts = {
                module.id: f"{number} 好\n{module.id}"
                for module in asked.modules
                if module.suggestion and rng.random() < 0.4
            }
            body = submission(asked, scores=scores, suggestions=texts, exhibit=None if number % 3 else "pibo")
            answer = Answer.of(asked, body)
            store.submit(whole, answer)
            if number % 7 == 0:
                assert store.withdraw(whole.id, answer.id)
        yield store, database, older


def matrix(rows, questionnaire):
    table = [[dict(row.answer.scores).get(item, "absent") for item in questionnaire.item_ids] for row in rows]
    codes = {None: UNSCORED, "absent": ABSENT}
    return np.array([[codes.get(cell, cell) for cell in line] for line in table], dtype=np.int8)


@pytest.mark.parametrize("at_a_time", [1, 7, 100_000])
def test_columns_hold_what_the_answers_hold_in_their_order(filled, monkeypatch, at_a_time):
    monkeypatch.setattr("survey.store.answers.columns._AT_A_TIME", at_a_time)
    store, where, older = filled
    for asked in (GARMENT, older, USER):
        rows = store.rows(asked)
        assert rows
        with Archive(where).snapshot() as connection:
            found, heads = read_columns(connection, asked), read_heads(connection, asked)
            texts = list(read_texts(connection, asked))
        assert [key.decode() for key in found.ids] == [row.answer.id for row in rows]
        np.testing.assert_array_equal(found.scores, matrix(rows, asked))
        assert heads.language.tolist() == [row.answer.language for row in rows]
        assert heads.exhibit.tolist() == [row.answer.exhibit or "" for row in rows]
        times = [datetime.fromisoformat(f"{time}+00:00") for time in heads.received.astype(str)]
        assert times == [row.received for row in rows]
        written = {(row.answer.id.encode(), *one) for row in rows for one in row.answer.suggestions}
        assert set(texts) == written
        assert len(texts) == len(written)


def test_a_sheet_of_columns_is_the_sheet_of_the_answers(filled):
    store, where, _ = filled
    for asked in (GARMENT, USER):
        with Archive(where).snapshot() as connection:
            made = of_columns(
                read_columns(connection, asked), read_heads(connection, asked), read_texts(connection, asked)
            )
            found = list(made.records)
        wanted = of_rows(asked, store.rows(asked))
        assert made.columns == wanted.columns
        assert found == list(wanted.records)


def test_scores_for_the_analysis_leave_out_what_nobody_was_asked(filled):
    store, where, _ = filled
    table = stored_scores(USER, Archive(where), texts=True)
    rows = store.rows(USER)
    np.testing.assert_array_equal(table.scores, np.where((whole := matrix(rows, USER)) > 0, whole, np.nan))
    assert table.suggestions == tuple(one for row in rows for one in row.answer.suggestions)
    alone = [row for row in rows if len(row.answer.scores) < len(USER.items)]
    culture = set(PART.item_ids)
    assert table.unasked == {item: len(alone) for item in USER.item_ids if item not in culture}


def test_rows_that_lie_apart_and_rows_of_nobody_find_their_place_or_none(filled):
    store, where, _ = filled
    before = stored_scores(GARMENT, Archive(where), texts=False).scores
    ids = [row.answer.id for row in store.rows(GARMENT)]
    url = where if isinstance(where, str) else f"sqlite:///{where / tables.SQLITE_FILE}"
    engine = create_engine(url)
    with engine.begin() as connection:
        rows = connection.execute(
            tables.answer.select().where(tables.answer.c.submission.in_(ids))
        ).mappings()
        again = [dict(row) for row in rows]
        connection.execute(tables.answer.delete().where(tables.answer.c.submission.in_(ids)))
        np.random.default_rng(1).shuffle(again)
        connection.execute(tables.answer.insert(), again)
        stranger = [{"submission": ids[0], "item": "gone_since", "score": 3}]
        connection.execute(tables.answer.insert(), stranger)
    engine.dispose()
    np.testing.assert_array_equal(stored_scores(GARMENT, Archive(where), texts=False).scores, before)


def test_no_answers_make_an_empty_table(database):
    with closing(Store(database)):
        table = stored_scores(GARMENT, Archive(database), texts=True)
    assert table.scores.shape == (0, len(GARMENT.items))
    assert table.items == GARMENT.item_ids


@pytest.mark.parametrize("database", ["sqlite"], indirect=True)
def test_an_archive_makes_nothing_and_writes_nothing(filled, tmp_path):
    _, where, _ = filled
    with Archive(where).snapshot() as connection:
        with pytest.raises(Exception, match="readonly"):
            connection.exec_driver_sql(f"DELETE FROM answer WHERE submission = '{uuid.uuid4()}'")
    with pytest.raises(StoreError, match="no such store"), Archive(tmp_path / "typo").snapshot():
        pass
    assert not (tmp_path / "typo").exists()
