"""The report: self-contained, both languages, every figure from the analysis."""

from __future__ import annotations

import csv
import io
import json
import re
import shutil
import subprocess
import tomllib
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from full_matrix import by_day
from survey_samples import ASSETS

import survey.report
from survey.analysis import Context, Settings, analyse, varimax
from survey.analysis.procedure import profile
from survey.cli import main
from survey.questionnaire import read_questionnaire
from survey.report import Part, Words, build, coefficient, write_report
from survey.report.tables import Table, as_csv, matrix_csv, paper_rows
from survey.scores import ScoreTable

STATIC = ("static_overall", "static_drape")
GARMENT = read_questionnaire(ASSETS / "questionnaires" / "garment.toml")
USER = read_questionnaire(ASSETS / "questionnaires" / "platform-user.toml")
ADMIN = read_questionnaire(ASSETS / "questionnaires" / "platform-admin.toml")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    made = tmp_path_factory.mktemp("report")
    arguments = [
        "analyse",
        "--demo",
        "likert-20",
        "--drop",
        "static",
        "--report",
        str(made),
        "--bootstrap",
        "200",
    ]
    assert main([*arguments, "--content", str(ASSETS), "--json"]) == 0
    return made


def platform(questionnaire, n, seed):
    z = np.random.default_rng(seed).normal(size=(n, len(questionnaire.items)))
    scores = np.clip(np.rint(4 + z), 1, 5)
    scores[0, 3] = np.nan
    written = (("culture", "<script>alert(1)</script>"),)
    return ScoreTable(scores, questionnaire.item_ids, questionnaire=questionnaire, suggestions=written)


def test_the_page_needs_nothing_from_outside_and_calls_itself_synthetic(folder):
    page = (folder / "report.html").read_text("utf-8")
    links = re.findall(r'(?:src|href)="([^"]*)"', page)
    assert all(link.startswith(("data:", "#")) for link in links), [
        x for x in links if not x.startswith("data:")
    ][:3]
    assert not re.search(r"url\((?!#)", page)
    assert "合成数据" in page
    assert "Synthetic data" in page
    ids = re.findall(r'\bid="([^"]*)"', page)
    assert len(ids) == len(set(ids))


def test_every_figure_is_svg_and_every_table_csv_in_both_languages(folder):
    for language in ("en", "zh"):
        drawn = {path.name.split(".")[0] for path in (folder / "figures").glob(f"*.{language}.svg")}
        assert drawn == {"correlation", "scatter", "scree", "loadings", "way"}
        for path in (folder / "figures").glob(f"*.{language}.svg"):
            assert ElementTree.parse(path).getroot().tag.endswith("svg")
        tables = {path.name.split(".")[0] for path in (folder / "tables").glob(f"*.{language}.csv")}
        assert tables >= {
            "items",
            "pairs",
            "kmo",
            "correlation",
            "probability",
            "retention",
            "variance",
            "loadings",
            "alpha",
            "scales",
            "scale-items",
            "way",
            "way-pairs",
            "notes",
            "paper",
        }


def test_the_tables_hold_the_analysis_s_figures(folder):
    told = json.loads((folder / "analysis.json").read_text("utf-8"))
    table = list(
        csv.reader(io.StringIO((folder / "tables/variance.en.csv").read_text("utf-8-sig"), newline=""))
    )
    assert [float(row[1]) for row in table[1:]] == pytest.approx(told["eigenvalues"], abs=5e-4)
    assert float(table[3][3]) == float(table[3][6])  # rotation keeps the total
    table = list(
        csv.reader(io.StringIO((folder / "tables/loadings.en.csv").read_text("utf-8-sig"), newline=""))
    )
    assert float(table[1][1]) == pytest.approx(told["loadings"]["values"][0][0], abs=5e-4)
    assert table[0][1:10:3] == ["1 The fabric", "2 Cut and form", "3 In motion"]
    assert table[0][2:4] == ["1 The fabric: low", "1 The fabric: high"]
    for name, key in (("correlation", "correlation"), ("probability", "p")):
        table = list(
            csv.reader(io.StringIO((folder / f"tables/{name}.en.csv").read_text("utf-8-sig"), newline=""))
        )
        assert [[float(cell) for cell in row[1:]] for row in table[1:]] == told[key]["values"]


