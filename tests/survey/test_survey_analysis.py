"""The statistics: against the paper's consistent figures, against factor_analyzer, and in every hard case."""

from __future__ import annotations

import json
import re
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.stats
from survey_samples import ALPHA, CHI2, KMO, TABLE_3, TABLE_3_ITEMS, given, likert_sample, paper_sample

import survey.analysis
from survey.analysis import (
    AllEqual,
    AnalysisError,
    ConstantItem,
    DependentItems,
    NoComponents,
    NotFinite,
    Settings,
    TooFewRows,
    UnknownItem,
    adequacy,
    adequacy_by_factor_analyzer,
    analyse,
    correlate,
    principal_components,
    reliability,
    varimax,
)
from survey.analysis.procedure import KEYS, descriptives, summary
from survey.report import Words

STATIC = ("static_drape", "static_overall")


@pytest.fixture(scope="module")
def paper():
    return analyse(*paper_sample(), drop=STATIC)


def test_the_paper_s_sample_gives_the_paper_s_consistent_figures(paper):
    assert paper.n == 20
    assert paper.dropped == ("static_overall", "static_drape")
    assert paper.adequacy.kmo == pytest.approx(KMO, abs=1e-8)
    assert paper.adequacy.bartlett.chi2 == pytest.approx(CHI2, abs=1e-6)
    assert paper.adequacy.bartlett.df == 45  # the paper prints 48, which is no p (p − 1) / 2
    assert paper.reliability.alpha == pytest.approx(ALPHA, abs=1e-9)
    assert paper.components.kept == 3
    assert 100 * paper.components.rotated.sum() / 10 == pytest.approx(85.33, abs=0.005)


def test_the_close_pairs_are_proposed_for_removal_with_three_decimals(paper):
    pairs = {frozenset(note.items) for note in paper.notes if note.code == "close_pair"}
    assert pairs == {
        frozenset(("silhouette", "static_overall")),
        frozenset(("dynamic_drape", "static_drape")),
    }


def test_the_rotated_loadings_group_and_measure_as_table_3(paper):
    order = [paper.factored.index(item) for item in TABLE_3_ITEMS]
    loadings = paper.components.loadings[order]
    # Table 3 itself is not stationary: Kaiser's varimax moves it by up to .039.
    assert np.abs(loadings - TABLE_3).max() < 0.05
    assert (np.abs(loadings).argmax(axis=1) == [0, 0, 0, 0, 1, 1, 1, 1, 2, 2]).all()


def test_rotation_keeps_the_total_and_eigenvalues_sum_to_the_number_of_items(paper):
    found = paper.components
    assert found.rotated.sum() == pytest.approx(found.eigenvalues[:3].sum(), abs=1e-10)
    assert found.eigenvalues.sum() == pytest.approx(10.0, abs=1e-10)
    assert np.abs((found.unrotated**2).sum(axis=1) - found.communalities).max() < 1e-12


@pytest.mark.parametrize(("n", "seed"), [(20, 1), (50, 2), (200, 3), (1000, 4)])
def test_factor_analyzer_works_with_the_installed_scikit_learn_and_agrees(n, seed):
    table = likert_sample(n, seed)
    theirs, ours = adequacy_by_factor_analyzer(table), adequacy(table)
    assert theirs.kmo == pytest.approx(ours.kmo, abs=1e-10)
    assert np.abs(theirs.kmo_per_item - ours.kmo_per_item).max() < 1e-10
    assert theirs.bartlett.chi2 == pytest.approx(ours.bartlett.chi2, rel=1e-10)
    assert theirs.bartlett.p == pytest.approx(ours.bartlett.p, rel=1e-10)


def test_factor_analyzer_s_own_fit_runs_and_its_loadings_are_ours_up_to_its_early_stop():
    import sklearn

    assert tuple(int(part) for part in sklearn.__version__.split(".")[:2]) < (1, 8)
    from factor_analyzer import FactorAnalyzer, Rotator

    table = likert_sample(200, 8)
    found = principal_components(correlate(table).r, keep=3)
    unturned: dict[str, Any] = {"rotation": None}  # its annotations know no None, which it takes
    fit: Any = FactorAnalyzer(n_factors=3, method="principal", **unturned)
    with warnings.catch_warnings():
        # scikit-learn 1.6–1.7 announces that `force_all_finite`, which factor_analyzer passes, is renamed.
        warnings.filterwarnings("ignore", message=".*force_all_finite.*", category=FutureWarning)
        fit.fit(table)
    theirs = fit.loadings_
    assert np.abs(fit.get_eigenvalues()[0] - found.eigenvalues).max() < 1e-10
    assert np.abs(np.abs(theirs) - np.abs(found.unrotated)).max() < 1e-10
    turned = Rotator(method="varimax").fit_transform(theirs)
    best = np.abs(turned.T @ found.loadings).argmax(axis=0)
    assert np.abs(np.abs(turned[:, best]) - np.abs(found.loadings)).max() < 2e-3


