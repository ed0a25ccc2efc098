"""The record of processing: what the page says is so, and what is not known is said not to be."""

from __future__ import annotations

import shutil
import string
import tomllib
from contextlib import closing
from pathlib import Path

import pytest
from fastapi import FastAPI
from fastapi.testclient import TestClient
from survey_samples import ASSETS, submission

import survey
from survey import Answer, Store, read_questionnaire
from survey.cli import main
from survey.web import privacy
from survey.web.form import words
from survey.web.privacy import CONTROLLER_FILE, Controller, Running, read_controller

GARMENT = read_questionnaire(ASSETS / "questionnaires" / "garment.toml")
WHOLE = """\
[controller]
name = { zh = "某某博物馆 <b>", en = "The Museum <b>" }
address = { zh = "某路一号", en = "1 Some Road" }
email = "privacy@museum.example"
[officer]
name = { zh = "林某", en = "Dr Lin" }
email = "officer@museum.example"
[authority]
name = { zh = "监管机构", en = "The Authority" }
[others]
recipients = { zh = "没有", en = "The hosting company" }
transfers = { zh = "没有", en = "There are none" }
"""


@pytest.fixture
def content(tmp_path) -> Path:
    folder = tmp_path / "content"
    shutil.copytree(ASSETS / "questionnaires", folder / "questionnaires")
    return folder


def shown(
    content: Path,
    data: Path,
    language: str = "en",
    base: str = "http://testserver",
    running: Running | None = None,
) -> str:
    app = FastAPI()
    mounted = survey.mount(app, content=content, data=data, problems=[], running=running)
    with closing(mounted), TestClient(app, base_url=base) as client:
        reply = client.get(f"/privacy?lang={language}")
    assert reply.status_code == 200
    assert "default-src 'none'" in reply.headers["content-security-policy"]
    return reply.text


def test_both_languages_have_the_same_texts_with_the_same_gaps():
    texts = tomllib.loads(Path(privacy.__file__).with_name("texts.toml").read_text("utf-8"))
    assert set(texts["zh"]) == set(texts["en"])
    for key, text in texts["zh"].items():
        gaps = [
            {name for _, name, _, _ in string.Formatter().parse(one) if name}
            for one in (text, texts["en"][key])
        ]
        assert gaps[0] == gaps[1], key


@pytest.mark.parametrize("language", ["zh", "en"])
def test_what_is_missing_is_said_to_be_missing(content, tmp_path, language):
    text = shown(content, tmp_path / "data", language)
    assert CONTROLLER_FILE in text
    assert ("This record is not complete" if language == "en" else "本记录尚不完整") in text
    assert text.count("not stated yet" if language == "en" else "尚未说明") == 4
    (content / CONTROLLER_FILE).write_text(
        '[controller]\nname = { zh = "某馆", en = "The Museum" }\n', "utf-8"
    )
    text = shown(content, tmp_path / "data", language)
    for key in set(Controller().missing) - {"controller.name"}:
        assert key in text


@pytest.mark.parametrize(
    ("language", "name"), [("zh", "某某博物馆 &lt;b&gt;"), ("en", "The Museum &lt;b&gt;")]
)
def test_who_answers_for_it_is_named_and_escaped(content, tmp_path, language, name):
    (content / CONTROLLER_FILE).write_text(WHOLE, "utf-8")
    text = shown(content, tmp_path / "data", language)
    assert name in text
    assert "privacy@museum.example" in text
    assert "officer@museum.example" in text
    assert "not stated yet" not in text
    assert "尚未说明" not in text
    assert "notice" not in text


@pytest.mark.parametrize(
    ("running", "told"),
    [
        (Running(per_minute=7), "At most 7 new answers a minute"),
        (Running(per_minute=0), "no limit on answers"),
        (None, "At most 300 new answers a minute"),
        (Running(proxies=()), "No proxy is believed"),
        (Running(proxies=("10.0.0.2", "10.0.0.3")), "believed on where visitors come from: 2"),
        (None, "not known to this page"),
    ],
)
def test_the_settings_are_those_of_the_running_service(content, tmp_path, running, told):
    assert told in shown(content, tmp_path / "data", running=running)


def test_the_store_is_told_of_as_it_is(content, tmp_path):
    data = tmp_path / "data"
    with closing(Store(data)) as store:
        for label in ("Dr Lin", "Dr Wu"):
            store.tokens.make(label)
        answer = Answer.of(GARMENT, submission(GARMENT))
        store.submit(GARMENT, answer)
    file = data / "survey.sqlite"
    file.chmod(0o600)
    text = shown(content, data)
    assert "tokens in use: 2" in text
    assert "Dr Lin" not in text
    assert "Only the account that runs the service" in text
    assert "No answers have been erased by their date" in text
    assert "none are at present" in text
    file.chmod(0o644)  # as an earlier release left it
    assert "Only the account that runs the service" in shown(content, data)
    assert file.stat().st_mode & 0o777 == 0o600
    with closing(Store(data)) as store:
        store.freeze("garment")
        store.purge("garment", GARMENT.version)
    text = shown(content, data)
    assert "fixed for evaluation in part and can no longer be withdrawn by code: garment" in text
    assert "Answers were last erased by their date on 20" in text