def test_the_page_beside_the_paper_computes_its_column():
    found = {row.quantity[1]: row for row in paper_rows(None)}
    assert found["Cumulative % of variance"].computed == "85.33"
    assert found["Degrees of freedom of Bartlett's test"].computed == "45"
    assert found["Bartlett's χ²"].computed.startswith("168.65")
    assert found["Rotated sums of squares"].computed == "3.599 / 3.037 / 1.897"
    assert found["Sum of the eigenvalues"].printed == "11.108"
    assert found["Least of the main loadings"].computed == "0.764"
    assert found["Means of III.C at n = 20"].computed.startswith("GRIM: 9")
    assert "3.648 / 2.819 / 2.333" in found["Rotated sums of squares"].verdict[1]
    assert all(row.yours == "–" for row in found.values())


def test_both_languages_have_the_same_words():
    texts = tomllib.loads((Path(survey.report.__file__).parent / "texts.toml").read_text("utf-8"))
    assert set(texts["zh"]) == set(texts["en"])
    for key, text in texts["zh"].items():
        assert set(re.findall(r"{(\w+)}", text)) == set(re.findall(r"{(\w+)}", texts["en"][key])), key


@pytest.mark.nightly
def test_a_platform_report_draws_both_roles_and_escapes_what_visitors_wrote():
    table = platform(USER, 60, 1)
    report = build(table, analyse(table.scores, table.items), [Part(platform(ADMIN, 30, 2), ADMIN)])
    assert {"platform-platform-user.en.svg", "platform-platform-admin.zh.svg"} <= set(report.drawings)
    assert "&lt;script&gt;alert(1)" in report.html
    assert "<script>alert" not in report.html
    assert "platform-platform-admin.en.csv" in report.tables


def test_module_and_dimension_means_have_student_s_interval():
    scores = platform(USER, 20, 3).scores
    seen = profile(scores, len(USER.modules), 6)
    column = scores[:, 6 * 2 + 1]
    assert seen.mean[2, 1] == pytest.approx(column.mean())
    assert seen.half[2, 1] == pytest.approx(2.0930240544 * column.std(ddof=1) / np.sqrt(20))
    assert seen.n[0, 3] == 19
    alone = profile(np.array([[3.0, np.nan]]), 1, 2)
    assert np.isnan(alone.half).all()
    assert np.isnan(alone.mean[0, 1])


@pytest.mark.parametrize(
    "case",
    by_day(
        ["few rows", "oblimin"],
        ["few rows", "constant", "twin", "gaps", "no bootstrap", "oblimin", "one component"],
    ),
)
def test_hard_cases_make_a_report_too(case, tmp_path):
    rng = np.random.default_rng(4)
    scores = np.clip(np.rint(3 + rng.normal(size=(40, 12)) + rng.normal(size=(40, 1))), 1, 5)
    settings = Settings(bootstrap=50)
    if case == "few rows":
        scores = scores[:8]
    elif case == "constant":
        scores[:, 3] = 4
    elif case == "twin":
        scores[:, 3] = scores[:, 4]
    elif case == "gaps":
        scores[rng.random(scores.shape) < 0.05] = np.nan
        settings = Settings(bootstrap=50, missing="pairwise")
    elif case == "no bootstrap":
        settings = Settings(draws=0)
    elif case == "oblimin":
        settings = Settings(rotation="oblimin", bootstrap=50)
    else:
        settings = Settings(factors=1, bootstrap=50, rotation="none")
    table = ScoreTable(scores, GARMENT.item_ids, questionnaire=GARMENT)
    page = write_report(tmp_path, table, analyse(scores, GARMENT.item_ids, settings=settings))
    text = page.read_text("utf-8")
    assert "nan" not in re.sub(r"data:text/csv;base64,[^\"]*", "", text).lower().replace("finance", "")


