"""Reliability scale by scale, reverse-keyed items, and columns that are no items: beside psych, by the user's doors.

bfi (Revelle 2010) comes with R's psych under GPL ≥ 2, so its rows are not here: the tables are made from its recorded
covariances, which is all that α, ω and item-total correlations of whole answers look at. `survey bench --only r` reads
the real one where there is R.
"""

from __future__ import annotations

import csv
import json
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from survey_samples import ASSETS, given, likert_sample, submission

from survey import Answer
from survey.analysis import Context, Settings, analyse
from survey.analysis.procedure import KEYS
from survey.cli import main
from survey.demonstration import with_moments
from survey.export import exported
from survey.questionnaire import Questionnaire, read_questionnaire
from survey.report import write_report
from survey.scores import ScoreTable, no_items, read_scores, stated_groups

RECORDED = json.loads((Path(__file__).parent / "recorded" / "psych.json").read_text("utf-8"))
BFI = RECORDED["data_sets"]["psych-bfi"]
BFI["names"] = [name.lower() for name in BFI["names"]]  # as the items of a questionnaire are spelt
SCALES = {
    name.lower(): told | {key: [item.lower() for item in told[key]] for key in ("items", "reversed")}
    for name, told in RECORDED["bfi_scales"].items()
}
REVERSED = [item for told in SCALES.values() for item in told["reversed"]]
GARMENT = read_questionnaire(ASSETS / "questionnaires" / "garment.toml")
QUICK = ["--json", "--bootstrap", "0", "--parallel", "0"]


def cells(path: Path) -> list[list[str]]:
    """The rows of a CSV file."""
    return list(csv.reader(path.read_text("utf-8-sig").splitlines()))


def written(path: Path, names, table) -> Path:
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(names)
        writer.writerows(
            [["" if value != value else f"{value:.17g}" for value in row] for row in table.tolist()]
        )
    return path


@pytest.fixture(scope="module")
def bfi(tmp_path_factory):
    """A table with bfi's 25 items, its covariances and its n, as a file."""
    covariance = np.array(BFI["covariance"])
    spread = np.sqrt(np.diag(covariance))
    r = covariance / np.outer(spread, spread)
    table = 3.5 + with_moments(r, BFI["n"], seed=1) * spread
    return written(tmp_path_factory.mktemp("bfi") / "bfi.csv", BFI["names"], table)


def told_by(capsys, *arguments) -> dict:
    assert main(["analyse", *map(str, arguments), *QUICK]) == 0
    found = json.loads(capsys.readouterr().out)
    assert tuple(found) == KEYS
    return found


def assert_psych_s(scale, theirs):
    assert scale["alpha"] == pytest.approx(theirs["alpha"], abs=1e-10)
    assert scale["alpha_standardised"] == pytest.approx(theirs["standardised"], abs=1e-10)
    for at, item in enumerate(theirs["items"]):
        assert scale["item_total"][item] == pytest.approx(theirs["item_total"][at], abs=1e-10)
        assert scale["alpha_if_deleted"][item] == pytest.approx(theirs["if_deleted"][at], abs=1e-10)
    assert scale["omega"] == pytest.approx(theirs["omega"], abs=1e-6)


def test_the_five_scales_of_bfi_are_found_as_components_with_psych_s_alpha_and_omega(bfi, capsys):
    found = told_by(capsys, bfi, "--factors", 5, "--reverse", ",".join(REVERSED))
    assert found["alpha"] != pytest.approx(BFI["alpha"], abs=0.05)
    scales = {frozenset(scale["items"]): scale for scale in found["scales"]}
    assert len(found["scales"]) == 5
    for theirs in SCALES.values():
        assert_psych_s(scales[frozenset(theirs["items"])], theirs)
    assert found["reversed"] == sorted(REVERSED, key=BFI["names"].index)
    (note,) = [note for note in found["warnings"] if note["code"] == "reversed"]
    assert "give --points" in note["message"]