def test_correlations_and_their_probabilities_are_scipy_s():
    table = likert_sample(30, 4)
    found = correlate(table)
    for i in range(10):
        for j in range(i):
            r, p = scipy.stats.pearsonr(table[:, i], table[:, j])
            assert found.r[i, j] == pytest.approx(r, abs=1e-14)
            assert found.p[i, j] == pytest.approx(p, rel=1e-9)


def test_alpha_is_the_mean_split_half():
    # α equals the mean of all split-half coefficients (Cronbach 1951); four items have three splits.
    table = likert_sample(60, 5)[:, :4]
    halves = []
    for pair in ((0, 1), (0, 2), (0, 3)):
        one = table[:, pair].sum(axis=1)
        other = table.sum(axis=1) - one
        halves.append(4 * np.cov(one, other)[0, 1] / table.sum(axis=1).var(ddof=1))
    assert reliability(table).alpha == pytest.approx(np.mean(halves), abs=1e-13)


def kaiser_criterion(loadings):
    unit = loadings / np.sqrt((loadings**2).sum(axis=1, keepdims=True))
    return float((unit**2).var(axis=0).sum())


def test_varimax_is_a_maximum_that_no_rotation_exceeds():
    rng = np.random.default_rng(0)
    start = principal_components(correlate(likert_sample(100, 6)).r, keep=3).unrotated
    best = varimax(start)
    highest = kaiser_criterion(best)
    for size in (1e-4, 1e-2, 1.0):
        for _ in range(200):
            turn = (
                scipy.stats.special_ortho_group.rvs(3, random_state=rng) if size == 1.0 else _small(rng, size)
            )
            assert kaiser_criterion(best @ turn) <= highest + 1e-13


def _small(rng, size):
    skew = rng.normal(size=(3, 3)) * size
    return scipy.linalg.expm(skew - skew.T)


def test_varimax_does_not_depend_on_where_it_starts_nor_on_signs():
    rng = np.random.default_rng(1)
    start = principal_components(correlate(likert_sample(100, 6)).r, keep=3).unrotated
    for _ in range(10):
        turned = start @ scipy.stats.special_ortho_group.rvs(3, random_state=rng) * [1, -1, 1]
        assert np.abs(varimax(turned) - varimax(start)).max() < 1e-10
    assert (varimax(start).sum(axis=0) >= 0).all()
    squares = (varimax(start) ** 2).sum(axis=0)
    assert (np.diff(squares) <= 0).all()


# ---- hard cases: a typed error or a note, no NaN, no numpy warning (pytest turns warnings into errors) ----------


def as_strict_json(found) -> dict:
    told = json.loads(json.dumps(summary(found), allow_nan=False))
    assert tuple(told) == KEYS
    json.dumps(descriptives(found), allow_nan=False)
    return told


def mean_of(found, item) -> float:
    return {row["item"]: row["mean"] for row in descriptives(found)}[item]


def codes(found) -> set[str]:
    return {note.code for note in found.notes}


def test_a_duplicated_item_is_named_and_only_stops_kmo_and_bartlett():
    table = np.column_stack([likert_sample(40, 1), likert_sample(40, 1)[:, 2]])
    with pytest.raises(DependentItems, match="item_3, item_11") as caught:
        adequacy(table)
    assert caught.value.items == ("item_3", "item_11")
    found = analyse(table)
    assert "dependent_items" in codes(found)
    assert found.adequacy is None
    assert found.components is not None
    assert as_strict_json(found)["kmo"] is None


def test_an_item_that_is_the_sum_of_two_others_is_dependent_too():
    table = likert_sample(40, 1)
    table = np.column_stack([table, table[:, 0] + table[:, 1]])
    with pytest.raises(DependentItems) as caught:
        adequacy(table)
    assert set(caught.value.items) == {"item_1", "item_2", "item_11"}


def test_a_constant_item_stays_in_the_means_and_leaves_the_rest():
    table = likert_sample(40, 1)
    table[:, 3] = 4
    with pytest.raises(ConstantItem, match="item_4"):
        correlate(table)
    found = analyse(table)
    assert "constant_item" in codes(found)
    assert "item_4" not in found.factored
    assert mean_of(found, "item_4") == 4.0


@pytest.mark.parametrize("n", [3, 9, 10])
def test_no_more_rows_than_items_gives_means_and_no_factors(n):
    table = likert_sample(n, 12)
    with pytest.raises((TooFewRows, ConstantItem)):
        adequacy(table)
    found = analyse(table)
    assert "too_few_rows" in codes(found)
    assert found.adequacy is None
    assert found.components is None
    assert as_strict_json(found)["kmo"] is None
    assert mean_of(found, "item_1") == pytest.approx(table[:, 0].mean())


