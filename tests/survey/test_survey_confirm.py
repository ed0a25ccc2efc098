"""`survey confirm`: models as text, what no data can answer, what the answers do not allow, what is told beside."""

import json

import numpy as np
import pytest
from lavaan_record import rows_with, write_rows
from survey_samples import likert_sample

from survey.analysis import BadModel
from survey.analysis.confirmatory import Measurement, confirm, parsed
from survey.analysis.correlation import patterns_of, saturated
from survey.cli import main
from survey.demonstration import TABLE_3_ITEMS, gappy, sample_file

SIX = tuple("abcdef")
TWO = "F =~ a + b + c; G =~ d + e + f"


def run(capsys, *arguments) -> tuple[int, dict, str]:
    status = main(["confirm", *map(str, arguments), "--json"])
    out, err = capsys.readouterr()
    return status, json.loads(out), err


def table(r, n=200, seed=1):
    return rows_with(np.zeros(len(r)), np.array(r, dtype=float), n, seed)


def block(within: float, across: float) -> np.ndarray:
    r = np.full((6, 6), across)
    r[:3, :3] = r[3:, 3:] = within
    np.fill_diagonal(r, 1.0)
    return r


def codes(found: dict) -> set[str]:
    return {note["code"] for note in found["warnings"]}


def test_a_model_is_read_as_lavaan_reads_it():
    model = parsed("F =~ a + b  # one\n F =~ c\nG=~d+e + f ; a ~~ d; F ~~ 0*G\nF ~~ G")
    assert model == Measurement(
        (("F", ("a", "b", "c")), ("G", ("d", "e", "f"))), (("a", "d"),), (("F", "G"),)
    )
    assert parsed(model.text) == model
    assert model.freedom() == 21 - (4 + 2 + 6 + 1)


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("", "no factor"),
        ("a + b", "neither"),
        ("F =~ a + 2*b", "fixed or labelled"),
        ("F =~ a + + b", "no name"),
        ("F =~ a + a", "twice"),
        ("F =~ a + b; G =~ F + c", "factor and an item"),
        ("F =~ a + b + c; a ~~ a", "variances"),
        ("F =~ a + b + c; a ~~ F", "two items, or two factors"),
        ("F =~ a + b + c; a ~~ b; b ~~ a", "twice"),
        ("F =~ a + b + c; a ~ b", "neither"),
    ],
)
def test_a_text_that_is_no_model_is_told_with_its_part(text, what):
    with pytest.raises(BadModel, match="–") as told:
        parsed(text)
    assert what in str(told.value)


@pytest.mark.parametrize(
    ("model", "code"),
    [
        ("F =~ a + b", "not_identified"),
        ("F =~ a; G =~ b + c + d", "not_identified"),
        ("F =~ a + b; G =~ c + d + e; F ~~ 0*G", "not_identified"),
        ("F =~ a + b + c; a ~~ b", "not_identified"),
        ("F =~ a + b + z", "unknown_item"),
        ("F =~ a ** b", "bad_model"),
    ],
)
def test_a_model_that_nothing_could_tell_is_refused_with_status_1(model, code, tmp_path, capsys):
    rows = write_rows(tmp_path / "a.csv", SIX, table(block(0.5, 0.3)))
    status, told, err = run(capsys, rows, "--model", model)
    assert (status, told["error"]["code"]) == (1, code)
    assert err.count("\n") == 1
    assert "–" in err


def test_two_factors_of_two_items_are_identified_by_their_correlation(tmp_path, capsys):
    rows = write_rows(tmp_path / "a.csv", SIX, table(block(0.6, 0.3)))
    status, told, _ = run(capsys, rows, "--model", "F =~ a + b; G =~ d + e")
    assert status == 0
    assert told["fit"]["df"] == 1
    assert told["factor_correlations"]["values"][1][0] == pytest.approx(0.5, abs=1e-5)
    apart = write_rows(tmp_path / "b.csv", SIX, table(block(0.6, 0.0)))
    status, told, _ = run(capsys, apart, "--model", "F =~ a + b; G =~ d + e")
    assert (status, told["error"]["code"]) in {(1, "not_identified"), (1, "not_converged")}


def test_a_population_that_has_the_model_is_found_again(tmp_path, capsys):
    rows = write_rows(tmp_path / "a.csv", SIX, table(block(0.49, 0.245)))
    status, told, _ = run(capsys, rows, "--model", TWO)
    assert status == 0
    assert told["fit"]["chi2"] == pytest.approx(0.0, abs=1e-6)
    assert told["fit"]["cfi"] == told["fit"]["rmsea"]["p_close"] == pytest.approx(1.0, abs=0.05)
    loadings = np.array(told["loadings"]["values"])
    assert loadings[:3, 0] == pytest.approx(0.7, abs=1e-6)
    assert loadings[3:, 1] == pytest.approx(0.7, abs=1e-6)
    assert np.abs(np.array(told["residual_correlations"]["values"])).max() < 1e-6


