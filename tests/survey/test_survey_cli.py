"""The command: what it prints, what it returns, and what it says when something is wrong."""

from __future__ import annotations

import csv
import io
import json
import subprocess
import sys

import numpy as np
import pytest
from fastapi import FastAPI
from fastapi.testclient import TestClient
from survey_samples import ASSETS, paper_sample, submission

import survey
from survey.analysis.procedure import KEYS
from survey.cli import main
from survey.scores import read_scores

HERE = ["--content", str(ASSETS)]


@pytest.fixture
def paper_csv(tmp_path):
    table, names = paper_sample()
    path = tmp_path / "paper.csv"
    with path.open("w", encoding="utf-8-sig", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["submission", *names, "suggestion_fabric"])
        for number, row in enumerate(table):
            writer.writerow([f"id-{number}", *(repr(float(value)) for value in row), "ok"])
    return path


@pytest.mark.parametrize(
    "arguments",
    [
        ["serve", "--port", "99999"],
        ["serve", "--port", "-1"],
        ["token", "--revoke", "99999999999999999999999"],
        ["token", "--label", "a\x1b[2J"],
        ["export", "--questionnaire", "garment", "--version", "0"],
        ["analyse", "a.csv", "--factors", "9" * 5000],
    ],
)
def test_wrong_arguments_end_with_2_and_a_line(arguments, capsys):
    with pytest.raises(SystemExit) as ended:
        main(arguments)
    assert ended.value.code == 2
    assert "Traceback" not in capsys.readouterr().err


@pytest.mark.parametrize(
    "url", ["postgresql://h:abc/x", "sqlite:///a?timeout=abc", "sqlite+aiosqlite:///a", "x"]
)
def test_a_wrong_database_url_is_one_line(url, capsys):
    failing(capsys, "export", "--questionnaire", "garment", "--db", url, *HERE)


def test_reading_makes_no_store(tmp_path, capsys):
    failing(capsys, "export", "--questionnaire", "garment", "--data", tmp_path, *HERE)
    failing(capsys, "analyse", "--questionnaire", "garment", "--db", f"sqlite:///{tmp_path}/typo.db", *HERE)
    failing(capsys, "token", "--list", "--data", tmp_path / "typo")
    failing(capsys, "token", "--revoke", "1", "--data", tmp_path / "typo")
    assert list(tmp_path.iterdir()) == []


def test_a_slip_in_a_column_of_numbers_is_named(tmp_path, capsys):
    path = tmp_path / "a.csv"
    path.write_text("a,b,name\n1,2,Lin\n\n2,x,Wu\n3,4,He\n", "utf-8")
    assert "line 4, b: 'x'" in failing(capsys, "analyse", path)


def failing(capsys, *arguments) -> str:
    assert main(list(map(str, arguments))) == 1
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("survey: ")
    assert err.count("\n") == 1
    return err


def test_analyse_prints_the_paper_s_figures_from_a_file(paper_csv, capsys):
    assert (
        main(["analyse", str(paper_csv), "--questionnaire", "garment", "--drop", "static", *HERE, "--json"])
        == 0
    )
    found = json.loads(capsys.readouterr().out)
    assert found["n"] == 20
    assert sorted(found["dropped"]) == ["static_drape", "static_overall"]
    assert round(found["kmo"], 3) == 0.824
    assert round(found["bartlett"]["chi2"], 2) == 167.23
    assert found["bartlett"]["df"] == 45
    assert round(found["alpha"], 3) == 0.911
    assert round(found["variance"]["rotated"][2]["cumulative"], 2) == 85.33
    assert found["variance"]["initial"][2]["cumulative"] == pytest.approx(
        found["variance"]["rotated"][2]["cumulative"], abs=1e-10
    )
    assert np.shape(found["correlation"]["values"]) == (12, 12)
    assert found["loadings"]["rows"][0] == "fabric_texture"


def test_without_a_questionnaire_every_numeric_column_is_an_item(paper_csv, capsys):
    assert main(["analyse", str(paper_csv), "--drop", "static_overall,static_drape", "--factors", "2"]) == 0
    out = capsys.readouterr().out
    for expected in (
        "20 complete answers, 12 items",
        "KMO 0.824",
        "χ² = 167.23, df = 45",
        "α 0.911",
        ".968**",
    ):
        assert expected in out
    assert "suggestion" not in out