def test_items_that_run_the_other_way_are_named_with_the_remedy_and_not_turned(bfi, capsys):
    found = told_by(capsys, bfi, "--factors", 5)
    assert found["alpha"] == pytest.approx(
        BFI["alpha"], abs=1e-10
    )  # .525: the scales pull against each other
    assert found["reversed"] == []
    (note,) = [note for note in found["warnings"] if note["code"] == "reversed_item"]
    assert sorted(note["items"]) == sorted(REVERSED)
    assert f"--reverse {','.join(note['items'])}" in note["message"]
    # What the note advises is what brings the figures.
    again = told_by(capsys, bfi, "--factors", 5, "--reverse", ",".join(note["items"]))
    assert not [note for note in again["warnings"] if note["code"] == "reversed_item"]


def bfi_toml() -> str:
    def text(words):
        return f'{{ zh = "{words}", en = "{words}" }}'

    lines = ['id = "bfi"', "version = 1", *(f"{key} = {text(key)}" for key in ("title", "intro", "consent"))]
    lines += ["[scale]", f"anchors = [{', '.join(text(f'p{at}') for at in range(1, 7))}]"]
    for name, told in SCALES.items():
        lines += ["[[module]]", f'id = "{name}"', f"title = {text(name)}"]
        for item in told["items"]:
            lines += ["[[module.item]]", f'id = "{item}"', f"label = {text(item)}"]
            lines += ["reverse = true"] if item in told["reversed"] else []
    return "\n".join(lines) + "\n"


@pytest.fixture
def content(tmp_path):
    """A content folder with bfi as a questionnaire of five modules, seven items of it reverse-keyed."""
    (tmp_path / "content" / "questionnaires").mkdir(parents=True)
    (tmp_path / "content" / "questionnaires" / "bfi.toml").write_text(bfi_toml(), "utf-8")
    return tmp_path / "content"


def test_a_questionnaire_s_modules_are_scales_and_its_keys_are_obeyed(bfi, content, capsys):
    asked = ["--questionnaire", "bfi", "--content", content]
    found = told_by(capsys, bfi, *asked)
    modules = {scale["key"]: scale for scale in found["scales"] if scale["kind"] == "module"}
    for name, theirs in SCALES.items():
        assert_psych_s(modules[name], theirs)
    (note,) = [note for note in found["warnings"] if note["code"] == "reversed"]
    assert "7 − score" in note["message"]
    unturned = told_by(capsys, bfi, *asked, "--reverse", "none")
    assert unturned["reversed"] == []
    (note,) = [note for note in unturned["warnings"] if note["code"] == "reversed_item"]
    assert set(note["items"]) == set(REVERSED)


def test_the_key_is_frozen_with_the_version_and_a_file_without_any_keeps_its_digest(content):
    asked = read_questionnaire(content / "questionnaires" / "bfi.toml")
    assert asked.reverse_keyed == tuple(item for item in asked.item_ids if item in REVERSED)
    again = Questionnaire.model_validate_json(json.dumps(asked.document()))
    assert again.reverse_keyed == asked.reverse_keyed
    assert again.digest == asked.digest
    assert "reverse" not in json.dumps(GARMENT.document())
    book = exported("codebook", asked, []).decode("utf-8-sig").splitlines()
    assert [line.split(",")[0] for line in book if line.endswith(",reverse")] == [
        "column",
        *asked.reverse_keyed,
    ]
    script = exported("r", asked, []).decode()
    assert 'reversed <- c("a1", "c4"' in script
    assert "7 - scores[, reversed]" in script


def test_a_dimension_may_be_reverse_keyed_and_is_a_scale_across_the_modules():
    admin = read_questionnaire(ASSETS / "questionnaires" / "platform-admin.toml")
    document = admin.document()
    document["dimension"][3]["reverse"] = True
    asked = Questionnaire.model_validate_json(json.dumps(document))
    assert asked.reverse_keyed == tuple(f"{module.id}_necessity" for module in asked.modules)
    groups = {(group.kind, group.key): group.items for group in stated_groups(asked)}
    assert len(groups) == 4 + 6
    assert groups["dimension", "necessity"] == asked.reverse_keyed
    assert len(groups["module", "collection"]) == 6