def test_each_version_says_how_long_it_is_kept_also_when_it_has_left_the_hall(content, tmp_path):
    path = content / "questionnaires" / "garment.toml"
    with closing(Store(tmp_path / "data")) as store:
        gone = GARMENT.model_copy(update={"id": "gone", "version": 3})
        store.publish(gone)
    dated = path.read_text("utf-8").replace("version = 2\n", "version = 2\nretain_until = 2031-12-31\n")
    path.write_text(dated, "utf-8")
    text = shown(content, tmp_path / "data")
    assert "2031-12-31" in text
    assert "(gone, version 3)" in text
    assert "no end is set" in text
    assert "with retain_until in the questionnaire&#x27;s file" in text
    path.write_text(dated.replace("2031-12-31", "2021-12-31"), "utf-8")
    assert "2021-12-31: this has passed" in shown(content, tmp_path / "data")


@pytest.mark.parametrize(
    ("base", "told"), [("http://testserver", "(HTTP)"), ("https://testserver", "(HTTPS)")]
)
def test_how_the_page_came_is_told(content, tmp_path, base, told):
    assert told in shown(content, tmp_path / "data", base=base)


@pytest.mark.parametrize("database", ["postgresql"], indirect=True)
@pytest.mark.slow
def test_a_server_is_told_as_one(content, database):
    text = shown(content, database)
    assert "a postgresql server" in text
    assert database not in text


@pytest.mark.parametrize("database", ["sqlite"], indirect=True)
@pytest.mark.parametrize("language", ["zh", "en"])
def test_the_consent_leads_there(hall, language):
    text = hall.client.get(f"/questionnaires/garment?lang={language}").text
    consent = text[text.index('id="consent-box"') :]
    assert f'href="../privacy?lang={language}"' in consent
    assert words(language)["privacy"] in consent
    assert hall.client.get(f"/questionnaires/../privacy?lang={language}").status_code == 200


FAULTS = {
    "no TOML": ("[controller", "cannot be read"),
    "unknown key": ('[controller]\nphone = "1"', "unknown key"),
    "one language": ('[controller]\nname = { zh = "某" }', "missing"),
    "no mail": ('[controller]\nemail = "nobody"', "match"),
}


@pytest.mark.parametrize("case", FAULTS)
def test_a_faulty_file_is_a_problem_and_nothing_of_it_is_shown(content, tmp_path, case):
    text, told = FAULTS[case]
    (content / CONTROLLER_FILE).write_text(text, "utf-8")
    found = read_controller(content)
    assert found.gaps == ()
    assert any(told in problem.what for problem in found.faults)
    assert all(problem.file == CONTROLLER_FILE for problem in found.faults)
    assert all(problem.fix for problem in found.faults)
    assert found.controller == Controller()
    assert mounted_with(content, tmp_path) == (list(found.faults), ())
    page = shown(content, tmp_path / "data")
    assert "This record is not complete" in page
    assert f"There is a fault in {CONTROLLER_FILE}, and nothing of it is told here" in page


def mounted_with(content: Path, tmp_path: Path) -> tuple[list, tuple]:
    """Problems and hints of a survey that is mounted with the folder."""
    problems: list = []
    mounted = survey.mount(FastAPI(), content=content, data=tmp_path / "data", problems=problems)
    mounted.close()
    return problems, mounted.hints


def test_what_is_not_stated_yet_is_a_hint_and_no_problem(content, tmp_path):
    problems, (hint,) = mounted_with(content, tmp_path)
    assert problems == []
    assert str(hint).startswith(f"{CONTROLLER_FILE}: missing")
    (content / CONTROLLER_FILE).write_text('[controller]\nemail = "a@b"\n', "utf-8")
    problems, (hint,) = mounted_with(content, tmp_path)
    assert problems == []
    assert set(hint.key.split(", ")) == set(Controller().missing) - {"controller.email"}
    (content / CONTROLLER_FILE).write_text(WHOLE, "utf-8")
    assert mounted_with(content, tmp_path) == ([], ())


def test_the_file_that_is_shipped_says_nothing_until_it_is_filled_in(content, tmp_path):
    blank = (ASSETS / CONTROLLER_FILE).read_text("utf-8")
    (content / CONTROLLER_FILE).write_text(blank, "utf-8")
    found = read_controller(content)
    assert found.controller == Controller()
    assert found.faults == ()
    assert found.gaps[0].key == ", ".join(Controller().missing)
    assert "not stated yet" in shown(content, tmp_path / "data")
    filled = blank.replace('zh = "", en = ""', 'zh = "某", en = "One"').replace('email = ""', 'email = "a@b"')
    (content / CONTROLLER_FILE).write_text(filled, "utf-8")
    assert read_controller(content).problems == ()
    for one_language in ('zh = "某", en = ""', 'zh = "", en = "One"'):
        (content / CONTROLLER_FILE).write_text(blank.replace('zh = "", en = ""', one_language, 1), "utf-8")
        assert [fault.key.partition(".")[0] for fault in read_controller(content).faults] == ["controller"]


def test_the_command_writes_the_page_and_names_what_is_missing(content, tmp_path, capsys):
    data, out = tmp_path / "data", tmp_path / "privacy.html"
    Store(data).close()
    command = ["privacy", "--content", str(content), "--data", str(data)]
    assert main([*command, "--language", "en", "--out", str(out)]) == 1
    assert f"{CONTROLLER_FILE}: missing" in capsys.readouterr().err
    assert "not known to this page" in out.read_text("utf-8")
    (content / CONTROLLER_FILE).write_text(WHOLE, "utf-8")
    assert main(command) == 0
    said = capsys.readouterr()
    assert said.err == ""
    assert "某某博物馆" in said.out
    assert "survey-static" not in said.out
    assert main(["privacy", "--data", str(tmp_path / "typo"), "--content", str(content)]) == 1