def test_a_folder_that_cannot_be_written_is_one_line(tmp_path, capsys):
    (tmp_path / "file").write_text("")
    arguments = ["analyse", "--demo", "exact-20", "--report", str(tmp_path / "file"), "--bootstrap", "0"]
    assert main([*arguments, "--content", str(ASSETS)]) == 1
    assert "cannot be written" in capsys.readouterr().err


@pytest.fixture
def formulas(tmp_path):
    """A report of foreign columns of which three are formulas to a spreadsheet; yields (folder, names)."""
    names = ("=1+1", "+A1", "@SUM(A1)", "plain", "it's")
    scores = np.random.default_rng(2).integers(1, 6, (30, 5)).astype(float)
    write_report(tmp_path, ScoreTable(scores, names), analyse(scores, names, settings=Settings(draws=0)))
    return tmp_path, names


def test_no_column_s_name_of_the_scores_is_a_formula(formulas):
    folder, names = formulas
    for path in (folder / "scores.csv", *folder.glob("tables/*.csv")):
        for row in csv.reader(path.read_text("utf-8-sig").splitlines()):
            assert not [cell for cell in row if cell.lstrip().startswith(("=", "+", "@"))]
    header, first = [*csv.reader((folder / "scores.csv").read_text("utf-8-sig").splitlines())][:2]
    assert header == ["'=1+1", "'+A1", "'@SUM(A1)", "plain", "it's"]
    assert set(first) <= set("12345")