def test_turned_scores_are_low_plus_high_minus_score_and_gaps_stay():
    table = likert_sample(50, 3)
    table[4, 1] = np.nan
    found = analyse(table, settings=Settings(reverse=("item_2",)), context=Context(points=7))
    assert np.array_equal(found.table[:, 1], 8 - table[:, 1], equal_nan=True)
    assert np.array_equal(found.table[:, 0], table[:, 0])
    assert found.mean[1] == pytest.approx(8 - np.nanmean(table[:, 1]))
    spanned = analyse(table, settings=Settings(reverse=("item_2",)))
    assert np.nanmax(spanned.table[:, 1]) == np.nanmin(table) + np.nanmax(table) - np.nanmin(table[:, 1])


def test_item_total_is_the_correlation_with_the_sum_of_the_others():
    table = likert_sample(80, 5)
    found = given(analyse(table).reliability).item_total
    for item in range(10):
        rest = np.delete(table, item, axis=1).sum(axis=1)
        assert found[item] == pytest.approx(np.corrcoef(table[:, item], rest)[0, 1], abs=1e-12)


def test_a_component_of_one_item_or_two_has_what_it_can_have():
    rng = np.random.default_rng(8)
    common, pair = rng.normal(size=(2, 300, 1))
    table = np.column_stack([
        common + 0.5 * rng.normal(size=(300, 4)), pair + 0.5 * rng.normal(size=(300, 2)), rng.normal(size=(300, 1))
    ])  # fmt: skip
    found = analyse(table, settings=Settings(factors=3))
    by_size = {len(scale.items): scale for scale in found.scales}
    assert set(by_size) == {1, 2, 4}
    assert by_size[1].reliability is None
    assert by_size[2].omega is None
    assert given(by_size[2].reliability).if_deleted is None
    assert given(by_size[4].omega).omega == pytest.approx(given(by_size[4].reliability).alpha, abs=0.01)
    assert not [note for note in found.notes if note.code == "too_few_items"]


def test_each_scale_survives_pairwise_and_polychoric(capsys):
    table = likert_sample(120, 6)
    table[np.random.default_rng(2).random(table.shape) < 0.04] = np.nan
    for settings in (Settings(missing="pairwise"), Settings(method="polychoric")):
        found = analyse(table, settings=settings)
        assert len(found.scales) == given(found.components).kept
        for scale in found.scales:
            alpha = given(scale.reliability)
            assert 0 < alpha.alpha < 1
            assert (alpha.item_total > 0).all()


# ---- over HTTP and in the report ---------------------------------------------------------------------------------


@pytest.mark.nightly
@pytest.mark.parametrize("database", ["sqlite"], indirect=True)
def test_reverse_over_http_is_that_of_the_command(hall, capsys):
    scores = np.column_stack([likert_sample(40, 1), likert_sample(40, 2)[:, :2]])
    for row in scores.astype(int).tolist():
        body = submission(hall.garment, scores=dict(zip(hall.garment.item_ids, row, strict=True)))
        hall.store.submit(hall.garment, Answer.of(hall.garment, body))
    headers = {"authorization": f"Bearer {hall.store.tokens.make('researcher')}"}
    url = "/api/v1/questionnaires/garment/analysis"
    reply = hall.client.get(url, params={"reverse": "pleat,silhouette"}, headers=headers)
    assert reply.status_code == 200
    asked = ["--questionnaire", "garment", "--content", ASSETS, "--data", hall.data]
    command = [*map(str, asked), "--json", "--bootstrap", "0", "--reverse", "pleat,silhouette"]
    assert main(["analyse", *command]) == 0
    assert reply.json() == json.loads(capsys.readouterr().out)
    assert sorted(reply.json()["reversed"]) == ["pleat", "silhouette"]
    refused = hall.client.get(url, params={"reverse": "shoes"}, headers=headers)
    assert refused.status_code == 422
    assert "shoes: no such item to reverse" in refused.json()["problem"]
    assert hall.client.get(url, params={"reverse": "\0"}, headers=headers).json()["field"] == "reverse"


