"""The way from 25 indicators to 12 and to 10: what is recorded, the sample behind it, and where it is shown."""

from __future__ import annotations

import csv
import json
import os
import subprocess
import sys
from contextlib import closing

import numpy as np
import pytest
from survey_samples import ASSETS, likert_sample, submission

from survey import Answer, Store
from survey.analysis import Settings, analyse, correlate
from survey.cli import main
from survey.demonstration import (
    SAMPLES,
    intermediate,
    merged,
    primary,
    primary_opinions,
    primary_sample,
    sample_file,
)
from survey.questionnaire import read_questionnaire
from survey.report import build, evidence, way_of
from survey.scores import ScoreTable, read_scores

GARMENT = read_questionnaire(ASSETS / "questionnaires" / "garment.toml")
STATIC = ("static_drape", "static_overall")
HERE = ["--content", str(ASSETS)]


def cells(path):
    """The rows of a CSV file."""
    return list(csv.reader(path.read_text("utf-8-sig").splitlines()))


def twelve():
    table = read_scores(sample_file("primary-200"))
    return merged(table.scores, table.items, GARMENT.item_ids)


def test_the_25_become_the_twelve_items_of_the_questionnaire_as_the_paper_tells():
    assert len(primary()) == len({one.id for one in primary()}) == 25
    assert set(intermediate()) == set(GARMENT.item_ids)
    sizes = {item: len(parts) for item, parts in intermediate().items()}
    assert {item: size for item, size in sizes.items() if size > 1} == {
        "detail_structure": 4, "fabric_colour": 5, "thickness_texture": 2
    }  # fmt: skip
    gone = [at for at, one in enumerate(primary(), 1) if one.into is None]
    assert gone == [2, 16, 17, 18, 25]
    assert all((one.why is None) == (one.into is not None) for one in primary())


def test_the_file_is_what_the_recipe_makes_also_with_the_oldest_processor_s_linear_algebra(tmp_path):
    table = read_scores(sample_file("primary-200"))
    assert table.items == tuple(one.id for one in primary())
    assert np.array_equal(table.scores, primary_sample())
    assert set(np.unique(table.scores)) == {1, 2, 3, 4, 5}
    assert np.abs(primary_opinions() % 1 - 0.5).min() > 1e-9
    code = (
        "import sys, numpy; from survey.demonstration import primary_opinions;"
        "numpy.save(sys.argv[1], primary_opinions())"
    )
    env = os.environ | {"OPENBLAS_CORETYPE": "Prescott"}
    subprocess.run([sys.executable, "-c", code, tmp_path / "anew.npy"], env=env, check=True)
    np.testing.assert_allclose(np.load(tmp_path / "anew.npy"), primary_opinions(), atol=1e-12)


def test_the_sample_bears_out_the_paper_s_pruning():
    found = analyse(twelve(), GARMENT.item_ids, settings=Settings(drop=STATIC, draws=0))
    pairs = {frozenset(note.items) for note in found.notes if note.code == "close_pair"}
    assert pairs == {
        frozenset(("silhouette", "static_overall")),
        frozenset(("dynamic_drape", "static_drape")),
    }
    assert len(found.factored) == 10
    seen = dict(zip((one.id for one in primary()), evidence(), strict=True))
    for one in primary():
        told = seen[one.id].r
        if one.into is not None and len(intermediate()[one.into]) > 1:
            assert told is not None
            assert told > 0.6, one.id  # merged: says much the same as the others of its group
    assert seen["clothing_style"].beside == "silhouette"
    assert abs(seen["softness"].r or 1.0) < 0.5


def test_evidence_is_computed_from_the_file():
    table = read_scores(sample_file("primary-200"))
    at = [table.items.index(part) for part in intermediate()["thickness_texture"]]
    r = correlate(table.scores[:, at]).r[0, 1]
    seen = dict(zip((one.id for one in primary()), evidence(), strict=True))
    assert seen["thickness"].r == pytest.approx(r, abs=1e-12)
    assert seen["pleat_effect"].r is None


def test_lanes_put_each_pair_together_and_the_dropped_one_second():
    found = analyse(twelve(), GARMENT.item_ids, settings=Settings(drop=STATIC, draws=0))
    way = way_of(found)
    assert way is not None
    for stays, goes in (("silhouette", "static_overall"), ("dynamic_drape", "static_drape")):
        assert way.lanes.index(goes) == way.lanes.index(stays) + 1
    assert way_of(analyse(twelve()[:, :5], GARMENT.item_ids[:5])) is None


