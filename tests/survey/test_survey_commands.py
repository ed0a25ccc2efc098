"""Freezing, purging and backing up from the command line; the retention date."""

from __future__ import annotations

import importlib
import sqlite3
from contextlib import closing
from datetime import date
from pathlib import Path

import pytest
from survey_samples import ASSETS, submission

from survey import Answer, Store, read_questionnaire
from survey.cli import main
from survey.questionnaire import Questionnaire

GARMENT = read_questionnaire(ASSETS / "questionnaires" / "garment.toml")


def kept_until(day: str | None) -> Questionnaire:
    return Questionnaire.model_validate(GARMENT.document() | ({"retain_until": day} if day else {}))


def filled(folder: Path, asked: Questionnaire = GARMENT, number: int = 3) -> list[Answer]:
    answers = [Answer.of(asked, submission(asked)) for _ in range(number)]
    with closing(Store(folder)) as store:
        for answer in answers:
            store.submit(asked, answer)
    return answers


def test_freeze_fixes_what_stands_and_says_how_many(tmp_path, capsys):
    answers = filled(tmp_path)
    with closing(Store(tmp_path)) as store:
        store.withdraw("garment", answers[0].id)
    assert main(["freeze", "garment", "--data", str(tmp_path)]) == 0
    assert "2 answers fixed" in capsys.readouterr().out
    assert main(["freeze", "shoes", "--data", str(tmp_path)]) == 1
    assert "shoes: no answers in this store" in capsys.readouterr().err


def test_backup_writes_one_file_and_never_over_another(tmp_path, capsys):
    answers = filled(tmp_path)
    copy = tmp_path / "copy.sqlite"
    assert main(["backup", str(copy), "--data", str(tmp_path)]) == 0
    assert "3 submissions" in capsys.readouterr().out
    with closing(sqlite3.connect(copy)) as database:
        found = {key for (key,) in database.execute("SELECT id FROM submission")}
    assert found == {answer.id for answer in answers}
    assert main(["backup", str(copy), "--data", str(tmp_path)]) == 1
    assert "exists already" in capsys.readouterr().err


@pytest.mark.parametrize("command", [["freeze", "garment"], ["purge"], ["backup", "copy.sqlite"]])
def test_no_command_makes_an_empty_store(tmp_path, capsys, command):
    assert main([*command, "--data", str(tmp_path / "typo")]) == 1
    assert "no such store" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(("day", "left"), [("2001-01-01", 0), ("9000-01-01", 3), (None, 3)])
def test_purge_erases_only_what_was_kept_long_enough(tmp_path, capsys, day, left):
    asked = kept_until(day)
    filled(tmp_path, asked)
    assert main(["freeze", "garment", "--data", str(tmp_path)]) == 0
    assert main(["purge", "--yes", "--data", str(tmp_path)]) == 0
    assert ("3 answers erased" in capsys.readouterr().out) == (left == 0)
    with closing(Store(tmp_path)) as store:
        assert len(store.rows(asked)) == left
        again = store.frozen("garment", asked.version)
    assert again is not None
    assert again.retain_until == (date.fromisoformat(day) if day else None)
    assert again.digest == asked.digest


def test_a_version_frozen_by_the_first_release_keeps_its_digest():
    with closing(sqlite3.connect(":memory:")) as database:
        database.executescript((Path(__file__).parent / "first_store.sql").read_text("utf-8"))
        frozen = database.execute("SELECT digest, document FROM version").fetchall()
    assert frozen
    for digest, document in frozen:
        assert Questionnaire.model_validate_json(document).digest == digest


def test_the_readme_shows_what_was_measured(monkeypatch):
    monkeypatch.syspath_prepend(str(Path(__file__).parents[1] / "bench"))
    figures = importlib.import_module("readme_survey")
    assert figures.table() in figures.README.read_text("utf-8")