@pytest.fixture
def turned_report(tmp_path):
    """A report over a sample with one reverse-keyed item; yields (folder, what was analysed)."""
    scores = likert_sample(150, 9)
    names = GARMENT.item_ids[:10]
    scores[:, 3] = 6 - scores[:, 3]
    asked = GARMENT.asked(names)
    found = analyse(
        scores,
        names,
        settings=Settings(reverse=(names[3],), factors=3),
        context=Context(points=5, groups=stated_groups(asked)),
    )
    write_report(tmp_path, ScoreTable(scores, names, questionnaire=asked), found)
    return tmp_path, found


def test_the_report_has_every_scale_in_both_languages_and_marks_what_was_turned(turned_report):
    folder, found = turned_report
    page = (folder / "report.html").read_text("utf-8")
    assert "Thickness and hand (turned)" in page
    assert "厚度质感（反）" in page
    for language, module in (("en", "Module The fabric"), ("zh", "模块 面料特性")):
        table = cells(folder / f"tables/scales.{language}.csv")
        assert len(table) == 1 + len(found.scales)
        assert module in [row[0] for row in table]
        first = given(found.scales[0].reliability)
        assert float(table[1][3]) == pytest.approx(first.alpha, abs=5e-4)
        items = cells(folder / f"tables/scale-items.{language}.csv")
        assert float(items[1][2]) == pytest.approx(first.item_total[0], abs=5e-4)


def test_the_terminal_prints_alpha_omega_item_total_and_alpha_without_by_scale(bfi, capsys):
    assert main(["analyse", str(bfi), "--factors", "5", "--reverse", ",".join(REVERSED), *QUICK[1:]]) == 0
    lines = capsys.readouterr().out.splitlines()
    (head,) = [at for at, line in enumerate(lines) if "item-total" in line]
    at = next(at for at in range(head, len(lines)) if lines[at].startswith("component_1"))
    first = {item for told in SCALES.values() for item in told["items"]} & {lines[at + 1].split()[0]}
    (theirs,) = [told for told in SCALES.values() if first <= set(told["items"])]
    assert lines[at].split()[1:] == [f"{theirs['alpha']:.3f}", f"{theirs['omega']:.3f}"]
    place = theirs["items"].index(first.pop())
    assert lines[at + 1].split()[1:] == [
        f"{theirs['item_total'][place]:.3f}",
        f"{theirs['if_deleted'][place]:.3f}",
    ]


