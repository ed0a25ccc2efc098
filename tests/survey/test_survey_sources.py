"""One way of reading a source: analyse, confirm and compare take the same scores under the same options."""

from __future__ import annotations

import json
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest
from survey_samples import ASSETS, submission

from survey import Answer, Store
from survey.cli import main
from survey.questionnaire import read_questionnaire

N = 60


def told(capsys, *arguments) -> dict:
    assert main([*map(str, arguments), "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def noted(found: dict, code: str) -> list[list[str]]:
    return [note["items"] for note in found["warnings"] if note["code"] == code]


@pytest.fixture
def rows(tmp_path) -> Path:
    """Six items of one factor, of which two are worded the other way round; an age, and two groups that differ."""
    rng = np.random.default_rng(5)
    group = np.repeat([0, 1], N)
    common = rng.normal(size=2 * N) + 1.2 * group
    scores = np.clip(np.rint(2.6 + 0.9 * common[:, None] + 0.6 * rng.normal(size=(2 * N, 6))), 1, 6)
    scores[:, 4:] = 7 - scores[:, 4:]
    lines = ["cloth,age,a,b,c,d,e,f"]
    for at, line in enumerate(scores):
        lines.append(f"{'silk' if group[at] else 'ramie'},{20 + at % 40},{','.join(f'{x:g}' for x in line)}")
    file = tmp_path / "answers.csv"
    file.write_text("\n".join(lines), "utf-8")
    return file


ASK = {
    "analyse": ("--bootstrap", 0),
    "confirm": ("--model", "F =~ a + b + c + d + e + f"),
    "compare": ("--by", "cloth"),
}


@pytest.mark.parametrize("command", ASK)
def test_every_command_turns_the_same_items_on_the_same_scale(rows, capsys, command):
    found = told(capsys, command, rows, *ASK[command], "--reverse", "e,f", "--points", 6)
    (note,) = [note for note in found["warnings"] if note["code"] == "reversed"]
    assert note["items"] == ["e", "f"]
    assert "7 − score" in note["message"]
    assert main([command, str(rows), *map(str, ASK[command]), "--reverse", "z"]) == 1
    assert "z: no such item to reverse" in capsys.readouterr().err


def test_turned_items_load_and_differ_like_the_others(rows, capsys):
    for turned, sign in ((("--reverse", "e,f", "--points", 6), 1.0), ((), -1.0)):
        loadings = told(capsys, "confirm", rows, *ASK["confirm"], *turned)["loadings"]["values"]
        assert [np.sign(value) for (value,) in loadings] == [1.0] * 4 + [sign] * 2
        items = told(capsys, "compare", rows, "--by", "cloth", "--groups", "silk,ramie", *turned)["items"]
        assert [np.sign(one["hedges_g"]["value"]) for one in items] == [1.0] * 4 + [sign] * 2


def test_the_factors_that_are_explored_are_those_of_the_turned_scores(rows, capsys):
    found = told(capsys, "confirm", rows, "--model", "explored", "--reverse", "e,f")
    assert np.array(found["loadings"]["values"]).min() > 0.4


@pytest.mark.parametrize("command", ["analyse", "compare"])
def test_every_command_takes_the_same_columns_for_items(rows, capsys, command):
    def items(*more) -> list[str]:
        found = told(capsys, command, rows, *ASK[command], *more)
        return found["items"] if command == "analyse" else [one["item"] for one in found["items"]]

    found = told(capsys, command, rows, *ASK[command])
    assert ["age"] in noted(found, "no_item")
    assert items() == list("abcdef")
    assert items("--keep", "age") == ["age", *"abcdef"]
    assert items("--items", "b,a,c") == ["b", "a", "c"]


def test_the_column_that_tells_groups_apart_is_no_item_that_was_left_out(rows, capsys):
    found = told(capsys, "compare", rows, "--by", "cloth")
    assert not [items for items in noted(found, "no_item") if "cloth" in items]


@pytest.mark.parametrize("command", ASK)
def test_options_of_a_table_need_a_table_of_its_own(rows, capsys, command):
    for more in (("--items", "a"), ("--keep", "age"), ("--points", "6")):
        with pytest.raises(SystemExit) as end:
            main([command, str(rows), "--questionnaire", "garment", *map(str, ASK[command]), *more])
        assert end.value.code == 2
        assert "--items, --keep and --points" in capsys.readouterr().err


@pytest.mark.parametrize("command", ASK)
def test_a_column_named_twice_is_refused(rows, capsys, command):
    for option in ("--items", "--keep"):
        assert main([command, str(rows), *map(str, ASK[command]), option, "a,b,a,c"]) == 1
        said = capsys.readouterr().err
        assert said == f"survey: {rows}: column 'a' is named twice – name it once\n"


@pytest.mark.parametrize("command", ASK)
def test_an_infinite_score_is_named_with_its_file_and_line_in_json_too(rows, capsys, command):
    lines = rows.read_text("utf-8").splitlines()
    lines[7] = lines[7].rpartition(",")[0] + ",inf"
    rows.write_text("\n".join(lines), "utf-8")
    assert main([command, str(rows), *map(str, ASK[command]), "--json"]) == 1
    error = json.loads(capsys.readouterr().out)["error"]
    where = f"{rows}: line 8, f: 'inf' is infinite – correct it"
    assert error == {"code": "not_finite", "items": ["f"], "message": where}


@pytest.mark.parametrize("command", ASK)
def test_every_command_lists_the_samples(capsys, command):
    asked = ASK["compare"] if command == "compare" else ()
    assert main([command, "--demo", *asked]) == 0
    assert "likert-200-gaps" in capsys.readouterr().out


def reversed_platform(folder: Path) -> None:
    """Both platform questionnaires with a dimension that is worded the other way round for users alone."""
    (folder / "questionnaires").mkdir(parents=True)
    for name in ("platform-user", "platform-admin"):
        text = (ASSETS / "questionnaires" / f"{name}.toml").read_text("utf-8")
        if name == "platform-user":
            first, rest = text.split("[[dimension]]\n", 1)
            text = f"{first}[[dimension]]\nreverse = true\n{rest}"
        (folder / "questionnaires" / f"{name}.toml").write_text(text, "utf-8")


def test_roles_are_compared_with_what_each_file_says_is_turned(tmp_path, capsys):
    reversed_platform(tmp_path / "content")
    with closing(Store(tmp_path / "data")) as store:
        for name in ("platform-user", "platform-admin"):
            asked = read_questionnaire(tmp_path / "content" / "questionnaires" / f"{name}.toml")
            for _ in range(12):
                store.submit(asked, Answer.of(asked, submission(asked, score=2)))
    where = ["--content", tmp_path / "content", "--data", tmp_path / "data"]
    command = ["compare", "--questionnaire", "platform-user", "--by", "role", *where]
    means = [one["mean"] for one in told(capsys, *command)["items"]]
    assert means == [[2.0, 4.0]] + [[2.0, 2.0]] * 5  # administrators first, by the alphabet; 4 is 1 + 5 − 2
    means = [one["mean"] for one in told(capsys, *command, "--reverse", "none")["items"]]
    assert means == [[2.0, 2.0]] * 6


@pytest.fixture
def reported(tmp_path, capsys):
    """Makes a report of forty visitors' and forty administrators' answers, compared as asked; its folder."""
    rng, data, out = np.random.default_rng(2), tmp_path / "data", tmp_path / "out"
    with closing(Store(data)) as store:
        for name in ("platform-user", "platform-admin"):
            asked = read_questionnaire(ASSETS / "questionnaires" / f"{name}.toml")
            for at in range(40):
                body = submission(asked, language=("zh", "en")[at % 2])
                body["scores"] = {item: int(rng.integers(1, 6)) for item in body["scores"]}
                store.submit(asked, Answer.of(asked, body))
    command = ["analyse", "--questionnaire", "platform-user", "--data", data, "--content", ASSETS]
    more = ["--bootstrap", 0, "--parallel", 0, "--report", out]

    def report(by: str) -> Path:
        told(capsys, *command, *more, "--compare", by)
        return out

    return report


@pytest.mark.nightly
def test_the_report_calls_roles_and_dimensions_by_their_names(reported):
    out = reported("role")
    tables = {
        lang: (out / "tables" / f"compare-means.{lang}.csv").read_text("utf-8") for lang in ("zh", "en")
    }
    assert "色调" in tables["zh"]
    assert "Colour tone" in tables["en"]
    page = (out / "report.html").read_text("utf-8")
    assert "按角色比较：平台评价（管理员）" in page
    assert "Compared by role: The platform, as an administrator sees it (40 answers)" in page


@pytest.mark.nightly
def test_the_report_calls_languages_by_their_names(reported):
    page = (reported("language") / "report.html").read_text("utf-8")
    assert "按作答语言比较：英文（20 份回答）与 中文" in page
    assert "Compared by language: English (20 answers) with Chinese (20)" in page
