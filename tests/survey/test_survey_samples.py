"""The synthetic samples are what they claim to be, on every machine; the files are data, the recipe their origin."""

import csv
import os
import subprocess
import sys

import numpy as np
import pytest
from survey_samples import CHI2, KMO, TABLE_3, TABLE_3_ITEMS, given

from survey.analysis import Settings, analyse
from survey.demonstration import (
    ITEMS,
    SAMPLES,
    N,
    annealed_sample,
    correlation_of_ten,
    correlation_of_twelve,
    deviations,
    drawn_opinions,
    drawn_sample,
    exact_sample,
    gappy,
    kmo_of,
    sample_file,
    solved_population,
    with_moments,
)
from survey.scores import read_scores

STATIC = ("static_overall", "static_drape")


def scores_in(name):
    table = read_scores(sample_file(name))
    return table.scores, table.items


@pytest.mark.parametrize("population", [correlation_of_ten, solved_population], ids=["shipped", "solved"])
def test_the_population_has_the_printed_figures_and_table_3_as_its_component_space(population):
    r = population()
    p = len(r)
    assert (np.diag(r) == 1).all()
    assert np.abs(r - r.T).max() < 1e-12
    assert np.linalg.eigvalsh(r).min() > 0
    assert abs(kmo_of(r) - KMO) < 1e-9
    assert abs(-(N - 1 - (2 * p + 5) / 6) * np.linalg.slogdet(r)[1] - CHI2) < 1e-7
    # ΛΛᵀ is the part of R within the space of Λ, so the residual does not reach into it.
    assert np.abs(TABLE_3.T @ (r - TABLE_3 @ TABLE_3.T)).max() < 1e-9


def test_a_sample_with_given_moments_has_exactly_these():
    r = correlation_of_ten()
    sample = with_moments(r, N, seed=5)
    assert np.abs(np.corrcoef(sample, rowvar=False) - r).max() < 1e-12
    assert np.abs(sample.mean(axis=0)).max() < 1e-14


def test_the_exact_file_has_the_paper_s_kmo_bartlett_and_alpha():
    found = analyse(*scores_in("exact-20"), drop=STATIC)
    assert found.n == 20
    assert given(found.adequacy).kmo == pytest.approx(0.824, abs=1e-9)
    assert given(found.adequacy).bartlett.chi2 == pytest.approx(167.23, abs=1e-7)
    assert given(found.adequacy).bartlett.df == 45
    assert given(found.components).kept == 3
    assert given(found.reliability).alpha == pytest.approx(0.911, abs=1e-9)


@pytest.mark.parametrize("name", ["exact-20", "likert-20"])
def test_twenty_rows_lead_the_paper_s_way(name):
    scores, items = scores_in(name)
    found = analyse(scores, items, drop=STATIC)
    pairs = {frozenset(note.items) for note in found.notes if note.code == "close_pair"}
    # Exactly the two pairs of the paper are proposed, and both are settled by dropping the static ones.
    assert pairs == {
        frozenset(("silhouette", "static_overall")),
        frozenset(("dynamic_drape", "static_drape")),
    }
    assert given(found.components).kept == 3
    order = [found.factored.index(item) for item in TABLE_3_ITEMS]
    loadings = given(found.components).loadings[order]
    assert np.abs(loadings - TABLE_3).max() < 0.05
    assert (loadings.argmax(axis=1) == TABLE_3.argmax(axis=1)).all()
    total = given(found.components).eigenvalues[:3].sum()
    assert given(found.components).rotated.sum() == pytest.approx(total, abs=1e-10)


def annealed_here():
    return annealed_sample(), ITEMS


