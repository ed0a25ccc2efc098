"""Questionnaire files: the shipped ones, and every way in which one can be wrong."""

from __future__ import annotations

import os
import shutil

import pytest
from fastapi import FastAPI
from fastapi.testclient import TestClient
from survey_samples import ASSETS, given, submission

import survey
from survey import QuestionnaireError, content_folder, read_questionnaire
from survey.cli import main

SMALL = """
id = "small"
version = 1
title = { zh = "小问卷", en = "Small" }
intro = { zh = "请填写", en = "Please fill in" }
consent = { zh = "同意", en = "I agree" }
[scale]
anchors = [{ zh = "差", en = "bad" }, { zh = "中", en = "middling" }, { zh = "好", en = "good" }]
[[module]]
id = "first"
title = { zh = "其一", en = "First" }
[[module.item]]
id = "one"
label = { zh = "一", en = "One" }
"""


@pytest.fixture
def content(tmp_path, monkeypatch):
    monkeypatch.setattr("survey.web.mounting.PATIENCE", 0.0)  # edits show at once
    shutil.copytree(ASSETS / "questionnaires", tmp_path / "content" / "questionnaires")
    return tmp_path / "content"


def write(content, text, name="small.toml"):
    path = content / "questionnaires" / name
    path.write_text(text, "utf-8")
    # A file system may keep times too coarsely for two edits of one size within a test.
    write.tick += 1
    os.utime(path, ns=(write.tick * 10**9,) * 2)
    return path


write.tick = 1_000_000_000


def test_the_shipped_questionnaires_ask_what_the_paper_asks(hall):
    shipped = hall.mounted.questionnaires
    assert list(shipped) == ["garment", "platform-admin", "platform-user"]
    assert not hall.mounted.problems
    assert len(shipped["garment"].items) == 12
    assert shipped["garment"].tagged("static") == ("static_drape", "static_overall")
    for key in ("platform-user", "platform-admin"):
        papers = [
            module for module in shipped[key].modules if module.needs
        ]  # the hall's own question stands beside
        assert len(papers) == 4
        assert sum(len(shipped[key].items_of(module)) for module in papers) == 24
        assert len({item.dimension for item in shipped[key].items}) == 6
    anchors = [anchor.en for anchor in shipped["platform-user"].scale.anchors]
    assert anchors[0] == "Very unreasonable"
    assert anchors[-1] == "Reasonable"  # not "very": the paper's scale is asymmetric


WRONG = {
    "not TOML": ("id = ", "is not TOML"),
    "unknown key": (SMALL + 'colour = "red"\n', "module.0.item.0.colour: unknown key – remove it"),
    "missing key": (
        SMALL.replace('intro = { zh = "请填写", en = "Please fill in" }\n', ""),
        "intro: missing",
    ),
    "one language": (SMALL.replace(', en = "Small"', ""), "title.en: missing"),
    "empty text": (SMALL.replace('"Small"', '" "'), "title.en: string should have at least 1"),
    "version 0": (SMALL.replace("version = 1", "version = 0"), "version: input should be greater"),
    "version text": (
        SMALL.replace("version = 1", 'version = "1"'),
        "version: input should be a valid integer",
    ),
    "two points": (
        SMALL.replace('{ zh = "差", en = "bad" }, ', ""),
        "scale.anchors: list should have at least 3",
    ),
    "other name": (SMALL.replace('id = "small"', 'id = "other"'), "id: 'other' is not the file's name"),
    "empty item key": (SMALL.replace('"one"', '""'), "module.0.item.0.id"),
    "item key with a space": (SMALL.replace('"one"', '"o ne"'), "module.0.item.0.id"),
    "item twice": (SMALL + SMALL[SMALL.index("[[module.item]]") :], "item id 'one' stands twice"),
    "no items": (SMALL[: SMALL.index("[[module.item]]")], "module 'first' has no items"),
    "column taken": (SMALL.replace('"one"', '"received"'), "item id 'received' is a column of the export"),
    "both kinds": (
        SMALL + '[[dimension]]\nid = "tone"\nlabel = { zh = "色", en = "Tone" }\n',
        "either [[dimension]] or [[module.item]]",
    ),
}


@pytest.mark.parametrize("case", WRONG)
def test_a_broken_file_is_an_error_of_one_line_naming_file_and_key(content, tmp_path, case):
    text, says = WRONG[case]
    path = write(content, text)
    with pytest.raises(QuestionnaireError) as caught:
        read_questionnaire(path)
    message = str(caught.value)
    assert message.startswith("questionnaires/small.toml: ")
    assert says in message
    assert " – " in message
    assert "\n" not in message
    with pytest.raises(QuestionnaireError):
        survey.mount(FastAPI(), content=content, data=tmp_path / "data")


def test_a_file_that_is_not_utf_8_is_named(content):
    path = content / "questionnaires" / "small.toml"
    path.write_bytes(SMALL.encode("gb18030"))
    with pytest.raises(QuestionnaireError, match="is not UTF-8"):
        read_questionnaire(path)