@pytest.mark.skipif(shutil.which("Rscript") is None, reason="R is not installed")
def test_the_r_script_comes_to_the_same_scales(turned_report):
    folder, found = turned_report
    done = subprocess.run(
        ["Rscript", "analysis.R", "scores.csv", "out.json"],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    told = json.loads((folder / "out.json").read_text("utf-8"))["scales"]
    ours = {
        scale.key if scale.kind == "component" else f"{scale.kind}_{scale.key}": scale
        for scale in found.scales
    }
    for name, theirs in told.items():
        mine = given(ours[name].reliability)
        at = [ours[name].items.index(item) for item in theirs["items"]]
        assert mine.alpha == pytest.approx(theirs["alpha"], abs=1e-10)
        assert mine.item_total[at] == pytest.approx(theirs["item_total"], abs=1e-10)
        if ours[name].omega is not None:
            assert given(ours[name].omega).omega == pytest.approx(theirs["omega"], abs=1e-4)
    assert set(told) == {name for name, scale in ours.items() if len(scale.items) > 1}


# ---- columns that are no items -----------------------------------------------------------------------------------


def rated(n: int, p: int, points: int = 6, seed: int = 1):
    return np.random.default_rng(seed).integers(1, points + 1, (n, p)).astype(float)


@pytest.fixture
def foreign(tmp_path):
    """A table as psych's bfi is laid out: 25 items of six points with gaps, then gender, education and age."""
    rng = np.random.default_rng(3)
    items = rated(400, 25)
    items[rng.random(items.shape) < 0.01] = np.nan
    about = [rng.integers(1, 3, 400), rng.integers(1, 6, 400), rng.integers(14, 80, 400)]
    return written(
        tmp_path / "a.csv",
        [*BFI["names"], "gender", "education", "age"],
        np.column_stack([items, *about]).astype(float),
    )


@pytest.mark.nightly
def test_age_gender_and_education_are_no_items_and_the_note_says_how_to_keep_them(foreign, capsys):
    found = told_by(capsys, foreign)
    assert found["items"] == BFI["names"]
    (note,) = [note for note in found["warnings"] if note["code"] == "no_item"]
    assert note["items"] == ["gender", "education", "age"]
    assert "--keep gender,education,age" in note["message"]
    kept = told_by(capsys, foreign, "--keep", "age,gender,education")
    assert kept["items"] == [*BFI["names"], "gender", "education", "age"]
    some = told_by(capsys, foreign, "--items", "n1,n2,n3,age")
    assert some["items"] == ["n1", "n2", "n3", "age"]
    assert not [note for note in some["warnings"] if note["code"] == "no_item"]


@pytest.mark.parametrize(
    "name", ["性别", "年龄", "1、您的性别：", "Q2. Gender", "学历", "序号", "提交答卷时间", "Participant ID"]
)
def test_names_in_both_languages_tell_what_is_no_item(name):
    columns = {**{f"q{at}": values for at, values in enumerate(rated(40, 5).T)}, name: rated(40, 1)[:, 0]}
    assert no_items(columns) == {name: "name"}


def test_values_far_off_the_common_scale_tell_it_too_and_a_slip_does_not():
    columns = {f"q{at}": values for at, values in enumerate(rated(40, 8).T)}
    columns["q3"][7] = 55.0
    columns["how long"] = np.linspace(20, 400, 40)
    assert no_items(columns) == {"how long": "scale"}
    assert no_items(columns, keep=("how long",)) == {}


def test_rather_too_much_is_kept_than_too_little():
    rng = np.random.default_rng(1)
    # Measures of all kinds share no scale; a scale of 0 to 100 is none of ratings; drape, weight, colour are items.
    assert no_items({f"m{at}": rng.normal(10.0**at, 1, 30) for at in range(5)}) == {}
    assert no_items({f"m{at}": rng.integers(0, 101, 30).astype(float) for at in range(5)}) == {}
    ratings: dict[str, np.ndarray] = dict(
        zip(("weight", "colour", "drape", "time", "专业", "收入满意度"), rated(40, 6).T, strict=True)
    )
    assert no_items(ratings) == {}
    assert no_items({"age": rated(9, 1)[:, 0], "id": rated(9, 1)[:, 0]}) == {}  # nothing else is there


def test_columns_of_text_are_named_and_our_own_export_s_are_not(tmp_path, capsys):
    path = tmp_path / "a.csv"
    rows = "".join(
        f"x{at},en,Lin,{a},{b}\n" for at, (a, b) in enumerate([(1, 2), (2, 1), (3, 4), (4, 2), (5, 5)])
    )
    path.write_text("submission,language,who,a,b\n" + rows, "utf-8")
    assert read_scores(path).aside == {"who": "text"}
    (note,) = [note for note in told_by(capsys, path)["warnings"] if note["code"] == "no_item"]
    assert note["items"] == ["who"]


@pytest.mark.nightly
def test_points_tell_the_scale_of_a_foreign_table(foreign, capsys):
    found = told_by(capsys, foreign, "--reverse", "a1", "--points", 7)
    messages = {note["code"]: note["message"] for note in found["warnings"]}
    assert "8 − score, on the scale 1 to 7" in messages["reversed"]
    assert "off_scale" in {note["code"] for note in told_by(capsys, foreign, "--points", 5)["warnings"]}


def test_what_is_wrong_with_these_arguments_is_one_line(foreign, capsys):
    for wrong in (["--reverse", "a1,shoes"], ["--items", "a1,shoes"], ["--keep", "shoes"]):
        assert main(["analyse", str(foreign), *wrong]) == 1
        err = capsys.readouterr().err
        assert "shoes" in err
        assert err.count("\n") == 1
    for wrong in (
        [str(foreign), "--points", "1"],
        [str(foreign), "--points", "six"],
        [str(foreign), "--questionnaire", "garment", "--keep", "age"],
        ["--demo", "likert-20", "--items", "pleat"],
        ["--questionnaire", "garment", "--points", "5"],
    ):
        with pytest.raises(SystemExit) as ended:
            main(["analyse", *wrong])
        assert ended.value.code == 2
        capsys.readouterr()
