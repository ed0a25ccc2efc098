"""The public means: what the scores give, from five answers on, and counted once for each change of the store."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor, wait
from statistics import fmean

import numpy as np
import pytest
from sqlalchemy import event
from survey_samples import submission

from survey.answer import Answer
from survey.questionnaire import Questionnaire

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


def rows_of(answers: list[Answer], groups: dict[str, list[str]]) -> list[tuple[str, int, float | None]]:
    """(id, n, mean) of each group of items, straight from the answers."""
    rows = []
    for key, items in groups.items():
        given = [[s for i, s in answer.scores if i in items and s is not None] for answer in answers]
        given = [scores for scores in given if scores]
        mean = fmean(score for scores in given for score in scores) if len(given) >= 5 else None
        rows.append((key, len(given), mean))
    return rows


def groups_of(asked: Questionnaire) -> tuple[dict[str, list[str]], dict[str, list[str]]]:
    modules = {module.id: [item.id for item in asked.items_of(module)] for module in asked.modules}
    return {item: [item] for item in asked.item_ids}, modules


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


def shown(hall, key="garment"):
    found = hall.client.get(URL.replace("garment", key)).json()
    return found, *(
        None if found[part] is None else [(row["id"], row["n"], row["mean"]) for row in found[part]]
        for part in ("items", "modules")
    )


@pytest.mark.parametrize("key", ["garment", "platform-user"])
def test_means_are_those_of_the_scores_whatever_comes_and_goes(hall, key):
    asked = hall.mounted.questionnaires[key]
    by_item, by_module = groups_of(asked)
    standing: list[Answer] = []
    for n, seed in ((4, 1), (1, 2), (3, 3), (30, 4)):
        standing += fill(hall.store, asked, n, seed)
        for _ in range(2):
            found, items, modules = shown(hall, key)
            assert found["n"] == len(standing)
            enough = len(standing) >= 5
            assert items == (rows_of(standing, by_item) if enough else None)
            assert modules == (rows_of(standing, by_module) if enough else None)
    while len(standing) > 3:
        assert hall.store.withdraw(key, standing.pop().id)
        found, items, _ = shown(hall, key)
        assert found["n"] == len(standing)
        assert items == (rows_of(standing, by_item) if len(standing) >= 5 else None)
    hall.store.purge(key, asked.version)
    assert shown(hall, key)[0]["n"] == 0


def test_what_did_not_change_is_not_counted_again_and_no_row_is_loaded(hall, statements):
    fill(hall.store, hall.garment, 12, 5)
    first = shown(hall)
    statements.clear()
    for _ in range(3):
        assert shown(hall) == first
    assert statements
    assert not [text for text in statements if "answer" in text or "document" in text]
    fill(hall.store, hall.garment, 1, 6)
    statements.clear()
    assert shown(hall)[0]["n"] == 13
    assert [text for text in statements if "sum(answer.score)" in text]
    assert not [text for text in statements if "answer.score" in text and "GROUP BY" not in text]


def test_many_who_ask_at_once_are_served_by_few_counts(hall, statements):
    fill(hall.store, hall.garment, 8, 9)
    held = hall.store._tallies._looking
    with ThreadPoolExecutor(12) as pool:
        with held:
            asked = [pool.submit(hall.store.tally, hall.garment) for _ in range(12)]
            wait(asked, 0.5)
            statements.clear()
        counts = {future.result(30).n for future in asked}
    assert counts == {8}
    assert len([text for text in statements if "sum(answer.score)" in text]) == 2  # items, modules
    assert len([text for text in statements if "max(submission.received)" in text]) < 12


def test_an_answer_that_another_process_wrote_counts_at_once(hall):
    fill(hall.store, hall.garment, 6, 7)
    before = shown(hall)[0]
    with_own_cache = type(hall.store)(hall.data)
    try:
        fill(with_own_cache, hall.garment, 1, 8)
    finally:
        with_own_cache.close()
    assert (before["n"], shown(hall)[0]["n"]) == (6, 7)
