"""`survey plan`: known figures of the literature, and what no number of answers gives."""

import json

import numpy as np
import pytest

from survey.analysis import OutOfReach
from survey.analysis.planning import (
    correlation_answers,
    correlation_margin_answers,
    difference_answers,
    difference_power,
    fit_answers,
    fit_power,
    mean_answers,
    mean_margin,
    reliability_answers,
    reliability_width_answers,
)
from survey.cli import main


def run(capsys, *arguments) -> dict:
    assert main(["plan", *map(str, arguments), "--json"]) == 0
    return json.loads(capsys.readouterr().out)


@pytest.mark.parametrize(("effect", "n"), [(0.2, 394), (0.5, 64), (0.8, 26)])
def test_a_difference_needs_cohen_s_numbers(effect, n, capsys):
    assert run(capsys, "difference", "--effect", effect)["n"] == [
        n,
        n,
    ]  # Cohen 1988, table 2.4.1: 393, 64, 26
    assert difference_power(effect, n, n) >= 0.8 > difference_power(effect, n - 1, n - 1)


def test_more_items_and_unequal_groups_want_more(capsys):
    plain = difference_answers(0.5)
    assert run(capsys, "difference", "--items", 12)["n"][0] > plain[0]
    first, second = run(capsys, "difference", "--ratio", 3)["n"]
    assert second == 3 * first
    assert first + second > sum(plain)


@pytest.mark.parametrize(("df", "n"), [(20, 435), (50, 214), (100, 132)])
def test_fit_needs_maccallum_s_numbers(df, n, capsys):
    """MacCallum, Browne and Sugawara 1996, table 4: close fit, power .80."""
    assert run(capsys, "fit", "--df", df)["n"] == pytest.approx(n, abs=1)


def test_the_other_way_round_tells_a_good_fit_from_a_close_one():
    assert fit_power(1000, 50, 0.05, 0.01) > fit_power(200, 50, 0.05, 0.01)
    assert fit_power(fit_answers(50, 0.8, 0.05, 0.01), 50, 0.05, 0.01) >= 0.8


def test_degrees_of_freedom_come_from_a_model(capsys):
    model = "visual =~ x1 + x2 + x3; textual =~ x4 + x5 + x6; speed =~ x7 + x8 + x9"
    assert run(capsys, "fit", "--model", model)["df"] == 24


@pytest.mark.parametrize(("r", "n"), [(0.1, 783), (0.3, 85), (0.5, 30)])
def test_a_correlation_needs_cohen_s_numbers(r, n):
    assert correlation_answers(r) == pytest.approx(n, abs=2)


def test_each_size_is_the_smallest_that_is_enough():
    n = mean_answers(0.2, 1.0)
    assert mean_margin(1.0, n) <= 0.2 < mean_margin(1.0, n - 1)
    # To know r = .5 to ± .1: Fisher's interval, Bonett and Wright 2000, who have 219.
    assert correlation_margin_answers(0.5, 0.1) == pytest.approx(219, abs=4)
    assert reliability_width_answers(0.85, 0.1, 10) > reliability_width_answers(0.85, 0.2, 10)


def test_bonett_s_test_of_alpha_has_the_power_it_says():
    """Of normal items drawn with α = .85: the interval's lower end exceeds .7 in four of five samples."""
    k, alpha, least = 5, 0.85, 0.7
    n = reliability_answers(alpha, least, k)
    r = alpha / (k - (k - 1) * alpha)
    root = np.linalg.cholesky(np.full((k, k), r) + (1 - r) * np.eye(k)).T
    rng, hits, draws = np.random.default_rng(5), 0, 2000
    for _ in range(draws):
        covariance = np.cov(rng.normal(size=(n, k)) @ root, rowvar=False)
        found = k / (k - 1) * (1 - np.trace(covariance) / covariance.sum())
        half = 1.959964 * np.sqrt(2 * k / ((k - 1) * (n - 2)))
        hits += 1 - np.exp(np.log(1 - found) + half) > least
    assert hits / draws == pytest.approx(0.8, abs=0.06)


def test_samples_of_the_shipped_population_find_three_factors_the_oftener_the_more_answers(capsys):
    arguments = ["factors", "--n", "20,200", "--draws", "150", "--seed", "3"]
    found = run(capsys, *arguments)
    few, many = found["sizes"]
    assert 0.35 < few["finds_three"] < 0.75
    assert many["finds_three"] > 0.75
    assert many["loading_error"]["median"] < 0.1 < few["loading_error"]["median"]
    assert few["kmo"][0] < few["kmo"][1] < many["kmo"][1]
    assert run(capsys, *arguments) == found


def test_without_a_goal_every_formula_teaches(capsys):
    assert main(["plan"]) == 0
    text = capsys.readouterr().out
    for word in ("mean:", "difference:", "correlation:", "reliability:", "fit:", "survey plan factors"):
        assert word in text
    assert set(run(capsys)) == {"mean", "difference", "correlation", "reliability", "fit"}


@pytest.mark.parametrize(
    "arguments",
    [
        ["reliability", "--alpha", "0.6", "--least", "0.7"],
        ["difference", "--effect", "0.00001"],
        ["fit", "--null", "0.05", "--actual", "0.05"],
        ["factors", "--n", "8", "--draws", "3"],
    ],
)
def test_what_no_number_of_answers_gives_is_one_line_and_status_1(arguments, capsys):
    assert main(["plan", *arguments]) == 1
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    assert "–" in err


@pytest.mark.parametrize(
    "arguments", [["mean", "--margin", "-1"], ["nonsense"], ["fit", "--df", "0"], ["factors", "--n", "x"]]
)
def test_wrong_arguments_end_with_2(arguments):
    with pytest.raises(SystemExit) as end:
        main(["plan", *arguments])
    assert end.value.code == 2


def test_the_planner_s_own_door_is_typed():
    with pytest.raises(OutOfReach, match="items"):
        reliability_answers(0.8, 0.5, 1)
