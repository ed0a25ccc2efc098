"""What a researcher reads over HTTP: files, rows, the analysis; and how each wrong question is refused."""

from __future__ import annotations

import csv
import io
import json
import subprocess
import sys

import numpy as np
import pyreadstat
import pytest
from full_matrix import by_day
from openpyxl import load_workbook
from survey_samples import ASSETS, likert_sample, submission

from survey import Answer
from survey.analysis import Context, Settings, analyse, summary
from survey.analysis.procedure import KEYS
from survey.cli import main
from survey.export import FORMATS
from survey.scores import stated_groups

BASE = "/api/v1/questionnaires"
GUARDED = ["rows", "suggestions", "analysis", *(f"export/{kind}" for kind in FORMATS)]


@pytest.fixture
def researcher(hall):
    return {"authorization": f"Bearer {hall.store.tokens.make('researcher')}"}


def fill(hall, table) -> None:
    """Store whole scores (n, p) as answers; the last of each row is a suggestion's worth of text."""
    garment = hall.garment
    for row in table:
        scores = dict(zip(garment.item_ids, map(int, row), strict=True))
        body = submission(garment, scores=scores, suggestions={"form": "=1+1"})
        hall.store.submit(garment, Answer.of(garment, body))


def twelve(n: int, seed: int = 1):
    return np.column_stack([likert_sample(n, seed), likert_sample(n, seed + 1)[:, :2]])


@pytest.mark.parametrize("path", GUARDED)
def test_without_a_token_nothing_is_told_not_even_whether_there_is_such_a_questionnaire(hall, path):
    for key in ("garment", "nonsense"):
        for query in ("", "?version=99", "?colour=red"):
            refused = hall.client.get(f"{BASE}/{key}/{path}{query}")
            assert refused.status_code == 401
            assert refused.json()["field"] == "authorization"
            assert refused.headers["www-authenticate"] == "Bearer"


READERS = {
    "csv": ("text/csv", lambda data: list(csv.DictReader(io.StringIO(data.decode("utf-8-sig"), newline="")))),
    "xlsx": (
        "application/vnd.openxmlformats",
        lambda data: list(load_workbook(io.BytesIO(data))["answers"].iter_rows())[1:],
    ),
    "json": ("application/json", lambda data: json.loads(data)["answers"]),
    "codebook": (
        "text/csv",
        lambda data: [line for line in data.decode("utf-8-sig").splitlines() if ",score," in line],
    ),
}


@pytest.mark.parametrize("kind", by_day(["xlsx"], READERS))
def test_each_format_comes_with_its_type_its_name_and_every_answer(hall, researcher, kind):
    fill(hall, twelve(12))
    reply = hall.client.get(f"{BASE}/garment/export/{kind}", headers=researcher)
    kind_of, read = READERS[kind]
    assert reply.status_code == 200
    assert reply.headers["content-type"].startswith(kind_of)
    assert f'filename="garment-v{hall.garment.version}' in reply.headers["content-disposition"]
    assert reply.headers["cache-control"] == "no-store"
    assert len(read(reply.content)) == 12


@pytest.mark.nightly
@pytest.mark.parametrize("database", ["sqlite"], indirect=True)
def test_spss_and_the_r_script_come_over_http_too(hall, researcher, tmp_path):
    fill(hall, twelve(12))
    (tmp_path / "a.sav").write_bytes(
        hall.client.get(f"{BASE}/garment/export/sav", headers=researcher).content
    )
    _, meta = pyreadstat.read_sav(tmp_path / "a.sav")
    assert meta.number_rows == 12
    script = hall.client.get(f"{BASE}/garment/export/r", headers=researcher)
    stem = f"garment-v{hall.garment.version}"
    assert f'filename="{stem}.R"' in script.headers["content-disposition"]
    # The script reads the file that the CSV route names.
    assert f'else "{stem}.csv"' in script.text


def test_the_analysis_over_http_is_that_of_the_command(hall, researcher, capsys):
    table = twelve(60)
    fill(hall, table)
    query = {"drop": "static", "rotation": "oblimin", "factors": "2", "bootstrap": 50, "seed": 3}
    reply = hall.client.get(f"{BASE}/garment/analysis", params=query, headers=researcher)
    assert reply.status_code == 200
    found = json.loads(reply.content, parse_constant=lambda name: pytest.fail(name))
    assert tuple(found) == KEYS
    where = ["--db", hall.data] if isinstance(hall.data, str) else ["--data", str(hall.data)]
    words = [part for key, value in query.items() for part in (f"--{key}", str(value))]
    arguments = ["analyse", "--questionnaire", "garment", "--json", "--content", str(ASSETS)]
    assert main([*arguments, *where, *words]) == 0
    assert json.loads(capsys.readouterr().out) == found
    assert found["dropped"] == ["static_drape", "static_overall"]
    assert found["bootstrap"]["seed"] == 3


CHOICES = {
    "none": ({}, Settings()),
    "missing": ({"missing": "pairwise"}, Settings(missing="pairwise")),
    "correlation": ({"correlation": "polychoric"}, Settings(method="polychoric")),
    "factors": ({"factors": "parallel", "seed": 5}, Settings(factors="parallel", seed=5)),
    "rotation": ({"rotation": "none"}, Settings(rotation="none")),
    "drop": ({"drop": "pleat,silhouette"}, Settings(drop=("pleat", "silhouette"))),
}


