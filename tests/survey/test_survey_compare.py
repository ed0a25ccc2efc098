"""`survey compare`: two groups of a table or of the store, item by item."""

import json
from pathlib import Path

import numpy as np
import pytest
from scipy import stats
from survey_samples import ASSETS, submission

from survey.analysis.comparison import compare, holm
from survey.cli import main

ITEMS = ("colour", "drape", "quiet")


def rows(
    tmp_path: Path, n: int = 40, m: int = 30, labels=("wool", "silk"), seed: int = 4, common: float = 0.0
) -> Path:
    rng = np.random.default_rng(seed)
    away = np.array([1.4, 0.0, 0.0])
    one, other = (rng.normal(size=(k, 3)) + common * rng.normal(size=(k, 1)) for k in (n, m))
    one, other = np.clip(np.rint(3.0 + away + one), 1, 5), np.clip(np.rint(3.0 + other), 1, 5)
    lines = [
        f"{label},{a:g},{b:g},{c:g}"
        for label, part in zip(labels, (one, other), strict=True)
        for a, b, c in part
    ]
    file = tmp_path / "answers.csv"
    file.write_text("\n".join(["cloth,colour,drape,quiet", *lines]), "utf-8")
    return file


def run(capsys, *arguments) -> tuple[int, dict, str]:
    status = main(["compare", *map(str, arguments), "--json"])
    out, err = capsys.readouterr()
    return status, json.loads(out), err


def test_a_planted_difference_is_found_and_the_others_are_not(tmp_path, capsys):
    status, told, _ = run(capsys, rows(tmp_path), "--by", "cloth", "--groups", "wool,silk")
    assert status == 0
    assert [group["n"] for group in told["groups"]] == [40, 30]
    first, second, third = told["items"]
    assert first["welch"]["p_holm"] < 0.01
    assert first["mann_whitney"]["p_holm"] < 0.01
    assert min(second["welch"]["p_holm"], third["welch"]["p_holm"]) > 0.05
    assert first["hedges_g"]["low"] > 0.2
    assert first["cliffs_delta"]["low"] > 0.1
    for one in told["items"]:
        for key in ("difference", "hedges_g", "cliffs_delta"):
            assert one[key]["low"] < one[key]["value"] < one[key]["high"]


def test_turned_round_every_sign_turns(tmp_path, capsys):
    file = rows(tmp_path)
    _, one, _ = run(capsys, file, "--by", "cloth", "--groups", "wool,silk")
    _, other, _ = run(capsys, file, "--by", "cloth")  # by the alphabet: silk first
    assert other["groups"][0]["name"] == "silk"
    for a, b in zip(one["items"], other["items"], strict=True):
        for key in ("difference", "hedges_g", "cliffs_delta"):
            assert a[key]["value"] == pytest.approx(-b[key]["value"], abs=1e-12)
            assert a[key]["low"] == pytest.approx(-b[key]["high"], abs=1e-8)
        assert a["welch"]["p"] == pytest.approx(b["welch"]["p"])


def test_g_s_interval_is_the_noncentral_t_s_and_delta_is_the_rank_biserial():
    rng = np.random.default_rng(1)
    x, y = rng.normal(0.5, 1.0, size=(35, 1)), rng.normal(0.0, 1.0, size=(25, 1))
    found = compare(np.concatenate([x, y]), ["a"], ["p"] * 35 + ["q"] * 25).items[0]
    assert found.g is not None
    assert found.delta is not None
    assert found.u is not None
    root, df = (1 / 35 + 1 / 25) ** 0.5, 58
    shrink = 1.0 - 3.0 / (4.0 * df - 1.0)
    t = float(stats.ttest_ind(x[:, 0], y[:, 0])[0])  # pyright: ignore[reportArgumentType]
    assert found.g.value == pytest.approx(t * root * shrink, abs=1e-4)
    for edge, level in ((found.g.low, 0.975), (found.g.high, 0.025)):
        assert stats.nct.cdf(t, df, edge / shrink / root) == pytest.approx(level, abs=1e-3)
    assert found.delta.value == pytest.approx(2.0 * found.u / (35 * 25) - 1.0, abs=1e-12)


@pytest.mark.nightly
def test_intervals_hold_the_truth_as_often_as_they_say():
    rng, hits, draws = np.random.default_rng(7), np.zeros(2), 300
    true_delta = 2.0 * stats.norm.cdf(0.5 / 2**0.5) - 1.0
    for _ in range(draws):
        table = np.concatenate([rng.normal(0.5, 1.0, size=(30, 1)), rng.normal(size=(30, 1))])
        found = compare(table, ["a"], ["a"] * 30 + ["b"] * 30).items[0]
        assert found.g is not None
        assert found.delta is not None
        hits += [found.g.low <= 0.5 <= found.g.high, found.delta.low <= true_delta <= found.delta.high]
    assert (np.abs(hits / draws - 0.95) < 0.04).all()


def test_holm_is_steps_that_never_fall():
    assert holm([0.01, 0.04, 0.03]) == pytest.approx([0.03, 0.06, 0.06])
    assert holm([0.9, 0.8]) == pytest.approx([1.0, 1.0])


@pytest.mark.parametrize(("n", "m"), [(9, 30), (30, 3)])
def test_a_group_below_ten_is_refused_and_its_size_not_told(n, m, tmp_path, capsys):
    status, told, err = run(capsys, rows(tmp_path, n, m), "--by", "cloth")
    assert (status, told["error"]["code"]) == (1, "group_too_small")
    assert f" {min(n, m)} " not in err
    assert "fewer than 10" in err