def test_one_row_more_than_items_gives_a_result_with_a_warning():
    found = analyse(likert_sample(11, 3))
    assert {"barely_enough_rows", "small_sample"} <= codes(found)
    assert found.adequacy is not None


@pytest.mark.parametrize("rows", [0, 1])
def test_one_row_or_none_is_refused(rows):
    with pytest.raises(TooFewRows):
        analyse(np.full((rows, 10), 3.0))
    with pytest.raises(TooFewRows):
        reliability(np.full((rows, 10), 3.0))


def test_two_rows_are_described_without_correlation():
    found = analyse(np.array([[1.0, 2, 3], [3, 5, 4]]))
    assert found.correlation is None
    assert mean_of(found, "item_1") == 2.0


def test_all_answers_equal_are_refused_by_name_of_the_trouble():
    for function in (analyse, correlate, reliability):
        with pytest.raises(AllEqual):
            function(np.full((30, 10), 4.0))


def test_missing_scores_leave_whole_answers_out_and_say_so():
    table = likert_sample(60, 2)
    holes = table.copy()
    holes[[4, 9], [0, 7]] = np.nan
    found = analyse(holes)
    assert found.n == 58
    assert "missing" in codes(found)
    assert found.answered.tolist() == [59, 60, 60, 60, 60, 60, 60, 59, 60, 60]
    complete = analyse(np.delete(table, [4, 9], axis=0))
    assert given(found.adequacy).kmo == given(complete.adequacy).kmo
    with pytest.raises(NotFinite, match="item_1, item_8"):
        correlate(holes)


@pytest.mark.parametrize(("value", "says"), [(np.nan, "no scores at all"), (np.inf, "infinite")])
def test_an_empty_or_infinite_column_is_named(value, says):
    table = likert_sample(30, 2)
    table[:, 5] = value
    with pytest.raises(NotFinite, match=f"item_6: {says}"):
        analyse(table)


@pytest.mark.parametrize("factor", [1e300, 1e-300])
def test_scores_that_no_scale_has_are_named_before_they_overflow(factor):
    table = likert_sample(30, 2)
    table[:, 5] *= factor
    with pytest.raises(NotFinite, match="item_6: scores beyond"):
        analyse(table)


def test_items_without_any_correlation_have_no_component():
    table = np.array([[a, b, c] for a in (1, 5) for b in (1, 5) for c in (1, 5)], dtype=float)
    with pytest.raises(NoComponents, match="no eigenvalue above 1"):
        principal_components(correlate(table).r)
    found = as_strict_json(analyse(table))
    assert found["loadings"] is None
    assert found["eigenvalues"] == pytest.approx([1.0, 1.0, 1.0])
    assert found["alpha"] == pytest.approx(0.0, abs=1e-12)


def test_opposed_items_whose_sum_never_varies_have_no_alpha():
    table = np.array([[1.0, 5], [2, 4], [5, 1], [3, 3]])
    with pytest.raises(AllEqual, match="do not vary"):
        reliability(table)


def test_a_single_item_is_described_and_not_factored():
    found = analyse(np.array([[1.0], [2], [4]]))
    assert "too_few_items" in codes(found)
    assert as_strict_json(found)["alpha"] is None


def test_an_unknown_item_to_drop_is_an_error():
    with pytest.raises(UnknownItem, match="nonsense: no such item"):
        analyse(likert_sample(30, 1), drop=("nonsense",))


def test_every_kind_of_failure_has_a_code_of_its_own():
    kinds = AnalysisError.__subclasses__()
    assert len({kind.code for kind in kinds}) == len(kinds) > 14
    modules = Path(survey.analysis.__file__).parent.glob("*.py")
    assert not [path.name for path in modules if "raise AnalysisError" in path.read_text("utf-8")]


def test_a_warning_s_code_tells_what_failed():
    gaps, alone = likert_sample(40, 2), likert_sample(40, 2)[:, :2]
    gaps[3, 1] = np.nan
    square = np.array([[a, b, c] for a in (1, 5) for b in (1, 5) for c in (1, 5)], dtype=float)
    told = {
        "gaps_left": analyse(gaps, settings=Settings(method="polychoric", missing="pairwise")),
        "too_many_scores": analyse(
            np.random.default_rng(1).normal(size=(50, 3)), settings=Settings(method="polychoric")
        ),
        "no_components": analyse(alone, settings=Settings(factors=5)),
        "too_few_items": analyse(alone),
        "lone_item": analyse(square),
    }
    for code, found in told.items():
        assert code in codes(found)
        (note,) = [note for note in found.notes if note.code == code]
        assert "analysis" not in codes(found)
        assert re.search("[\u4e00-\u9fff]", Words("zh", None).note(note))
