"""Against R: psych's figures, recorded by tests/bench/bench_survey_r.py with the versions that made them.

Sources: psych's bfi (Revelle 2010, 2436 complete answers), datasets' attitude (Chatterjee and Price 1977), both as
covariances only; the others are our own samples.
"""

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import multivariate_normal, norm

from survey.analysis import (
    adequacy_of,
    correlate,
    minimum_average_partial,
    omega_of,
    polychoric,
    principal_components,
    reliability,
    reliability_of,
)
from survey.analysis.components import eigenvalues
from survey.demonstration import drawn_sample, sample_file
from survey.scores import read_scores

RECORDED = json.loads((Path(__file__).parent / "recorded" / "psych.json").read_text("utf-8"))
SETS = RECORDED["data_sets"]
OURS = {
    "exact-20x10": lambda: read_scores(sample_file("exact-20")).scores[:, :10],
    "likert-20x12": lambda: read_scores(sample_file("likert-20")).scores,
    "likert-200x12": lambda: drawn_sample(200, seed=200),
    "likert-1000x8": lambda: drawn_sample(1000, seed=1000)[:, :8],
}


def correlation(told):
    covariance = np.array(told["covariance"])
    spread = np.sqrt(np.diag(covariance))
    r = covariance / np.outer(spread, spread)
    np.fill_diagonal(r, 1.0)
    return r, covariance, spread


def apart(mine, theirs):
    return np.abs(np.asarray(mine, dtype=float) - np.asarray(theirs, dtype=float)).max()


def matched(theirs, mine):
    across = mine.T @ theirs
    column = np.abs(across).argmax(axis=1)
    return theirs[:, column] * np.sign(across[np.arange(len(column)), column])


def test_the_record_names_its_makers_and_five_sets_of_different_size():
    assert RECORDED["psych"] == "2.2.9"
    assert RECORDED["R"].startswith("R version")
    assert len({(told["n"], told["p"]) for told in SETS.values()}) >= 5


@pytest.mark.parametrize("name", OURS)
def test_correlations_probabilities_and_alpha_from_the_scores(name):
    told, table = SETS[name], OURS[name]()
    found = correlate(table)
    assert apart(found.r, told["r"]) < 1e-10
    assert apart(found.p, told["probability"]) < 1e-10
    assert apart(reliability(table).alpha, told["alpha"]) < 1e-10


@pytest.mark.parametrize("name", SETS)
def test_kmo_bartlett_eigenvalues_alpha_and_map_are_psych_s(name):
    told = SETS[name]
    r, covariance, _ = correlation(told)
    fit, reliable = adequacy_of(r, told["n"], told["names"]), reliability_of(covariance, told["names"])
    assert apart(fit.kmo, told["kmo"]) < 1e-10
    assert apart(fit.kmo_per_item, told["kmo_per_item"]) < 1e-10
    assert apart(fit.bartlett.chi2, told["chi2"]) < 1e-10 * max(1.0, told["chi2"])
    assert fit.bartlett.df == told["df"]
    assert apart(fit.bartlett.p, told["bartlett_p"]) < 1e-10
    assert apart(eigenvalues(r), told["eigenvalues"]) < 1e-10
    assert apart(reliable.alpha, told["alpha"]) < 1e-10
    assert apart(reliable.standardised, told["alpha_standardised"]) < 1e-10
    assert apart(reliable.if_deleted, told["alpha_if_deleted"]) < 1e-10
    average = minimum_average_partial(r).squared[1 : len(told["map"]) + 1]
    assert apart(average, told["map"][: len(average)]) < 1e-10


@pytest.mark.parametrize("name", SETS)
def test_rotations_are_gparotation_s_where_it_goes_to_the_end_and_psych_s_where_it_stops(name):
    told = SETS[name]
    r, _, _ = correlation(told)
    keep = len(told["unrotated"][0])
    found = principal_components(r, keep=keep)
    assert apart(matched(np.array(told["varimax"]), found.loadings), found.loadings) < 1e-6
    early = apart(matched(np.array(told["varimax_psych"]), found.loadings), found.loadings)
    assert 1e-6 < early < 1e-2
    oblique = principal_components(r, keep=keep, rotation="oblimin").loadings
    assert apart(matched(np.array(told["oblimin"]["loadings"]), oblique), oblique) < 1e-6


@pytest.mark.parametrize("name", SETS)
def test_omega_is_that_of_factanal_s_one_factor(name):
    told = SETS[name]
    r, _, spread = correlation(told)
    assert omega_of(r, spread, told["n"], told["names"]).omega == pytest.approx(told["omega"], abs=1e-6)


@pytest.mark.parametrize("name", ["likert-200x12", "likert-1000x8"])
def test_polychoric_is_psych_s_to_its_tolerance(name):
    assert apart(polychoric(OURS[name]()).r, SETS[name]["polychoric"]) < 5e-5


def log_likelihood(x, y, rho: float) -> float:
    """Of two scales' table of frequencies, thresholds from their own; by SciPy's bivariate normal."""
    cuts = [
        [-9.0, *norm.ppf([(column <= level).mean() for level in np.unique(column)[:-1]]), 9.0]
        for column in (x, y)
    ]
    # SciPy's annotation is that of the default alone.
    pair = multivariate_normal([0, 0], [[1, rho], [rho, 1]])  # pyright: ignore[reportArgumentType]
    corners = np.array([[pair.cdf([a, b]) for b in cuts[1]] for a in cuts[0]])
    cells = np.diff(np.diff(corners, axis=0), axis=1)
    codes = [np.unique(column, return_inverse=True)[1] for column in (x, y)]
    return float(np.log(cells[codes[0], codes[1]]).sum())


def test_where_few_answers_set_psych_apart_ours_is_the_likelier():
    table = OURS["likert-20x12"]()
    ours, theirs = polychoric(table).r, np.array(SETS["likert-20x12"]["polychoric"])
    apart_most = np.argsort(-np.abs(ours - theirs), axis=None)[:8:2]
    for i, j in zip(*np.unravel_index(apart_most, ours.shape), strict=True):
        x, y = table[:, i], table[:, j]
        mine, other = float(ours[i, j]), float(theirs[i, j])
        assert log_likelihood(x, y, mine) > log_likelihood(x, y, other) + 1e-3