def test_answers_go_from_the_form_s_door_through_export_into_the_analysis(tmp_path, capsys):
    app, data = FastAPI(), tmp_path / "data"
    mounted = survey.mount(app, content=ASSETS, data=data)
    garment = mounted.questionnaires["garment"]
    scores = np.clip(np.rint(3 + np.random.default_rng(1).normal(size=(30, 12))), 1, 5)
    with TestClient(app) as client:
        for row in scores:
            body = submission(garment, scores=dict(zip(garment.item_ids, map(int, row), strict=True)))
            assert client.post("/api/v1/questionnaires/garment/submissions", json=body).status_code == 201
    mounted.close()
    out = tmp_path / "answers.csv"
    assert main(["export", "--questionnaire", "garment", "--data", str(data), "--out", str(out), *HERE]) == 0
    assert "30 answers" in capsys.readouterr().out
    table = list(csv.DictReader(io.StringIO(out.read_text("utf-8-sig"))))
    exported = np.array([[float(row[item]) for item in garment.item_ids] for row in table])
    assert sorted(exported.tolist()) == sorted(scores.tolist())
    url = f"sqlite:///{data / 'survey.sqlite'}"
    results = []
    for source in ([str(out)], ["--data", str(data)], ["--db", url]):
        assert main(["analyse", *source, "--questionnaire", "garment", "--json", *HERE]) == 0
        results.append(json.loads(capsys.readouterr().out))
    assert results[0] == results[1] == results[2]
    pleat = results[0]["bootstrap"]["means"]["pleat"]
    assert pleat["mean"] == pytest.approx(scores[:, garment.item_ids.index("pleat")].mean())
    assert pleat["low"] < pleat["mean"] < pleat["high"]


def test_a_token_opens_the_rows_until_it_is_revoked(tmp_path, capsys):
    data = ["--data", str(tmp_path / "data")]
    assert main(["token", "--label", "Dr Lin", *data]) == 0
    token = capsys.readouterr().out.strip()
    app = FastAPI()
    mounted = survey.mount(app, content=ASSETS, data=tmp_path / "data")
    with TestClient(app) as client:
        url, headers = "/api/v1/questionnaires/garment/rows", {"authorization": f"Bearer {token}"}
        assert client.get(url, headers=headers).status_code == 200
        assert main(["token", "--list", *data]) == 0
        listed = capsys.readouterr().out
        assert "Dr Lin" in listed
        assert token not in listed
        assert main(["token", "--revoke", "1", *data]) == 0
        assert client.get(url, headers=headers).status_code == 401
    mounted.close()
    capsys.readouterr()
    assert "there is none" in failing(capsys, "token", "--revoke", 9, *data)


FAULTY = {
    "no numbers": ("a,b\nx,y\n", "no column of numbers"),
    "endless": ("a,b\n1,2\n2,3\n3,1e999\n", "table.csv: line 4, b: '1e999' is infinite"),
    "header only": ("a,b\n", "no rows"),
    "empty": ("", "no rows"),
    "ragged": ("a,b\n1,2\n3\n", "line 3 has 1 cells, the header 2"),
    "twice": ("a,a\n1,2\n3,4\n", "column 'a' stands twice"),
    "one row": ("a,b\n1,2\n", "1 complete answers"),
    "all equal": ("a,b\n3,3\n3,3\n3,3\n", "the same score in all answers"),
    "infinite": ("a,b\n1,inf\n2,3\n3,1\n", "table.csv: line 2, b: 'inf' is infinite"),
    "absurd": ("a,b\n1,1e308\n2,3\n3,1\n4,4\n", "b: scores beyond"),
    "underscore": ("a,b\n1,4_0\n2,3\n3,1\n4,4\n", "line 2, b: '4_0' is no number"),
    "no utf-8": (b"a,b\n\xff,2\n", "no CSV in UTF-8"),
}


@pytest.mark.parametrize("case", FAULTY)
def test_a_faulty_table_is_one_line_and_exit_1(tmp_path, capsys, case):
    text, says = FAULTY[case]
    path = tmp_path / "table.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    assert says in failing(capsys, "analyse", path)


