"""Foreign answers beside the questionnaire's scale: what it does not have is named, and our code for "not seen"."""

from __future__ import annotations

import json
from datetime import UTC, datetime

import numpy as np
import pandas
import pyreadstat
import pytest
from survey_samples import ASSETS, submission

from survey.cli import main
from survey.demonstration import SAMPLES, sample_file
from survey.export import exported
from survey.questionnaire import UNSEEN, Answer, read_questionnaire
from survey.scores import read_scores
from survey.store import Stored

GARMENT = read_questionnaire(ASSETS / "questionnaires" / "garment.toml")
ITEMS = GARMENT.item_ids


@pytest.fixture
def scores():
    """(200, 12) whole scores 1–5."""
    return read_scores(sample_file("likert-200"), GARMENT).scores.copy()


@pytest.fixture
def told(tmp_path, capsys):
    """The items and messages of off_scale in the analysis of a table, a data frame or a file, by the command."""

    def analysed(table) -> dict[tuple[str, ...], str]:
        path = table
        if isinstance(table, np.ndarray):
            table = pandas.DataFrame(table, columns=list(ITEMS))
        if isinstance(table, pandas.DataFrame):
            path = tmp_path / "foreign.csv"
            table.to_csv(path, index=False)
        arguments = ["analyse", str(path), "--questionnaire", "garment", "--content", str(ASSETS), "--json"]
        assert main([*arguments, "--bootstrap", "0", "--parallel", "0"]) == 0
        notes = json.loads(capsys.readouterr().out)["warnings"]
        return {tuple(note["items"]): note["message"] for note in notes if note["code"] == "off_scale"}

    return analysed


def test_scores_and_gaps_are_nothing_to_name(told, scores):
    scores[4, 0] = np.nan
    assert told(scores) == {}


def test_a_score_that_the_scale_does_not_have_is_named(told, scores):
    scores[7, 2], scores[8, 2], scores[9, 3] = 55, 0, 3.5
    scores[3, 4] = scores[5, 4] = scores[6, 5] = UNSEEN
    scores[6, 6], scores[7, 6] = UNSEEN, 6
    found = told(scores)
    assert set(found) == {(ITEMS[2], ITEMS[3], ITEMS[6]), (ITEMS[4], ITEMS[5])}
    assert "5 scores off the scale of 1 to 5 (0, 3.5, 6, 9, 55)" in found[ITEMS[2], ITEMS[3], ITEMS[6]]
    assert "3 times 9" in found[ITEMS[4], ITEMS[5]]
    assert f"RECODE {ITEMS[4]} … (9 = SYSMIS)" in found[ITEMS[4], ITEMS[5]]


def test_not_seen_of_our_own_sav_is_told_from_a_score_and_left_out_as_advised(told, scores, tmp_path):
    answers = []
    for number, row in enumerate(scores[:40].astype(int).tolist()):
        given = dict(zip(ITEMS, row, strict=True)) | ({ITEMS[-1]: None} if number % 3 == 0 else {})
        answer = Answer.of(GARMENT, submission(GARMENT, scores=given))
        answers.append(Stored(answer, datetime(2026, 1, 1, tzinfo=UTC)))
    (tmp_path / "a.sav").write_bytes(exported("sav", GARMENT, answers))
    table = pandas.DataFrame(pyreadstat.read_sav(str(tmp_path / "a.sav"), user_missing=True)[0])
    ((items, message),) = told(table).items()
    assert items == (ITEMS[-1],)
    assert message.startswith("14 times 9")
    assert told(table.replace({ITEMS[-1]: {float(UNSEEN): np.nan}})) == {}


@pytest.mark.parametrize(
    "sample", [name for name in SAMPLES if name != "primary-200"]
)  # which has other items
def test_the_shipped_samples_are_not_measured_by_it(told, sample):
    assert told(sample_file(sample)) == {}
    assert read_scores(sample_file(sample)).synthetic


def test_a_foreign_table_is_not_called_synthetic(tmp_path):
    text = "submission,a,b\nsynthetic-1,1,2\nmine,2,3\n"
    (tmp_path / "a.csv").write_text(text, "utf-8")
    assert not read_scores(tmp_path / "a.csv").synthetic