def test_units_and_the_order_of_items_change_no_fit():
    scores = likert_sample(150, seed=3)
    model = parsed(
        "F =~ fabric_texture + fabric_colour + fabric_lustre; G =~ silhouette + pleat + perspective"
    )
    plain = confirm(scores, TABLE_3_ITEMS, model)
    turned = confirm(scores * np.logspace(-3, 3, 10) + 7.0, TABLE_3_ITEMS, model)
    back = parsed(
        "G =~ perspective + pleat + silhouette; F =~ fabric_lustre + fabric_texture + fabric_colour"
    )
    other = confirm(scores, TABLE_3_ITEMS, back)
    assert turned.fit.chi2 == pytest.approx(plain.fit.chi2, abs=1e-6)
    assert other.fit.chi2 == pytest.approx(plain.fit.chi2, abs=1e-6)
    assert turned.loadings == pytest.approx(plain.loadings, abs=1e-6)
    for gone in (plain, turned):
        assert {note.code for note in gone.notes} <= {"few_for_model"}


def test_three_items_leave_nothing_to_test_and_that_is_told(tmp_path, capsys):
    rows = write_rows(tmp_path / "a.csv", SIX, table(block(0.5, 0.3)))
    _, told, _ = run(capsys, rows, "--model", "F =~ a + b + c")
    assert told["fit"]["df"] == 0
    assert told["fit"]["p"] is None
    assert "saturated" in codes(told)


def test_a_negative_residual_variance_is_told_with_its_item(tmp_path, capsys):
    r = [[1.0, 0.8, 0.8], [0.8, 1.0, 0.5], [0.8, 0.5, 1.0]]
    rows = write_rows(tmp_path / "a.csv", ("a", "b", "c"), table(r))
    status, told, _ = run(capsys, rows, "--model", "F =~ a + b + c")
    assert status == 0
    assert [note["items"] for note in told["warnings"] if note["code"] == "heywood"] == [["a"]]


def test_factors_correlated_beyond_one_are_told(tmp_path, capsys):
    rows = write_rows(
        tmp_path / "a.csv", SIX, table(block(0.5, 0.5) + np.kron([[0, 1], [1, 0]], np.full((3, 3), 0.05)))
    )
    _, told, _ = run(capsys, rows, "--model", TWO)
    assert "improper_factors" in codes(told)
    assert told["factor_correlations"]["values"][1][0] > 1.0


def test_an_item_in_two_factors_is_allowed_and_told(tmp_path, capsys):
    rows = write_rows(tmp_path / "a.csv", SIX, table(block(0.5, 0.3)))
    status, told, _ = run(capsys, rows, "--model", "F =~ a + b + c + d; G =~ d + e + f")
    assert status == 0
    assert [note["items"] for note in told["warnings"] if note["code"] == "cross_loading"] == [["d"]]


@pytest.mark.parametrize(
    ("change", "code"),
    [
        (lambda x: x[:5], "too_few_rows"),
        (lambda x: np.column_stack([x[:, :5], x[:, 0]]), "dependent_items"),
        (lambda x: np.column_stack([x[:, :5], np.ones(len(x))]), "constant_item"),
        (lambda x: np.where(np.arange(6) == 5, np.nan, x), "not_finite"),
    ],
)
@pytest.mark.parametrize("estimator", ["ml", "dwls"])
def test_answers_that_no_model_can_be_fitted_to_are_refused_by_name(
    change, code, estimator, tmp_path, capsys
):
    whole = np.clip(np.rint(3 + table(block(0.5, 0.3))), 1, 5)
    rows = write_rows(tmp_path / "a.csv", SIX, change(whole))
    status, told, _ = run(capsys, rows, "--model", TWO, "--estimator", estimator)
    assert status == 1
    if (estimator, code) == ("dwls", "not_finite"):
        assert told["error"]["code"] in {"not_finite", "too_few_rows"}  # no answer is whole
        return
    assert told["error"]["code"] == code


def test_dwls_refuses_amounts_and_gaps_by_likelihood(tmp_path, capsys):
    rows = write_rows(tmp_path / "a.csv", SIX, table(block(0.5, 0.3)))
    status, told, _ = run(capsys, rows, "--model", TWO, "--estimator", "dwls")
    assert (status, told["error"]["code"]) == (1, "too_many_scores")
    with pytest.raises(SystemExit) as end:
        main(["confirm", str(rows), "--model", TWO, "--estimator", "dwls", "--missing", "fiml"])
    assert end.value.code == 2


