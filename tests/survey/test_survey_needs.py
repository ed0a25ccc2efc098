"""Parts of a questionnaire that a place has not got are not asked, and that can be told from what was left out."""

from __future__ import annotations

import csv
import io
import json
import tempfile
import uuid
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fastapi import FastAPI
from fastapi.testclient import TestClient
from survey_samples import ASSETS

import survey
from survey.cli import main
from survey.errors import QuestionnaireError
from survey.export import exported
from survey.questionnaire import NEEDS, read_questionnaire
from survey.scores import load_scores, read_scores
from survey.web.form import Ways

USER = read_questionnaire(ASSETS / "questionnaires" / "platform-user.toml")
HALL = [f"hall_{side.id}" for side in USER.dimensions]
CULTURE = [f"culture_{side.id}" for side in USER.dimensions]
URL = "/api/v1/questionnaires/platform-user"

MIXED = """
id = "mixed"
version = 1
title = { zh = "甲", en = "A" }
intro = { zh = "甲", en = "A" }
consent = { zh = "甲", en = "A" }
[scale]
anchors = [{ zh = "一", en = "1" }, { zh = "二", en = "2" }, { zh = "三", en = "3" }]
[[module]]
id = "m"
title = { zh = "甲", en = "A" }
[[module.item]]
id = "here"
label = { zh = "甲", en = "A" }
[[module.item]]
id = "booked"
needs = "visit"
label = { zh = "乙", en = "B" }
[[module]]
id = "n"
needs = "office"
title = { zh = "乙", en = "B" }
[[module.item]]
id = "kept"
label = { zh = "丙", en = "C" }
"""


def place(data: Path | str, offers, content: Path = ASSETS, **more):
    app = FastAPI()
    mounted = survey.mount(app, content=content, data=data, offers=offers, **more)
    return TestClient(app, raise_server_exceptions=False), mounted


def given(items: list[str], score: int | None = 4, **more) -> dict:
    return {
        "id": str(uuid.uuid4()),
        "version": USER.version,
        "language": "en",
        "consent": True,
        "scores": dict.fromkeys(items, score),
    } | more


def test_items_and_modules_are_asked_where_what_they_need_is_there(tmp_path):
    (tmp_path / "questionnaires").mkdir()
    file = tmp_path / "questionnaires/mixed.toml"
    file.write_text(MIXED, "utf-8")
    mixed = read_questionnaire(file)
    assert mixed.asking(None) is mixed
    assert mixed.asking(frozenset()).item_ids == ("here",)
    assert mixed.asking(frozenset({"visit"})).item_ids == ("here", "booked")
    assert mixed.asking(frozenset({"office"})).item_ids == ("here", "kept")
    assert mixed.asking(frozenset(NEEDS)).item_ids == mixed.item_ids
    assert mixed.asked({"kept"}).item_ids == ("kept",)
    file.write_text(MIXED.replace('"visit"', '"kitchen"'), "utf-8")
    with pytest.raises(QuestionnaireError) as refused:
        read_questionnaire(file)
    (problem,) = refused.value.problems
    assert "needs" in problem.key
    assert all(need in str(problem) for need in (*NEEDS, "kitchen"))


def test_versions_frozen_before_there_were_needs_keep_their_digest():
    garment = read_questionnaire(ASSETS / "questionnaires" / "garment.toml")
    assert "needs" not in json.dumps(garment.document())
    assert json.dumps(USER.document()).count('"needs"') == 4
    again = type(USER).model_validate(USER.document())
    assert again.digest == USER.digest


def test_the_form_and_the_api_ask_what_is_there(tmp_path):
    client, mounted = place(tmp_path, frozenset({"culture"}))
    with client:
        page = client.get("/questionnaires/platform-user?lang=en").text
        assert page.count('role="radiogroup"') == 12
        assert "User centre" not in page
        shown = client.get(URL).json()
        assert [module["id"] for module in shown["modules"]] == ["hall", "culture"]
        schema = client.get(f"{URL}/submission.schema.json").json()
        assert list(schema["properties"]["scores"]["properties"]) == HALL + CULTURE
        assert client.post(f"{URL}/submissions", json=given(HALL + CULTURE)).status_code == 201
        assert client.post(f"{URL}/submissions", json=given(HALL)).status_code == 422
        assert client.post(f"{URL}/submissions", json=given(list(USER.item_ids))).status_code == 422
        (row,) = mounted.store.rows(USER)
        assert [item for item, _ in row.answer.scores] == HALL + CULTURE
        frozen = mounted.store.frozen(USER.id, USER.version)
        assert frozen is not None
        assert frozen.digest == USER.digest, "the version is frozen whole"
        assert not mounted.problems
    mounted.close()