def test_demo_without_a_name_lists_every_sample_in_a_line_of_its_own(capsys):
    for arguments in (["--demo"], ["--demo", "list"]):
        assert main(["analyse", *arguments]) == 0
        lines = capsys.readouterr().out.splitlines()
        assert [line.split()[0] for line in lines] == list(SAMPLES)
        assert all("synthetic" in line for line in lines)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    made = tmp_path_factory.mktemp("way")
    arguments = [
        "analyse",
        "--demo",
        "primary-200",
        "--drop",
        "static",
        "--bootstrap",
        "0",
        "--parallel",
        "0",
    ]
    assert main([*arguments, "--report", str(made), *HERE, "--json"]) == 0
    return made


def test_the_report_shows_the_way_as_a_figure_and_tables_and_whose_scores_these_are(folder):
    page = (folder / "report.html").read_text("utf-8")
    assert "computed from the synthetic sample primary-200" in page
    assert "由合成样本 primary-200 算出" in page
    for language, side in (("en", 1), ("zh", 0)):
        drawn = (folder / f"figures/way.{language}.svg").read_text("utf-8")
        for number, one in enumerate(primary(), 1):
            assert f"{number}  {one.name[side]}" in drawn
        for item in GARMENT.items:
            shown = drawn.count(f">{(item.label.zh, item.label.en)[side]}<")
            assert shown == (1 if item.id in STATIC else 2), item.id
        rows = cells(folder / f"tables/way.{language}.csv")
        assert len(rows) == 26
    pairs = cells(folder / "tables/way-pairs.en.csv")
    assert [row[1] for row in pairs[1:]] == [".968", ".930"] or [row[1] for row in pairs[1:]] == [
        "0.968",
        "0.930",
    ]
    assert all(float(row[2]) >= 0.93 for row in pairs[1:])
    assert all(row[3] == "" for row in pairs[1:])  # nobody answered


def test_with_answers_the_second_step_is_theirs():
    scores = np.column_stack([likert_sample(80, 1), likert_sample(80, 2)[:, :2]])
    found = analyse(scores, GARMENT.item_ids, settings=Settings(draws=0))
    report = build(ScoreTable(scores, GARMENT.item_ids, questionnaire=GARMENT), found)
    assert "computed from 80 answers" in report.html
    rows = list(csv.reader(report.tables["way-pairs.en.csv"].removeprefix("\ufeff").splitlines()))
    assert len(rows) == 3  # no pair of these is close: the paper's two are told with what r they have here
    assert found.correlation is not None
    i, j = (GARMENT.item_ids.index(item) for item in ("silhouette", "static_overall"))
    assert float(rows[1][3]) == pytest.approx(found.correlation.r[i, j], abs=5e-4)
    assert "12 final" in report.drawings["way.en.svg"]


@pytest.mark.nightly
@pytest.mark.parametrize("answers", [0, 1])
def test_where_nobody_has_answered_the_garment_s_report_shows_the_way_all_the_same(tmp_path, capsys, answers):
    with closing(Store(tmp_path / "data")) as store:
        for _ in range(answers):
            store.submit(GARMENT, Answer.of(GARMENT, submission(GARMENT)))
    asked = [
        "analyse",
        "--questionnaire",
        "garment",
        "--data",
        str(tmp_path / "data"),
        *HERE,
        "--bootstrap",
        "0",
    ]
    assert main([*asked, "--report", str(tmp_path / "out")]) == 0
    out, err = capsys.readouterr()
    assert out == ""
    assert f"{answers} complete answers; the report is of the synthetic sample primary-200" in err
    page = (tmp_path / "out" / "report.html").read_text("utf-8")
    assert "Synthetic data" in page
    assert (tmp_path / "out" / "figures" / "way.zh.svg").is_file()
    # What only prints figures makes none up.
    assert main(asked) == 1
    capsys.readouterr()
    assert main([*asked, "--json", "--report", str(tmp_path / "none")]) == 1
    assert json.loads(capsys.readouterr().out)["error"]["code"] == "too_few_rows"
    assert not (tmp_path / "none").exists()


def test_another_questionnaire_s_report_has_no_such_section():
    scores = likert_sample(60, 4)
    names = tuple(f"q{at}" for at in range(10))
    report = build(ScoreTable(scores, names), analyse(scores, names, settings=Settings(draws=0)))
    assert not [name for name in report.drawings if name.startswith("way")]