def test_a_score_that_is_no_number_is_named_by_line_and_item(tmp_path, capsys, paper_csv):
    text = paper_csv.read_text("utf-8-sig").splitlines()
    text[3] = text[3].replace(text[3].split(",")[1], "good")
    (tmp_path / "bad.csv").write_text("\n".join(text), "utf-8")
    said = failing(capsys, "analyse", tmp_path / "bad.csv", "--questionnaire", "garment", *HERE)
    assert "line 4, fabric_texture: 'good' is no number" in said


def test_what_is_not_there_is_named(tmp_path, capsys):
    assert "cannot be read" in failing(capsys, "analyse", tmp_path / "absent.csv")
    absent = ["--data", tmp_path / "absent"]
    assert "no such store" in failing(capsys, "export", "--questionnaire", "garment", *absent, *HERE)
    assert not (tmp_path / "absent").exists()
    assert "choose one of: garment" in failing(capsys, "export", "--questionnaire", "shoes", *absent, *HERE)
    assert "no such content folder" in failing(capsys, "serve", "--content", tmp_path / "absent")
    wrong = ["--questionnaire", "garment", *HERE, "--db"]
    assert "database URL" in failing(capsys, "analyse", *wrong, "nonsense")
    assert "no driver" in failing(capsys, "analyse", *wrong, "cobol://x")
    assert "no such store" in failing(capsys, "analyse", *wrong, f"sqlite:///{tmp_path}/no/where.sqlite")
    (tmp_path / "file").write_text("")
    assert "no data folder" in failing(capsys, "token", "--data", tmp_path / "file")


def test_a_taken_port_is_one_line(tmp_path, capsys):
    import socket

    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        assert main(["serve", "--port", str(port), "--data", str(tmp_path / "data"), *HERE]) == 1
    assert "choose another --port" in capsys.readouterr().err


@pytest.mark.parametrize(
    "arguments",
    [
        [],
        ["fly"],
        ["export"],
        ["analyse"],
        ["analyse", "x.csv", "--factors", "0"],
        ["serve", "--port", "x"],
        ["analyse", "x.csv", "--factors", "parallel", "--parallel", "0"],
    ],
)
def test_wrong_arguments_exit_2(arguments, capsys):
    with pytest.raises(SystemExit) as caught:
        main(arguments)
    assert caught.value.code == 2


@pytest.mark.parametrize("command", [[], ["serve"], ["export"], ["analyse"], ["grim"], ["token"]])
def test_help_teaches(command, capsys):
    with pytest.raises(SystemExit) as caught:
        main([*command, "--help"])
    assert caught.value.code == 0
    assert len(capsys.readouterr().out.splitlines()) > 8


def test_the_public_names_are_there_and_importing_them_lazily_stays_light():
    for name in survey.__all__:
        assert getattr(survey, name).__module__.startswith("survey")
    assert sorted(survey.__all__) == survey.__all__
    heavy = ("fastapi", "sqlalchemy", "pandas", "factor_analyzer", "sklearn")
    code = f"import sys, survey; print([name for name in {heavy} if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


HARD = {
    "duplicate": (
        "a,b,c\n" + "".join(f"{x},{x},{y}\n" for x, y in zip("123451234512", "513243541325", strict=True)),
        None,
    ),
    "constant": (
        "a,b,c,d\n" + "".join(f"{x},3,{y},{z}\n" for x, y, z in zip("12345", "51324", "25143", strict=True)),
        None,
    ),
    "n below p": ("a,b,c,d\n1,2,3,4\n4,3,1,2\n2,2,5,1\n", None),
    "n = p + 1": ("a,b,c\n1,2,4\n4,3,1\n2,2,5\n5,5,2\n", None),
    "missing": ("a,b\n1,2\nNA,3\n4,\n2,5\n5,1\n3,3\n", None),
    "all equal": ("a,b\n3,3\n3,3\n3,3\n", "all_equal"),
    "empty column": ("a,b,c\n1,2,\n2,1,\n4,5,\n", "not_finite"),
    "infinite": ("a,b\n1,inf\n2,3\n3,1\n", "not_finite"),
    "one row": ("a,b\n1,2\n", "too_few_rows"),
}