def test_a_questionnaire_of_which_nothing_is_there_is_not_offered(tmp_path):
    client, mounted = place(tmp_path, frozenset())
    with client:
        assert mounted.asks("platform-user")
        assert not mounted.asks("platform-admin")
        assert not mounted.asks("no-such")
        listed = client.get("/questionnaires?lang=en").text
        assert "platform-user" in listed
        assert "platform-admin" not in listed
        page = client.get("/questionnaires/platform-admin?lang=en")
        assert page.status_code == 404
        assert "nothing to rate here yet" in page.text
        answer = given([], version=3)
        refused = client.post(URL.replace("user", "admin") + "/submissions", json=answer)
        assert refused.status_code == 404
        assert refused.json()["field"] == "questionnaire"
    mounted.close()


def test_a_replay_is_known_also_when_the_place_has_grown(tmp_path):
    body = given(HALL)
    for offers, status in ((frozenset(), 201), (frozenset(), 200), (frozenset(NEEDS), 200), (None, 200)):
        client, mounted = place(tmp_path, offers)
        with client:
            assert client.post(f"{URL}/submissions", json=body).status_code == status
            other = body | {"scores": dict.fromkeys(HALL, 1)}
            assert client.post(f"{URL}/submissions", json=other).status_code == 409
        mounted.close()


NOWHERE, VISIT = frozenset(), frozenset({"visit"})


def write_optional(content: Path, *, version: int = 1) -> Path:
    """A content folder with "mixed", of which only the office's item must be answered."""
    file = content / "questionnaires/mixed.toml"
    file.parent.mkdir(parents=True, exist_ok=True)
    text = MIXED.replace("version = 1", f"version = {version}")
    for line in ('id = "here"', 'needs = "visit"'):
        text = text.replace(line, f"{line}\nrequired = false")
    file.write_text(text, "utf-8")
    return content


@pytest.mark.parametrize("version", [1, 2], ids=["same version", "raised version"])
@pytest.mark.parametrize(
    ("first", "later"),
    [(None, None), (VISIT, VISIT), (VISIT, NOWHERE), (NOWHERE, VISIT), (NOWHERE, None), (None, NOWHERE)],
    ids=["all", "part", "shrunk", "grown", "grown to all", "shrunk from all"],
)
def test_a_replay_that_left_out_optional_items_is_known(database, tmp_path, first, later, version):
    url = f"{URL.replace('platform-user', 'mixed')}/submissions"
    scores = {"kept": 3} if first is None else {}  # the form sends what was chosen, and nothing else
    body = given([], version=1, scores=scores)
    content = write_optional(tmp_path / "content")
    for offers, statuses in ((first, [201, 200]), (later, [200, 200])):
        client, mounted = place(database, offers, content)
        with client:
            assert [client.post(url, json=body).status_code for _ in range(2)] == statuses
            for other in ({"scores": scores | {"here": 2}}, {"language": "zh"}):
                assert client.post(url, json=body | other).status_code == 409
        mounted.close()
        write_optional(content, version=version)
    client, mounted = place(database, later, content)
    with client:
        assert client.delete(f"{url}/{body['id']}").status_code == 204
        assert client.post(url, json=body).status_code == 410
    mounted.close()


@pytest.fixture
def answered(tmp_path):
    """A store with answers to two sets of offers; in the second, one item was not seen."""
    for offers, items in ((frozenset(), HALL), (frozenset({"culture"}), HALL + CULTURE)):
        client, mounted = place(tmp_path, offers)
        with client:
            for score in range(1, 6):
                body = given(items, score)
                body["scores"][HALL[0]] = None if score == 1 else score
                assert client.post(f"{URL}/submissions", json=body).status_code == 201
        mounted.close()
    return tmp_path


def test_not_asked_is_told_from_not_seen_in_every_export(answered):
    _, mounted = place(answered, None)
    rows = mounted.store.rows(USER)
    table = list(csv.DictReader(io.StringIO(exported("csv", USER, rows).decode("utf-8-sig"))))
    assert [line["culture_tone"] for line in table].count(".") == 5
    assert [line["account_tone"] for line in table] == ["."] * 10
    assert [line[HALL[0]] for line in table].count("") == 2
    answers = json.loads(exported("json", USER, rows))["answers"]
    assert sorted(len(answer["scores"]) for answer in answers) == [6] * 5 + [12] * 5
    book = list(csv.DictReader(io.StringIO(exported("codebook", USER, rows).decode("utf-8-sig"))))
    missing = {line["column"]: line["missing"] for line in book}
    assert "not asked" in missing["culture_tone"]
    assert "not asked" not in missing[HALL[0]]
    assert exported("xlsx", USER, rows)
    script = exported("r", USER, rows).decode()
    assert "culture_tone" in script
    assert "account_tone" not in script
    mounted.close()


