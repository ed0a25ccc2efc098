"""Exports: what goes out comes back the same, and runs nothing."""

from __future__ import annotations

import csv
import io
import json
from datetime import UTC, datetime
from typing import Any

import numpy as np
import pyreadstat
import pytest
from openpyxl import load_workbook
from survey_samples import ASSETS, submission

from survey.export import (
    FORMATS,
    Replication,
    csv_columns,
    exported,
    safe_cell,
    variables,
    write_r,
)
from survey.questionnaire import UNSEEN, Answer, read_questionnaire
from survey.store import Stored

GARMENT = read_questionnaire(ASSETS / "questionnaires" / "garment.toml")
PLATFORM = read_questionnaire(ASSETS / "questionnaires" / "platform-user.toml")
WHEN = datetime(2026, 3, 4, 5, 6, 7, tzinfo=UTC)
NASTY = [
    "=1+1",
    " =1+1",
    "\u3000=cmd",
    "\t=1",
    "＝1+1",
    "－2",
    "@SUM(A1)",
    "+1",
    "-1",
    '=HYPERLINK("x")',
    "good = fine",
]


def stored(questionnaire, texts=NASTY):
    rows = []
    for number, text in enumerate(texts):
        scores = {
            item: None if (number + at) % 7 == 0 else 1 + (number + at) % 5
            for at, item in enumerate(questionnaire.item_ids)
        }
        body = submission(questionnaire, scores=scores)
        answer = Answer.of(questionnaire, body)
        # Straight into the answer: the door strips white space, an older or another store may not have.
        answer = Answer(**{**answer.__dict__, "suggestions": ((questionnaire.modules[0].id, text),)})
        rows.append(Stored(answer, WHEN))
    return rows


def given(rows, questionnaire):
    return [[dict(row.answer.scores)[item] for item in questionnaire.item_ids] for row in rows]


def read_sav(path, **options) -> tuple[Any, Any]:
    """pyreadstat names pandas' class by a path that the checker does not know."""
    return pyreadstat.read_sav(path, **options)


@pytest.mark.parametrize(
    "text", [text for text in NASTY if text != "good = fine"] + ["\n=1", "\r=1", "\u00a0+1"]
)
def test_a_formula_gets_an_apostrophe_also_behind_white_space(text):
    assert safe_cell(text) == "'" + text


@pytest.mark.parametrize("text", ["", "good = fine", "很好", "  spaced", "1-2", "a@b"])
def test_plain_text_stays_as_it_is(text):
    assert safe_cell(text) == text


@pytest.mark.parametrize("questionnaire", [GARMENT, PLATFORM], ids=["garment", "platform"])
def test_csv_comes_back_the_same(questionnaire):
    rows = stored(questionnaire)
    text = exported("csv", questionnaire, rows).decode()
    assert text.startswith("\ufeff")
    back = list(csv.DictReader(io.StringIO(text.removeprefix("\ufeff"), newline="")))
    scores = [[int(row[item]) if row[item] else None for item in questionnaire.item_ids] for row in back]
    assert scores == given(rows, questionnaire)
    column = f"suggestion_{questionnaire.modules[0].id}"
    assert [row[column] for row in back] == [safe_cell(text) for text in NASTY]


@pytest.mark.parametrize("questionnaire", [GARMENT, PLATFORM], ids=["garment", "platform"])
def test_the_workbook_comes_back_the_same_and_holds_no_formula(questionnaire):
    rows = stored(questionnaire)
    book = load_workbook(io.BytesIO(exported("xlsx", questionnaire, rows)))
    head, *body = book["answers"].iter_rows()
    assert [cell.value for cell in head] == csv_columns(questionnaire)
    assert all(cell.data_type != "f" for line in book["answers"].iter_rows() for cell in line)
    at = [csv_columns(questionnaire).index(item) for item in questionnaire.item_ids]
    assert [[line[column].value for column in at] for line in body] == given(rows, questionnaire)
    assert [cell.value for cell in book["codebook"]["A"]][1:] == csv_columns(questionnaire)


@pytest.mark.parametrize("questionnaire", [GARMENT, PLATFORM], ids=["garment", "platform"])
def test_sav_comes_back_with_scores_labels_and_missing_values(questionnaire, tmp_path):
    rows = stored(questionnaire)
    path = tmp_path / "a.sav"
    path.write_bytes(exported("sav", questionnaire, rows))
    table, meta = read_sav(path)
    assert list(table.columns) == csv_columns(questionnaire)
    back = [
        [None if np.isnan(x) else int(x) for x in row]
        for row in table[list(questionnaire.item_ids)].to_numpy()
    ]
    assert back == given(rows, questionnaire)
    raw, marked = read_sav(path, user_missing=True)
    first = questionnaire.item_ids[0]
    assert raw[first][0] == UNSEEN
    labels = meta.variable_value_labels[first]
    assert labels[1] == f"{questionnaire.scale.anchors[0].zh} / {questionnaire.scale.anchors[0].en}"
    assert labels[UNSEEN].startswith(questionnaire.scale.not_seen.zh)
    assert marked.missing_ranges[first] == [{"lo": UNSEEN, "hi": UNSEEN}]
    label = {one.column: one.label for one in variables(questionnaire)}
    assert meta.column_names_to_labels[first] == " / ".join(label[first])
    assert meta.variable_measure[first] == "ordinal"


def test_json_holds_the_questionnaire_and_every_answer():
    rows = stored(GARMENT)
    told = json.loads(exported("json", GARMENT, rows))
    assert type(GARMENT).model_validate(told["questionnaire"]) == GARMENT
    assert [list(answer["scores"].values()) for answer in told["answers"]] == given(rows, GARMENT)
    assert [answer["suggestions"]["fabric"] for answer in told["answers"]] == NASTY


def test_the_codebook_names_every_column_in_both_languages():
    text = exported("codebook", PLATFORM, []).decode("utf-8-sig")
    table = list(csv.DictReader(io.StringIO(text, newline="")))
    assert [row["column"] for row in table] == csv_columns(PLATFORM)
    tone = next(row for row in table if row["column"] == "culture_tone")
    assert tone["label_zh"] == "传统民族服饰文化 · 色调"
    assert tone["values_en"].startswith("1 = Very unreasonable; 2 = ")
    assert tone["missing"] == "未使用 / Not used; . = 未询问 / not asked (needs culture)"


@pytest.mark.parametrize("kind", FORMATS)
def test_no_answers_make_a_file_all_the_same(kind):
    assert len(exported(kind, GARMENT, [])) > 100


def test_the_r_script_names_items_and_choices_and_escapes_names():
    script = write_r(
        Replication(['a"b', "c"], dropped=["c"], rotation="oblimin", factors=2, missing="pairwise")
    )
    assert 'items <- c("a\\"b", "c")' in script
    assert 'dropped <- c("c")' in script
    assert "keep <- 2\n" in script
    assert "@" not in script.replace("@@", "")