@pytest.mark.nightly
@pytest.mark.parametrize("choice", by_day(["drop"], CHOICES))
@pytest.mark.parametrize("database", ["sqlite"], indirect=True)
def test_every_choice_of_the_analysis_reaches_it(hall, researcher, choice):
    query, settings = CHOICES[choice]
    fill(hall, twelve(60))
    stored = np.array(
        [[score for _, score in row.answer.scores] for row in hall.store.rows(hall.garment)], float
    )
    reply = hall.client.get(f"{BASE}/garment/analysis", params=query, headers=researcher)
    groups = stated_groups(hall.garment)
    wanted = summary(
        analyse(stored, hall.garment.item_ids, settings=settings, context=Context(groups=groups))
    )
    assert reply.json() == json.loads(json.dumps(wanted))


UNFIT = {
    "no answers": (lambda: twelve(12)[:0], "too_few_rows", "needs at least two"),
    "one answer": (lambda: twelve(12)[:1], "too_few_rows", "needs at least two"),
    "all equal": (lambda: np.full((9, 12), 4.0), "all_equal", "the same score in all answers"),
}


@pytest.mark.parametrize("case", by_day(["one answer"], UNFIT))
def test_answers_that_cannot_be_analysed_are_422_with_the_reason(hall, researcher, case):
    table, code, reason = UNFIT[case]
    fill(hall, table())
    refused = hall.client.get(f"{BASE}/garment/analysis", headers=researcher)
    assert refused.status_code == 422
    told = refused.json()
    assert set(told) == {"field", "problem", "remedy"}
    assert told["field"] == code
    assert reason in told["problem"] + told["remedy"]
    assert told["remedy"]


@pytest.mark.nightly
@pytest.mark.parametrize("database", ["sqlite"], indirect=True)
def test_an_item_that_nobody_saw_and_an_item_that_is_none_are_named(hall, researcher):
    garment = hall.garment
    for row in twelve(20):
        scores = dict(zip(garment.item_ids, map(int, row), strict=True)) | {"pleat": None}
        hall.store.submit(garment, Answer.of(garment, submission(garment, scores=scores)))
    url = f"{BASE}/garment/analysis"
    refused = hall.client.get(url, headers=researcher)
    assert (refused.status_code, refused.json()["field"]) == (422, "not_finite")
    assert "pleat" in refused.json()["problem"]
    assert hall.client.get(url, params={"drop": "pleat"}, headers=researcher).status_code == 200
    refused = hall.client.get(url, params={"drop": "shoes"}, headers=researcher)
    assert refused.status_code == 422
    assert "shoes: no such item" in refused.json()["problem"]


WRONG = {
    "rotation": ("analysis?rotation=promax", 422, "rotation"),
    "factors": ("analysis?factors=0", 422, "factors"),
    "factors text": ("analysis?factors=many", 422, "factors"),
    "missing": ("analysis?missing=median", 422, "missing"),
    "correlation": ("analysis?correlation=spearman", 422, "correlation"),
    "bootstrap": ("analysis?bootstrap=1001", 422, "bootstrap"),
    "bootstrap below": ("analysis?bootstrap=-1", 422, "bootstrap"),
    "seed": ("analysis?seed=2147483648", 422, "seed"),
    "drop NUL": ("analysis?drop=%00", 422, "drop"),
    "drop long": ("analysis?drop=" + "x" * 2001, 422, "drop"),
    "misspelt": ("analysis?rotatoin=oblimin", 422, "rotatoin"),
    "misspelt version": ("rows?versoin=1", 422, "versoin"),
    "version 0": ("export/csv?version=0", 422, "version"),
    "version text": ("suggestions?version=one", 422, "version"),
    "version unknown": ("export/xlsx?version=7", 404, "version"),
    "format": ("export/pdf", 422, "kind"),
}


@pytest.mark.parametrize("database", ["sqlite"], indirect=True)
@pytest.mark.parametrize("case", WRONG)
def test_a_wrong_question_names_the_parameter(hall, researcher, case):
    path, status, field = WRONG[case]
    fill(hall, twelve(3))
    refused = hall.client.get(f"{BASE}/garment/{path}", headers=researcher)
    assert (refused.status_code, refused.json()["field"]) == (status, field)
    assert refused.json()["problem"]
    assert refused.json()["remedy"]


@pytest.mark.parametrize("path", GUARDED)
def test_an_unknown_questionnaire_names_those_there_are(hall, researcher, path):
    refused = hall.client.get(f"{BASE}/shoes/{path}", headers=researcher)
    assert (refused.status_code, refused.json()["field"]) == (404, "questionnaire")
    assert "garment" in refused.json()["remedy"]


@pytest.mark.parametrize("database", ["sqlite"], indirect=True)
def test_an_earlier_version_is_read_after_the_file_was_raised_and_removed(hall, researcher, monkeypatch):
    fill(hall, twelve(4))
    folder = hall.mounted.questionnaires
    path = folder.folder / "garment.toml"
    now = hall.garment.version
    raised = hall.garment.model_copy(update={"version": now + 1})
    monkeypatch.setitem(folder._good, path, raised)
    url = f"{BASE}/garment/rows"
    assert hall.client.get(url, headers=researcher).json() == []
    assert len(hall.client.get(f"{url}?version={now}", headers=researcher).json()) == 4
    assert (
        hall.client.get(f"{url}?version={now + 9}", headers=researcher).json()["remedy"]
        == f"choose one of {now}"
    )
    monkeypatch.delitem(folder._good, path)
    assert hall.client.get(url, headers=researcher).status_code == 404
    assert len(hall.client.get(f"{url}?version={now}", headers=researcher).json()) == 4


def test_the_service_starts_without_the_statistics():
    heavy = (
        "numpy",
        "scipy",
        "pandas",
        "matplotlib",
        "factor_analyzer",
        "sklearn",
        "xlsxwriter",
        "pyreadstat",
    )
    code = (
        "import sys, survey.web.service, survey.web.api, survey.web.form;"
        f"print([name for name in {heavy} if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