def test_an_item_that_few_of_a_group_answered_is_left_out_with_a_note(tmp_path, capsys):
    file = rows(tmp_path)
    lines = file.read_text("utf-8").splitlines()
    lines[1:33] = [line.rsplit(",", 1)[0] + "," for line in lines[1:33]]
    file.write_text("\n".join(lines), "utf-8")
    status, told, _ = run(capsys, file, "--by", "cloth")
    assert status == 0
    assert told["items"][2]["mean"] is None
    assert told["items"][2]["n"] is None
    assert told["warnings"][0]["items"] == ["quiet"]


def test_an_item_without_any_variation_has_means_and_no_test():
    table = np.column_stack([np.full(30, 3.0), np.arange(30) % 5])
    found = compare(table, ["same", "other"], ["a", "b"] * 15)
    assert found.items[0].mean == (3.0, 3.0)
    assert found.items[0].p is None
    assert found.items[1].p_holm == found.items[1].p
    assert [note.code for note in found.notes] == ["constant_item"]


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        (["--by", "colour"], "unknown_group"),
        (["--by", "cloth", "--groups", "wool,linen"], "unknown_group"),
        (["--by", "cloth", "--groups", "wool,wool"], "unknown_group"),
    ],
)
def test_what_is_no_pair_of_groups_is_told_with_those_there_are(arguments, code, tmp_path, capsys):
    status, told, err = run(capsys, rows(tmp_path), *arguments)
    assert (status, told["error"]["code"]) == (1, code)
    assert "–" in err


def test_a_column_that_there_is_not_is_told_with_those_there_are(tmp_path, capsys):
    assert main(["compare", str(rows(tmp_path)), "--by", "age"]) == 1
    assert "its columns are cloth, colour" in capsys.readouterr().err


def test_stored_answers_by_language_and_by_exhibit(hall, capsys):
    for at in range(24):
        zh = at % 2 == 0
        body = submission(
            hall.garment, score=2 + at % 3 if zh else 3 + at % 3, language="zh" if zh else "en",
            exhibit="scarf" if at < 12 else "robe",
        )  # fmt: skip
        assert hall.client.post(hall.url, json=body).status_code in {200, 201}
    place = ["--db", hall.data] if isinstance(hall.data, str) else ["--data", hall.data]
    where = ["--content", str(ASSETS), *place]
    status, told, _ = run(capsys, "--questionnaire", "garment", "--by", "language", *where)
    assert status == 0
    assert [(group["name"], group["n"]) for group in told["groups"]] == [("en", 12), ("zh", 12)]
    assert all(one["difference"]["value"] > 0 for one in told["items"])
    status, told, _ = run(capsys, "--questionnaire", "garment", "--by", "exhibit", *where)
    assert {group["name"] for group in told["groups"]} == {"scarf", "robe"}


def test_roles_are_compared_dimension_by_dimension(hall, capsys):
    for role, score in (("platform-user", 4), ("platform-admin", 2)):
        asked = hall.mounted.questionnaires[role]
        for at in range(12):
            body = submission(asked, score=score + at % 2)
            url = f"/api/v1/questionnaires/{role}/submissions"
            assert hall.client.post(url, json=body).status_code in {200, 201}
    place = ["--db", hall.data] if isinstance(hall.data, str) else ["--data", hall.data]
    where = ["--content", str(ASSETS), *place]
    status, told, _ = run(capsys, "--questionnaire", "platform-user", "--by", "role", *where)
    assert status == 0
    assert {group["name"] for group in told["groups"]} == {"platform-user", "platform-admin"}
    assert len(told["items"]) == 6
    assert all(abs(one["difference"]["value"]) == pytest.approx(2.0) for one in told["items"])
    assert main(["compare", "--questionnaire", "garment", "--by", "role", *map(str, where)]) == 1
    assert "has no dimensions" in capsys.readouterr().err


def test_wrong_arguments_end_with_2(tmp_path, capsys):
    for arguments in (
        ["--by", "language"],
        ["--questionnaire", "garment", "--by", "age"],
        [str(rows(tmp_path)), "--by", "cloth", "--groups", "wool"],
        ["--demo", "likert-200", "--by", "language"],
    ):
        with pytest.raises(SystemExit) as end:
            main(["compare", *arguments])
        assert end.value.code == 2
        assert "usage:" in capsys.readouterr().err


def test_the_report_holds_both_chapters_in_both_languages_and_escapes_labels(tmp_path, capsys):
    file = rows(tmp_path, labels=("<b>wool</b>", "silk"), common=1.0)
    out = tmp_path / "out"
    arguments = ["analyse", str(file), "--confirm", "F =~ colour + drape + quiet", "--compare", "cloth"]
    assert main([*arguments, "--bootstrap", "0", "--report", str(out), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["confirmation"]["fit"]["df"] == 0
    assert len(told["comparison"]["items"]) == 3
    page = (out / "report.html").read_text("utf-8")
    for title in ("Confirmatory factor analysis", "验证性因子分析", "Two groups", "两组比较"):
        assert page.count(title) >= 2  # the heading and the list of contents
    assert "<b>wool</b>" not in page
    assert "&lt;b&gt;wool&lt;/b&gt;" in page
    for name in ("confirm-fit", "confirm-loadings", "compare-means", "compare-tests"):
        for language in ("zh", "en"):
            assert (out / "tables" / f"{name}.{language}.csv").read_text("utf-8").count("\n") >= 2
    for name in ("confirm-loadings", "compare-effects"):
        assert (out / "figures" / f"{name}.zh.svg").read_text("utf-8").startswith("<svg")