def test_with_a_list_for_problems_the_good_ones_are_served(content, tmp_path):
    write(content, WRONG["unknown key"][0])
    app, problems = FastAPI(), []
    mounted = survey.mount(app, content=content, data=tmp_path / "data", problems=problems)
    with TestClient(app) as client:
        assert client.get("/api/v1/questionnaires/garment").status_code == 200
        assert client.get("/api/v1/questionnaires/small").status_code == 404
    assert [problem.file for problem in problems] == ["questionnaires/small.toml"]
    assert problems[0].as_json()["key"] == "module.0.item.0.colour"
    mounted.close()


def test_a_look_at_the_folder_is_good_for_as_long_as_patience_says(content, monkeypatch):
    now = [100.0]
    monkeypatch.setattr("time.monotonic", lambda: now[0])
    write(content, SMALL)
    folder = survey.QuestionnaireFolder(content, patience=0.2)
    write(content, SMALL.replace('"Small"', '"Smaller"'))
    assert folder["small"].title.en == "Small"
    now[0] += 0.25
    assert folder["small"].title.en == "Smaller"
    write(content, SMALL.replace("version = 1", "version = -1"))
    assert folder.problems  # whoever asks what is wrong now is told of now


def test_an_edit_shows_without_a_restart_and_a_bad_one_keeps_the_last_good(content, tmp_path):
    app = FastAPI()
    write(content, SMALL)
    mounted = survey.mount(app, content=content, data=tmp_path / "data")
    with TestClient(app) as client:
        url = "/api/v1/questionnaires/small"
        write(content, SMALL.replace('"Small"', '"Smaller"'))
        assert client.get(url).json()["title"]["en"] == "Smaller"
        write(content, SMALL.replace("version = 1", "version = -1"))
        assert client.get(url).json()["title"]["en"] == "Smaller"
        assert [problem.key for problem in mounted.problems] == ["version"]
        (content / "questionnaires" / "small.toml").unlink()
        assert client.get(url).status_code == 404
        assert not mounted.problems
    mounted.close()


def test_a_version_is_frozen_with_its_first_answer(content, tmp_path):
    app = FastAPI()
    write(content, SMALL)
    mounted = survey.mount(app, content=content, data=tmp_path / "data")
    with TestClient(app) as client:
        url = "/api/v1/questionnaires/small/submissions"
        write(content, SMALL.replace('"One"', '"Still free"'))
        assert not mounted.problems
        body = submission(mounted.questionnaires["small"], score=3)
        assert client.post(url, json=body).status_code == 201
        write(content, SMALL.replace('"One"', '"Too late"'))
        assert "was changed after its first answer" in mounted.problems[0].what
        asked = client.get("/api/v1/questionnaires/small").json()
        assert asked["modules"][0]["items"][0]["label"]["en"] == "Still free"
        assert "Still free" in client.get("/questionnaires/small?lang=en").text
        assert client.post(url, json=submission(mounted.store.frozen("small", 1), score=3)).status_code == 201
        write(content, SMALL.replace('"One"', '"Too late"').replace("version = 1", "version = 2"))
        assert not mounted.problems
        assert client.post(url, json=submission(mounted.questionnaires["small"], score=3)).status_code == 201
        assert given(mounted.store.frozen("small", 1)).items[0].label.en == "Still free"
        assert given(mounted.store.frozen("small", 2)).items[0].label.en == "Too late"
        assert mounted.store.count("small", 1) == 2
    mounted.close()


@pytest.mark.nightly
def test_an_edited_version_stays_readable_as_it_was_asked(content, tmp_path):
    app = FastAPI()
    write(content, SMALL)
    mounted = survey.mount(app, content=content, data=tmp_path / "data")
    token = {"Authorization": f"Bearer {mounted.store.tokens.make('')}"}
    with TestClient(app) as client:
        base = "/api/v1/questionnaires/small"
        for _ in range(10):
            body = submission(mounted.questionnaires["small"], score=3)
            assert client.post(f"{base}/submissions", json=body).status_code == 201
        write(content, SMALL.replace('id = "one"', 'id = "other"'))
        assert client.get(f"{base}/results").json()["items"][0]["id"] == "one"
        assert client.get(f"{base}/rows", headers=token).json()[0]["scores"] == {"one": 3}
        assert ",one" in client.get(f"{base}/export/csv", headers=token).text
    mounted.close()
    places = ["--content", str(content), "--data", str(tmp_path / "data")]
    assert main(["export", "--questionnaire", "small", "--out", str(tmp_path / "a.csv"), *places]) == 0
    assert ",one" in (tmp_path / "a.csv").read_text("utf-8")


@pytest.mark.parametrize("text", [f"a = {'9' * 5000}", "a = " + "[" * 5000 + "]" * 5000])
def test_what_the_reader_cannot_hold_is_named_and_stays_named(content, text):
    write(content, text)
    folder = survey.QuestionnaireFolder(content)
    for _ in range(2):
        assert "small.toml" in str(folder.problems[0])
    assert "garment" in folder


def test_the_content_folder_is_given_or_here_or_the_packaged_one(tmp_path, monkeypatch):
    assert content_folder(ASSETS) == ASSETS
    monkeypatch.chdir(tmp_path)
    assert (content_folder() / "questionnaires" / "garment.toml").is_file()
    (tmp_path / "assets" / "questionnaires").mkdir(parents=True)
    assert content_folder().resolve() == (tmp_path / "assets").resolve()
    with pytest.raises(survey.SurveyError, match="no such content folder"):
        content_folder(tmp_path / "absent")