@pytest.mark.nightly
@pytest.mark.parametrize(
    "sample",
    [
        pytest.param(lambda: scores_in("likert-20"), id="file"),
        pytest.param(annealed_here, id="annealed here", marks=pytest.mark.slow),
    ],
)
def test_annealing_leads_to_whole_scores_close_to_the_paper(sample):
    """The file, and what the recipe comes to here: another machine may end at another table, none the worse."""
    scores, items = sample()
    assert scores.shape == (20, 12)
    assert set(np.unique(scores)) <= {1, 2, 3, 4, 5}
    found = analyse(scores, items, drop=STATIC)
    assert given(found.adequacy).kmo == pytest.approx(0.824, abs=0.005)
    assert given(found.adequacy).bartlett.chi2 == pytest.approx(167.23, abs=2)
    at = [items.index(item) for item in ("static_overall", "silhouette", "static_drape", "dynamic_drape")]
    assert given(found.correlation).r[at[0], at[1]] >= 0.93
    assert given(found.correlation).r[at[2], at[3]] >= 0.93


def test_the_exact_file_is_the_population_s_moments_and_nothing_else():
    scores, items = scores_in("exact-20")
    assert items == ITEMS
    assert np.abs(np.corrcoef(scores, rowvar=False) - correlation_of_twelve()).max() < 1e-12
    assert np.abs(scores.mean(axis=0) - 3).max() < 1e-12
    assert np.abs(scores.std(axis=0, ddof=1) - deviations()).max() < 1e-12


def test_the_files_are_what_the_recipe_makes():
    drawn = drawn_sample(200, seed=200)
    made = {"exact-20": exact_sample(), "likert-200": drawn, "likert-200-gaps": gappy(drawn, 0.05, seed=5)}
    for name, table in made.items():
        np.testing.assert_allclose(scores_in(name)[0], table, atol=1e-12)
    missing = np.isnan(scores_in("likert-200-gaps")[0]).mean()
    assert 0.03 < missing < 0.07


MADE_ANEW = """
import sys, numpy as np
from survey.demonstration import drawn_opinions, exact_sample
np.savez(sys.argv[1], exact=exact_sample(), drawn=drawn_opinions(200, 200))
"""


def test_the_recipe_comes_to_the_same_with_the_linear_algebra_of_the_oldest_processor(tmp_path):
    """Prescott: OpenBLAS without any vector unit beyond SSE3, in any x86-64; elsewhere the name means nothing."""
    env = os.environ | {"OPENBLAS_CORETYPE": "Prescott"}
    subprocess.run([sys.executable, "-c", MADE_ANEW, tmp_path / "anew.npz"], env=env, check=True)
    with np.load(tmp_path / "anew.npz") as anew:
        np.testing.assert_allclose(anew["exact"], scores_in("exact-20")[0], atol=1e-12)
        np.testing.assert_allclose(anew["drawn"], drawn_opinions(200, 200), atol=1e-12)


@pytest.mark.parametrize(("n", "seed"), [(200, 200), (1000, 1000)])
def test_no_drawn_opinion_is_so_near_to_two_scores_that_rounding_decides(n, seed):
    opinions = drawn_opinions(n, seed)
    assert np.abs(opinions % 1 - 0.5).min() > 1e-9


def test_every_sample_calls_itself_synthetic_and_lists_no_person():
    for name, texts in SAMPLES.items():
        assert texts[0].startswith("合成")
        assert texts[1].startswith("synthetic")
        with sample_file(name).open(encoding="utf-8-sig", newline="") as file:
            assert all(row["submission"].startswith("synthetic-") for row in csv.DictReader(file))


def test_pairwise_and_listwise_agree_with_the_full_sample_within_its_chance():
    full = analyse(*scores_in("likert-200"), drop=STATIC)
    for missing in ("listwise", "pairwise"):
        part = analyse(*scores_in("likert-200-gaps"), settings=Settings(drop=STATIC, missing=missing))
        assert given(part.components).kept == given(full.components).kept
        # Two components explain nearly the same, so their order is a matter of chance: match them by their items.
        match = np.abs(given(part.components).loadings.T @ given(full.components).loadings).argmax(axis=0)
        assert np.abs(given(part.components).loadings[:, match] - given(full.components).loadings).max() < 0.2
        assert given(part.adequacy).kmo == pytest.approx(given(full.adequacy).kmo, abs=0.05)