def test_spss_has_a_value_of_its_own_for_what_was_not_asked(answered):
    import pyreadstat

    _, mounted = place(answered, None)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.sav"
        path.write_bytes(exported("sav", USER, mounted.store.rows(USER)))
        read: Any = pyreadstat.read_sav(str(path), user_missing=True)
    table, meta = read
    assert sorted(table["culture_tone"]) == [1, 2, 3, 4, 5, 8, 8, 8, 8, 8]
    assert sorted(table[HALL[0]])[-2:] == [9, 9]
    assert "Not asked" in meta.variable_value_labels["culture_tone"][8]
    assert 8 not in meta.variable_value_labels[HALL[0]]
    mounted.close()


def test_what_nobody_was_asked_is_no_column_of_the_analysis(answered, tmp_path):
    found = load_scores(None, answered, ASSETS, "platform-user")
    assert list(found.items) == HALL + CULTURE
    assert found.questionnaire is not None
    assert [module.id for module in found.questionnaire.modules] == ["hall", "culture"]
    assert np.isnan(found.scores[:, len(HALL) :]).sum() == 5 * len(CULTURE)
    assert "6 items were not asked in all 10 answers, in 5 at least" in found.beside
    _, mounted = place(answered, None)
    file = tmp_path / "answers.csv"
    file.write_bytes(exported("csv", USER, mounted.store.rows(USER)))
    mounted.close()
    again = read_scores(file, USER)
    assert again.items == found.items
    np.testing.assert_array_equal(again.scores, found.scores)


def noted(capsys, *words: str) -> dict[str, list[str]]:
    """The items of each note on what was asked, as the command's JSON tells them."""
    options = ["--questionnaire", "platform-user", "--parallel", "0", "--bootstrap", "0", "--json"]
    assert main(["analyse", *words, *options]) == 0
    notes = json.loads(capsys.readouterr().out)["warnings"]
    return {note["code"]: note["items"] for note in notes if note["code"].endswith("_asked")}


def test_an_analysis_names_what_was_not_asked_in_a_table_from_anywhere(tmp_path, capsys):
    rng = np.random.default_rng(5)
    points = rng.integers(1, 6, (40, len(HALL + CULTURE))).astype(str)
    file = tmp_path / "foreign.csv"

    def write(columns: list[str]) -> str:
        lines = [columns, *points[:, : len(columns)].tolist()]
        file.write_text("\n".join(",".join(line) for line in lines), "utf-8")
        return str(file)

    rest = [item for item in USER.item_ids if item not in HALL + CULTURE]
    assert noted(capsys, write(HALL + CULTURE)) == {"not_asked": rest}
    assert noted(capsys, write(HALL)) == {"not_asked": CULTURE + rest}
    points[:10, len(HALL) :] = "."
    assert noted(capsys, write(HALL + CULTURE)) == {"not_asked": rest, "partly_asked": CULTURE}


def test_an_analysis_of_stored_answers_names_the_same(tmp_path, capsys):
    rng = np.random.default_rng(6)
    for offers, items in ((NOWHERE, HALL), (frozenset({"culture"}), HALL + CULTURE)):
        client, mounted = place(tmp_path, offers)
        with client:
            for _ in range(20):
                body = given([], scores={item: int(rng.integers(1, 6)) for item in items})
                assert client.post(f"{URL}/submissions", json=body).status_code == 201
        mounted.close()
    rest = [item for item in USER.item_ids if item not in HALL + CULTURE]
    stored = ("--data", str(tmp_path), "--content", str(ASSETS))
    assert noted(capsys, *stored) == {"not_asked": rest, "partly_asked": CULTURE}


def test_the_thanks_lead_back_to_where_the_visitor_came_from(tmp_path):
    client, mounted = place(
        tmp_path, None, ways=Ways(home=lambda language, exhibit: f"/?lang={language}&exhibit={exhibit}")
    )
    with client:
        page = client.get("/questionnaires/garment?lang=en&exhibit=pibo").text
        assert '<a id="home" class="primary" href="/?lang=en&amp;exhibit=pibo">Back to the hall</a>' in page
    mounted.close()
    client, mounted = place(tmp_path, None)
    with client:
        assert 'id="home"' not in client.get("/questionnaires/garment?lang=en").text
    mounted.close()


@pytest.mark.parametrize("words", ["kitchen", "culture,kitchen", ""])
def test_an_unknown_offer_is_refused_by_name(words, capsys):
    with pytest.raises(SystemExit) as ended:
        main(["serve", "--offers", words])
    assert ended.value.code == 2
    assert "culture" in capsys.readouterr().err