@pytest.mark.parametrize("case", HARD)
@pytest.mark.parametrize(
    "way", [[], ["--missing", "pairwise"], ["--rotation", "oblimin"]], ids=lambda way: "".join(way)
)
def test_a_hard_case_is_strict_json_with_a_typed_warning_or_error(tmp_path, capsys, case, way):
    text, error = HARD[case]
    path = tmp_path / "hard.csv"
    path.write_text(text, "utf-8")

    def no_constant(name):
        raise AssertionError(f"{name} in JSON")

    status = main(["analyse", str(path), "--json", "--bootstrap", "50", "--parallel", "50", *way])
    out, err = capsys.readouterr()
    found = json.loads(out, parse_constant=no_constant)
    if error is not None:
        assert status == 1
        assert found["error"]["code"] == error
        assert err.startswith("survey: ")
        return
    assert status == 0
    assert tuple(found) == KEYS
    assert found["warnings"]
    assert all(set(warning) == {"code", "items", "message"} for warning in found["warnings"])


def test_demonstrations_are_listed_and_analysed_and_call_for_no_file(capsys):
    assert main(["analyse", "--demo", "list"]) == 0
    assert "likert-20" in capsys.readouterr().out
    assert (
        main(["analyse", "--demo", "likert-20", "--drop", "static", "--json", "--bootstrap", "0", *HERE]) == 0
    )
    assert json.loads(capsys.readouterr().out)["dropped"] == ["static_drape", "static_overall"]
    for wrong in (["--demo", "nothing"], ["x.csv", "--demo", "likert-20"]):
        with pytest.raises(SystemExit) as ended:
            main(["analyse", *wrong])
        assert ended.value.code == 2


def test_grim_tells_the_impossible_means(capsys):
    assert main(["grim", "4.46", "4.15", "--n", "20"]) == 0
    out = capsys.readouterr().out
    assert "4.46  IMPOSSIBLE" in out
    assert "4.15  possible" in out
    assert "smallest n that makes all possible: 13" in out  # 20, which is larger, does not
    assert main(["grim", "4.46", "--n", "20", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["possible"] == {"4.46": False}
    assert "is no mean" in failing(capsys, "grim", "x", "--n", "20")


def test_seconds_in_a_table_flag_haste(tmp_path, capsys):
    rng = np.random.default_rng(1)
    lines = ["seconds," + ",".join(f"q{at}" for at in range(9))]
    lines += [",".join(map(str, [3 if row == 4 else 60, *rng.integers(1, 6, 9)])) for row in range(30)]
    (tmp_path / "a.csv").write_text("\n".join(lines), "utf-8")
    assert main(["analyse", str(tmp_path / "a.csv"), "--json", "--bootstrap", "0"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert "seconds" not in found["items"]
    (note,) = [note for note in found["warnings"] if note["code"] == "too_fast"]
    assert "number 5)" in note["message"]


@pytest.mark.parametrize("gap", ["", "NA", ".", " NA "])
def test_gaps_are_written_as_spreadsheets_r_and_spss_write_them(tmp_path, gap):
    (tmp_path / "a.csv").write_text(f"a,b\n1,2\n{gap},3\n2,4\n", "utf-8")
    table = read_scores(tmp_path / "a.csv")
    assert table.items == ("a", "b")
    assert np.isnan(table.scores).tolist() == [[False, False], [True, False], [False, False]]


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "gb18030"])
@pytest.mark.parametrize("separator", [",", ";", "\t"])
def test_a_table_as_excel_writes_it_anywhere_is_read(tmp_path, encoding, separator):
    rows = [["姓名", "质感,光泽", "垂感"], ["李, 一", "1", "2"], ["吴；二", "3", "4.5"], ["何三", "", "5"]]
    if separator != ",":
        rows[2][2] = "4,5"
    with (tmp_path / "a.csv").open("w", encoding=encoding, newline="") as file:
        csv.writer(file, delimiter=separator).writerows(rows)
    table = read_scores(tmp_path / "a.csv")
    assert table.items == ("质感,光泽", "垂感")
    np.testing.assert_array_equal(table.scores, [[1, 2], [3, 4.5], [np.nan, 5]])


@pytest.mark.nightly
def test_a_reader_who_has_enough_ends_the_command_quietly():
    command = f"{sys.executable} -m survey.cli analyse --demo likert-20 --bootstrap 0 --json | head -c 5"
    done = subprocess.run(["bash", "-c", command], capture_output=True, text=True, cwd=ASSETS.parent)
    assert done.stdout == '{\n "n'
    assert done.stderr == ""