@pytest.mark.skipif(shutil.which("Rscript") is None, reason="R is not installed")
@pytest.mark.parametrize("own", [False, True], ids=["our scores.csv", "the foreign file itself"])
def test_r_finds_the_columns_whose_names_are_guarded(formulas, own):
    folder, names = formulas
    if own:
        lines = (folder / "scores.csv").read_text("utf-8-sig").splitlines()
        (folder / "scores.csv").write_text("\n".join([",".join(names), *lines[1:]]) + "\n", "utf-8")
    reading = (folder / "analysis.R").read_text("utf-8").partition("# Means")[0]
    lines = [line for line in reading.splitlines() if "library(" not in line]
    script = "\n".join([*lines, r'cat(colnames(scores), sum(scores), sep = "\n")'])
    (folder / "part.R").write_text(script, "utf-8")
    done = subprocess.run(["Rscript", "part.R"], cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    *found, total = done.stdout.splitlines()
    assert tuple(found) == names
    table = [*csv.reader((folder / "scores.csv").read_text("utf-8-sig").splitlines())]
    assert int(total) == sum(int(cell) for row in table[1:] for cell in row)


def test_an_item_without_communality_stays_where_it_is():
    # The guard against dividing by a communality of zero: without it the row, and then all, would be NaN.
    start = np.array([[0.8, 0.3], [0.7, -0.4], [0.0, 0.0], [0.2, 0.9], [0.1, 0.6]])
    turned = varimax(start)
    assert np.isfinite(turned).all()
    assert (turned[2] == 0).all()
    assert np.abs(turned @ turned.T - start @ start.T).max() < 1e-12


def test_the_form_s_settings_cannot_end_their_script_element():
    from survey.web.form import form_page

    title = GARMENT.title.model_copy(update={"zh": "</script><b>x"})
    page = form_page(GARMENT.model_copy(update={"title": title}), "zh", "</script><img src=x>")
    settings = page[page.index('id="settings">') + len('id="settings">') :]
    settings = settings[: settings.index("</script>")]
    # The element ends where its JSON does, not inside the exhibit's name.
    assert json.loads(settings)["exhibit"] == "</script><img src=x>"
    assert "<" not in settings


def test_every_note_of_the_analysis_can_be_said_in_chinese():
    texts = tomllib.loads((Path(survey.report.__file__).parent / "texts.toml").read_text("utf-8"))["notes"]
    folder = Path(survey.report.__file__).parents[1] / "analysis"
    code = "".join(path.read_text("utf-8") for path in folder.glob("*.py"))
    made = set(re.findall(r'Note\(\s*"(\w+)"', code)) | set(re.findall(r'^    code = "(\w+)"', code, re.M))
    assert len(made) > 18
    assert made - set(texts) == set()


def test_the_chinese_report_says_its_notes_in_chinese():
    rng = np.random.default_rng(4)
    scores = np.clip(np.rint(3 + rng.normal(size=(40, 12)) + rng.normal(size=(40, 1))), 1, 5)
    scores[:, 3] = scores[:, 4]
    scores[2] = 5
    scores[7] = scores[9]
    scores[rng.random(scores.shape) < 0.02] = np.nan
    scores[11, 0], scores[12, 1] = 55, 9
    for settings in (
        Settings(bootstrap=50),
        Settings(bootstrap=50, missing="pairwise"),
        Settings(drop=(GARMENT.item_ids[3],), draws=0),
    ):
        found = analyse(scores, GARMENT.item_ids, settings=settings, context=Context(points=GARMENT.points))
        assert [note.form for note in found.notes if note.code == "off_scale"] == ["", "unseen"]
        say = Words("zh", GARMENT)
        for note in found.notes:
            told = say.note(note)
            assert "{" not in told
            if note.told is not None:
                # Names of methods and figures alone are Latin; no sentence of the English is left over.
                assert note.message not in told
                assert re.search("[\u4e00-\u9fff]", told)
            assert Words("en", GARMENT).note(note) == note.message


def test_coefficients_are_printed_as_journals_print_them():
    printed = [coefficient(x) for x in (0.944, -0.0321, 1.0, -1.03, 0.0, None, float("nan"))]
    assert printed == [".944", "−.032", "1.000", "−1.030", ".000", "–", "–"]


@pytest.mark.nightly
def test_many_components_keep_their_table_within_the_page():
    table = platform(USER, 60, 1)
    report = build(table, analyse(table.scores, table.items, settings=Settings(factors=8, bootstrap=40)))
    head, first = report.tables["loadings.en.csv"].removeprefix("\ufeff").splitlines()[:2]
    assert head == "Item,1,2,3,4,5,6,7,8,Communality"
    assert "[" not in first


def test_a_table_s_figures_are_numbers_to_a_spreadsheet_and_its_texts_run_nothing():
    table = Table("x", "", ("a", "b"), (("−.032", "=1+1"), (".944", "−x")))
    assert as_csv(table).splitlines()[1:] == ["-.032,'=1+1", ".944,−x"]


def test_an_interval_has_columns_of_its_own_and_equal_titles_their_group_s_name():
    body = (("x", ".944 [−.13, .97]", "2.75 – 4.10", "4.46 ± 0.31"), ("y", "–.5", "–", "1.00 ± –"))
    table = Table("x", "", ("item", "F1", "95 %", "tone"), body[:1], groups=(("", 1), ("G", 1), ("", 2)))
    assert as_csv(table, ("low", "high")).removeprefix("\ufeff").splitlines() == [
        "item,G: F1,G: F1: low,G: F1: high,95 %: low,95 %: high,tone,tone: ±",
        "x,.944,-.13,.97,2.75,4.10,4.46,0.31",
    ]
    mixed = Table("x", "", ("item", "F1", "95 %", "tone"), body)
    assert as_csv(mixed).splitlines()[2] == "y,–.5,,1.00,"


def test_the_correlations_come_back_from_their_table_to_the_last_digit():
    scores = np.random.default_rng(0).normal(size=(30, 4))
    analysis = analyse(scores, ("a", "b", "c", "d"), settings=Settings(bootstrap=0, draws=0))
    assert analysis.correlation is not None
    text = matrix_csv(analysis.correlation.r, analysis.items).removeprefix("\ufeff")
    read = list(csv.reader(io.StringIO(text)))
    assert tuple(read[0][1:]) == analysis.items
    assert np.array_equal(np.array([row[1:] for row in read[1:]], float), analysis.correlation.r)
    assert matrix_csv(np.array([[1.0, np.nan], [np.nan, 1.0]]), "ab").splitlines()[1:] == ["a,1.0,", "b,,1.0"]