def test_categories_that_nobody_or_hardly_anybody_chose_are_told(tmp_path, capsys):
    scores = likert_sample(200, seed=5)
    scores[:, 0] = np.where(scores[:, 0] == 5, 4, scores[:, 0])
    items = (*TABLE_3_ITEMS, "static_overall", "static_drape")
    rows = write_rows(tmp_path / "a.csv", items, np.column_stack([scores, scores[:, :2]]))
    status, told, _ = run(
        capsys, rows, "--questionnaire", "garment", "--drop", "static", "--estimator", "dwls"
    )
    assert status == 0
    assert told["factors"] == ["fabric", "form", "motion"]
    assert "fabric_texture" in next(
        note["items"] for note in told["warnings"] if note["code"] == "empty_category"
    )
    assert "rare_category" in codes(told)
    assert told["robust"]["df"] == told["fit"]["df"] == 32


def test_gaps_count_with_what_they_have_and_that_is_told(capsys):
    model = ("--model", "F =~ fabric_texture + fabric_colour + fabric_lustre + thickness_texture")
    status, full, _ = run(capsys, sample_file("likert-200-gaps"), *model)
    assert status == 0
    assert full["estimator"] == "fiml"
    assert full["n"] == 200
    _, part, _ = run(capsys, sample_file("likert-200-gaps"), *model, "--missing", "listwise")
    assert part["estimator"] == "ml"
    assert part["n"] < 200
    assert "missing" in codes(full) & codes(part)


def test_gaps_that_depend_on_the_answers_do_not_bend_the_likelihood_s_means():
    """Who scores low on the first item leaves out the second: what is left alone is biased, EM is not."""
    rng = np.random.default_rng(8)
    x = rng.normal(size=(4000, 2)) @ np.linalg.cholesky([[1.0, 0.7], [0.7, 1.0]]).T
    x[x[:, 0] < 0.0, 1] = np.nan
    found = saturated(patterns_of(x, ("a", "b")), ("a", "b"))
    assert np.nanmean(x[:, 1]) > 0.4
    assert abs(found.mean[1]) < 0.08
    assert found.covariance == pytest.approx(np.array([[1.0, 0.7], [0.7, 1.0]]), abs=0.1)


def test_em_ends_where_the_likelihood_is_greatest():
    scores = gappy(likert_sample(120, seed=2)[:, :5], 0.15, seed=4)
    seen = patterns_of(scores, "abcde")
    best = saturated(seen, "abcde")
    from survey.analysis.correlation import misfit_of

    _, by_sigma, by_mean, _ = misfit_of(seen, best.mean, best.covariance)
    assert np.abs(by_sigma).max() < 1e-7
    assert np.abs(by_mean).max() < 1e-7


def test_explored_factors_are_fitted_and_said_to_confirm_nothing(capsys):
    status, told, _ = run(capsys, "--demo", "likert-200", "--drop", "static", "--model", "explored")
    assert status == 0
    assert len(told["factors"]) in {2, 3}
    assert "same_answers" in codes(told)


def test_without_a_questionnaire_there_are_no_modules(capsys):
    status, told, _ = run(capsys, sample_file("likert-200"))
    assert (status, told["error"]["code"]) == (1, "bad_model")


def test_the_page_for_people_holds_fit_loadings_and_notes(capsys):
    assert main(["confirm", "--demo", "likert-200", "--drop", "static", "--estimator", "dwls"]) == 0
    text = capsys.readouterr().out
    for part in (
        "robust (scaled, shifted)",
        "RMSEA",
        "fabric =~ fabric_texture",
        "correlations of the factors",
    ):
        assert part in text


def test_the_analysis_takes_correlations_of_greatest_likelihood(capsys):
    arguments = ["analyse", "--demo", "likert-200-gaps", "--drop", "static", "--bootstrap", "0", "--json"]
    assert main([*arguments, "--missing", "fiml"]) == 0
    likely = json.loads(capsys.readouterr().out)
    assert main([*arguments, "--missing", "pairwise"]) == 0
    pairwise = json.loads(capsys.readouterr().out)
    a, b = (np.array(found["correlation"]["values"]) for found in (likely, pairwise))
    assert 1e-4 < np.abs(a - b).max() < 0.1
    assert likely["n"] == pairwise["n"]
    assert "make likeliest" in next(one["message"] for one in likely["warnings"] if one["code"] == "missing")
