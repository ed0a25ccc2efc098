"""What the paper lacks: retention, bootstrap, ω, oblimin, polychoric, gaps, flags, GRIM."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
import scipy.integrate
import scipy.special
import scipy.stats
from survey_samples import given, likert_sample, paper_sample

from survey.analysis import (
    AllEqual,
    ConstantItem,
    Context,
    NotAMean,
    NotPositiveDefinite,
    Settings,
    TooFewItems,
    TooFewRows,
    TooManyScores,
    adequacy_of,
    analyse,
    bootstrap,
    correlate,
    correlate_pairwise,
    duplicates,
    grim,
    hasty,
    least_n,
    minimum_average_partial,
    oblimin,
    omega_of,
    parallel_analysis,
    polychoric,
    principal_components,
    reliability,
    straight_liners,
    varimax,
)
from survey.analysis.components import (
    STARTS,
    Rotation,
    quartimin_criterion,
    random_correlations,
    starts,
    varimax_criterion,
)
from survey.analysis.correlation import binormal

STATIC = ("static_overall", "static_drape")
PRINTED = "4.15 4.46 4.35 4.88 4.84 4.55 4.60 4.98 4.92 4.57 4.94 4.27 4.78".split()


def rng(seed=0):
    return np.random.default_rng(seed)


# ---- how many components ----------------------------------------------------------------------------------------


def test_random_correlations_are_distributed_as_those_of_simulated_tables():
    n, p, draws = 25, 6, 4000
    ours = np.linalg.eigvalsh(random_correlations(n, p, draws, rng(1)))
    tables = rng(2).normal(size=(draws, n, p))
    simulated = np.linalg.eigvalsh(np.array([np.corrcoef(table, rowvar=False) for table in tables]))
    for at in range(p):
        _, p = np.asarray(scipy.stats.ks_2samp(ours[:, at], simulated[:, at]))
        assert p > 1e-3


def test_parallel_analysis_finds_what_is_there_and_nothing_where_nothing_is():
    factors = np.kron(np.eye(3), np.ones((4, 1)))
    population = 0.64 * factors @ factors.T + 0.36 * np.eye(12)
    table = rng(3).normal(size=(300, 12)) @ np.linalg.cholesky(population).T
    found = parallel_analysis(correlate(table).r, 300, rng(4))
    assert (found.kept, found.factors_kept) == (3, 3)
    noise = rng(5).normal(size=(300, 12))
    assert parallel_analysis(correlate(noise).r, 300, rng(4)).kept <= 1
    assert minimum_average_partial(correlate(table).r).kept == 3
    assert minimum_average_partial(correlate(noise).r).kept == 0


def test_parallel_analysis_is_the_same_for_the_same_seed_and_needs_rows():
    r = correlate(likert_sample(60, 1)).r
    one, two = parallel_analysis(r, 60, rng(7)), parallel_analysis(r, 60, rng(7))
    assert (one.upper == two.upper).all()
    assert (one.upper > one.mean).all()
    with pytest.raises(TooFewRows):
        parallel_analysis(r, 10, rng(7))


def test_the_paper_s_sample_shows_how_the_criteria_disagree():
    found = analyse(*paper_sample(), drop=STATIC)
    assert (given(found.components).kept, given(found.parallel).kept, given(found.average).kept) == (3, 1, 4)
    (note,) = [note for note in found.notes if note.code == "retention"]
    assert "Kaiser 3, MAP 4, parallel analysis 1" in note.message


def test_the_number_of_components_may_come_from_parallel_analysis_or_a_number():
    table = likert_sample(200, 2)
    few = analyse(table, settings=Settings(factors="parallel"))
    assert given(few.components).kept == given(few.parallel).kept < given(analyse(table).components).kept
    assert given(analyse(table, settings=Settings(factors=2)).components).kept == 2
    over = analyse(table, settings=Settings(factors=11))
    assert over.components is None
    assert any("11 components of 10 items" in note.message for note in over.notes)


# ---- bootstrap --------------------------------------------------------------------------------------------------


def resampled(table, seed=0, draws=1000, rotation: Rotation = "varimax"):
    components = principal_components(correlate(table).r, keep=3, rotation=rotation)
    return components, bootstrap(table, np.ones(table.shape[1], bool), components, rng(seed), draws=draws)


def test_bootstrap_intervals_hold_the_figures_and_shrink_with_root_n():
    widths = []
    for n in (100, 400):
        table = likert_sample(n, 3)
        components, found = resampled(table)
        low, high = given(found.loadings)
        assert (low < components.loadings + 0.02).all()
        assert (high > components.loadings - 0.02).all()
        alpha = reliability(table).alpha
        low, high = given(found.alpha)
        assert low < alpha < high
        assert (found.means[0] < table.mean(axis=0)).all()
        assert (found.means[1] > table.mean(axis=0)).all()
        assert given(found.kaiser).sum() == pytest.approx(1.0)
        widths.append(np.median(np.diff(given(found.loadings), axis=0)))
    assert 1.6 < widths[0] / widths[1] < 2.6


def test_bootstrap_means_are_as_wide_as_the_normal_interval():
    table = likert_sample(200, 4)
    _, found = resampled(table, draws=4000)
    normal = 1.96 * table.std(axis=0, ddof=1) / np.sqrt(200)
    assert np.abs((found.means[1] - found.means[0]) / 2 / normal - 1).max() < 0.08


def plainly(table, draws, seed=0):
    """Means, α, eigenvalues and Kaiser's number of tables that are really resampled: draws × …"""
    generator, found = rng(seed), []
    for _ in range(draws):
        sample = table[generator.integers(0, len(table), len(table))]
        values = np.linalg.eigvalsh(np.corrcoef(sample, rowvar=False))[::-1]
        found.append([*sample.mean(axis=0), reliability(sample).alpha, *values])
    return np.array(found)


@pytest.mark.nightly
@pytest.mark.parametrize("n", [60, 9000])
def test_resamples_are_distributed_as_tables_drawn_row_by_row(n):
    # 9000 answers are drawn in several blocks; in order these differ, so that how many fall into each one matters.
    table = likert_sample(n, 11)[:, :6]
    table = table[np.argsort(table.sum(axis=1))]
    _, found = resampled(table, draws=3000)
    ours = np.hstack([found.means, given(found.alpha)[:, None], given(found.eigenvalues)])
    theirs = np.quantile(plainly(table, 1500), [0.025, 0.975], axis=0)
    width = theirs[1] - theirs[0]
    assert np.abs((ours - theirs) / width).max() < 0.12
    assert np.abs((ours[1] - ours[0]) / width - 1).max() < 0.12


def test_whole_scores_and_the_same_on_a_broken_scale_give_the_same_intervals():
    # Whole scores are added in single precision: nothing may be lost by it.
    table = likert_sample(9000, 12)
    _, whole = resampled(table, draws=300)
    _, broken = resampled(table / 7 + 0.1, draws=300)
    assert broken.means == pytest.approx(whole.means / 7 + 0.1, abs=1e-12)
    for name in ("alpha", "eigenvalues", "loadings", "kaiser"):
        assert given(getattr(broken, name)) == pytest.approx(given(getattr(whole, name)), abs=1e-10)


def test_dropped_items_and_gaps_beside_them_leave_the_others_as_they_are():
    table, factored = likert_sample(400, 13), np.arange(10) > 1
    _, bare = resampled(table[:, 2:], draws=2000)
    beside = bootstrap(table, factored, None, rng(3), draws=2000)
    table[::3, 0] = np.nan
    gaps = bootstrap(table, factored, None, rng(4), draws=2000)
    width = np.diff(given(bare.alpha))[0]
    for found in (beside, gaps):
        assert np.abs(given(found.alpha) - given(bare.alpha)).max() < 0.15 * width
        assert found.means.shape == (2, 10)
        assert found.used == 2000


@pytest.mark.parametrize("middle", [3.0, 1000.3, 1e6 + 0.1])
def test_an_item_that_stands_still_far_from_zero_is_seen(middle):
    table = likert_sample(12, 7)
    table[:, 0] = middle
    table[0, 0] = middle + 40.2
    found = bootstrap(table, np.ones(10, bool), None, rng(1), draws=500)
    assert 0.55 < found.used / found.draws < 0.75


def test_progress_counts_every_resample():
    told = []
    bootstrap(likert_sample(30, 1), np.ones(10, bool), None, rng(1), draws=1700, progress=told.append)
    assert sum(told) == 1700


def test_procrustes_makes_resamples_comparable_where_bare_varimax_swaps_columns():
    table = likert_sample(100, 5)
    components, found = resampled(table, draws=300)
    draws = []
    generator = rng(9)
    for _ in range(100):
        rows = generator.integers(0, 100, 100)
        draws.append(principal_components(correlate(table[rows]).r, keep=3).loadings)
    bare = np.quantile(draws, [0.025, 0.975], axis=0)
    assert np.median(np.diff(given(found.loadings), axis=0)) < np.median(bare[1] - bare[0])


def test_oblique_loadings_are_resampled_too():
    components, found = resampled(likert_sample(300, 6), draws=200, rotation="oblimin")
    assert np.abs(given(found.loadings).mean(axis=0) - components.loadings).max() < 0.1


def test_samples_in_which_an_item_stands_still_are_counted_out():
    table = likert_sample(12, 7)
    table[:, 0] = 3
    table[0, 0] = 4
    found = bootstrap(table, np.ones(10, bool), None, rng(1), draws=500)
    # The single different score is missing from (11/12)^12 = 35 % of the samples.
    assert 0.55 < found.used / found.draws < 0.75
    assert found.alpha is not None


def test_the_intervals_of_the_means_rest_on_all_scores_and_those_of_alpha_on_whole_answers():
    table = likert_sample(300, 8)
    # Whoever skips an item gave it a low score: the mean of the whole answers lies elsewhere.
    table[:150, 3] = 1
    table[:150, 7] = np.nan
    found = bootstrap(table, np.ones(10, bool), None, rng(2), draws=500)
    for item in range(10):
        assert found.means[0, item] < np.nanmean(table[:, item]) < found.means[1, item]
    assert found.means[1, 3] < table[150:, 3].mean()
    low, high = given(found.alpha)
    assert low < reliability(table[150:]).alpha < high
    assert bootstrap(table, np.zeros(10, bool), None, rng(2), draws=50).alpha is None
    table[:, 4] = np.nan
    assert np.isnan(bootstrap(table, np.ones(10, bool), None, rng(2), draws=50).means[:, 4]).all()


# ---- rotations --------------------------------------------------------------------------------------------------


@pytest.mark.nightly
def test_several_starts_find_the_higher_of_two_maxima():
    # With many components the criterion has several maxima; a single start sometimes ends in a lower one.
    lower = 0
    for seed in range(3):
        start = rng(seed).normal(size=(20, 10))
        best = varimax_criterion(varimax(start, normalise=False))
        for turn in range(6):
            rotation = scipy.stats.special_ortho_group.rvs(10, random_state=rng(1000 + turn))
            other = varimax_criterion(varimax(start @ rotation, normalise=False, attempts=1))
            lower += other < best - 1e-6
    assert lower > 0


@pytest.mark.nightly
def test_the_best_end_of_all_starts_is_taken():
    first = []
    for seed in range(3):
        loadings = rng(seed).normal(size=(20, 10))
        ends = [
            varimax_criterion(varimax(loadings @ turn, normalise=False, attempts=1))
            for turn in starts(10, STARTS)
        ]
        assert varimax_criterion(varimax(loadings, normalise=False)) == pytest.approx(max(ends), abs=1e-9)
        first.append(max(ends) - ends[0])
    assert max(first) > 1e-4  # or the first start would have done


def test_oblimin_is_a_minimum_that_no_small_turn_undercuts_and_keeps_the_communalities():
    start = principal_components(correlate(likert_sample(200, 8)).r, keep=3, rotation="none").unrotated
    pattern, correlation = oblimin(start)
    assert np.abs(np.diag(correlation) - 1).max() < 1e-12
    assert np.abs((pattern @ correlation @ pattern.T) - start @ start.T).max() < 1e-10
    length = np.sqrt((start**2).sum(axis=1, keepdims=True))
    least = quartimin_criterion(pattern / length)
    root = np.linalg.cholesky(correlation).T
    for size in (1e-4, 1e-2):
        for seed in range(60):
            turn = root + size * rng(seed).normal(size=(3, 3))
            turn /= np.sqrt((turn**2).sum(axis=0))
            moved = pattern @ root.T @ np.linalg.inv(turn).T / length
            assert quartimin_criterion(moved) >= least - 1e-12


def test_oblimin_of_one_component_and_of_none():
    one = principal_components(correlate(likert_sample(50, 1)).r, keep=1, rotation="oblimin")
    assert (one.correlation == 1).all()
    none = principal_components(correlate(likert_sample(50, 1)).r, keep=3, rotation="none")
    assert (none.loadings == none.unrotated).all()


# ---- ω ----------------------------------------------------------------------------------------------------------


def test_omega_of_a_one_factor_population_is_its_formula_and_alpha_s_when_loadings_are_equal():
    loadings = np.array([0.9, 0.8, 0.7, 0.6, 0.5])
    r = np.outer(loadings, loadings)
    np.fill_diagonal(r, 1.0)
    found = omega_of(r, np.ones(5), 100, "abcde")
    assert np.abs(found.loadings - loadings).max() < 1e-5
    assert found.omega == pytest.approx(
        loadings.sum() ** 2 / (loadings.sum() ** 2 + (1 - loadings**2).sum()), 1e-6
    )
    equal = np.full((6, 6), 0.4) + 0.6 * np.eye(6)
    assert omega_of(equal, np.ones(6), 100, "abcdef").omega == pytest.approx(
        6 / 5 * (1 - 6 / equal.sum()), abs=1e-6
    )


def test_a_heywood_case_is_told():
    r = np.array([[1, 0.9, 0.9, 0.2], [0.9, 1, 0.7, 0.2], [0.9, 0.7, 1, 0.2], [0.2, 0.2, 0.2, 1]])
    white = np.linalg.svd(rng(1).normal(size=(40, 4)) - 0, full_matrices=False)[0]
    white -= white.mean(axis=0)
    white = np.linalg.qr(white)[0]
    table = white @ np.linalg.cholesky(r).T
    found = analyse(table)
    assert np.abs(given(found.correlation).r - r).max() < 1e-12
    (note,) = [note for note in found.notes if note.code == "heywood"]
    assert note.items == ("item_1",)


# ---- polychoric -------------------------------------------------------------------------------------------------


def test_the_binormal_integral_is_scipy_s():
    for rho in (-0.999, -0.7, 0.0, 0.3, 0.95, 0.999):
        for h, k in itertools.product([-2.0, -0.4, 0.0, 0.7, 2.5], [-1.5, -0.1, 0.7, 0.7001, 3.0]):
            ours = binormal(np.array(h), np.array(k), np.array(rho))

            def strip(x, k=k, rho=rho):
                return scipy.stats.norm.pdf(x) * scipy.special.ndtr((k - rho * x) / np.sqrt(1 - rho**2))

            # The step of the inner integral is where x = k / ρ.
            edges = sorted({-9.0, h, *([k / rho] if rho and -9 < k / rho < h else [])})
            theirs = sum(
                scipy.integrate.quad(strip, *ends, epsabs=1e-12, epsrel=1e-12, limit=400)[0]
                for ends in itertools.pairwise(edges)
            )
            assert abs(ours - theirs) < 1e-9, (h, k, rho)


def test_polychoric_undoes_the_rounding_to_a_scale():
    population = np.array([[1, 0.8, 0.3], [0.8, 1, -0.2], [0.3, -0.2, 1]])
    z = rng(11).normal(size=(40_000, 3)) @ np.linalg.cholesky(population).T
    scores = np.digitize(z, [-0.5, 0.4, 1.2])
    assert np.abs(polychoric(scores).r - population).max() < 0.02
    assert np.abs(correlate(scores).r - population).max() > 0.05


def test_polychoric_of_perfect_twins_ends_at_the_edge_and_of_many_values_is_refused():
    table = likert_sample(60, 3)[:, :3]
    twins = np.column_stack([table, table[:, 0]])
    assert polychoric(twins).r[0, 3] > 0.999
    with pytest.raises(TooManyScores, match="item_1: 30 different scores"):
        polychoric(rng(1).normal(size=(30, 3)))


# ---- gaps -------------------------------------------------------------------------------------------------------


def test_pairwise_uses_every_pair_and_is_pearson_without_gaps():
    table = likert_sample(50, 9)
    full, pairs = correlate(table), correlate_pairwise(table)
    assert np.abs(full.r - pairs.r).max() < 1e-14
    assert (pairs.counts == 50).all()
    table[:10, 0] = np.nan
    table[5:20, 1] = np.nan
    holes = correlate_pairwise(table)
    r, p = scipy.stats.pearsonr(table[20:, 0], table[20:, 1])
    assert holes.counts[0, 1] == 30
    assert holes.r[0, 1] == pytest.approx(r, abs=1e-14)
    assert holes.p[0, 1] == pytest.approx(p, rel=1e-9)


def test_alpha_is_of_the_raw_scores_whatever_is_factored():
    table = likert_sample(80, 4)
    plain = given(analyse(table).reliability).alpha
    for missing in ("listwise", "pairwise"):
        found = analyse(table, settings=Settings(method="polychoric", missing=missing))
        assert given(found.reliability).alpha == pytest.approx(plain, abs=1e-12)


def test_polychoric_with_gaps_asks_for_whole_answers_and_says_nothing_false():
    table = likert_sample(80, 4)
    table[::9, 2] = np.nan
    found = analyse(table, settings=Settings(method="polychoric", missing="pairwise"))
    (told,) = [
        note for note in found.notes if note.code not in ("missing", "straight_line", "duplicate_answer")
    ]
    assert told.code == "gaps_left"
    assert "listwise" in told.message
    assert found.components is None
    assert (
        given(found.reliability).alpha
        == given(analyse(table, settings=Settings(missing="pairwise")).reliability).alpha
    )


def test_a_step_that_fails_with_answers_enough_does_not_tell_of_too_few():
    table = rng(3).normal(
        size=(100, 5)
    )  # a hundred different scores are no scale for polychoric correlations
    found = analyse(table, settings=Settings(method="polychoric"))
    assert [note.code for note in found.notes] == ["too_many_scores"]


def test_pairs_without_common_answers_or_variation_are_named():
    table = likert_sample(20, 9)[:, :3]
    table[:10, 0] = np.nan
    table[10:, 1] = np.nan
    with pytest.raises(TooFewRows, match="item_2 and item_1: 0 answers in common"):
        correlate_pairwise(table)
    table = likert_sample(20, 9)[:, :3]
    table[10:, 1] = np.nan
    table[:10, 0] = 3
    with pytest.raises(ConstantItem, match="item_2 and item_1"):
        correlate_pairwise(table)


def test_pairwise_correlations_that_contradict_each_other_are_refused_and_told():
    r = np.array([[1, 0.9, -0.9], [0.9, 1, 0.9], [-0.9, 0.9, 1]])
    with pytest.raises(NotPositiveDefinite, match="contradict"):
        adequacy_of(r, 50, "abc")
    x = rng(1).normal(size=90)
    table = np.full((90, 3), np.nan)
    table[:30, 0], table[:30, 1] = x[:30], x[:30]
    table[30:60, 1], table[30:60, 2] = x[30:60], x[30:60]
    table[60:, 0], table[60:, 2] = x[60:], -x[60:]
    found = analyse(table, settings=Settings(missing="pairwise"))
    assert "not_positive_definite" in {note.code for note in found.notes}
    assert found.adequacy is None


# ---- flags ------------------------------------------------------------------------------------------------------


def test_straight_lines_doubles_and_haste_are_named_and_nothing_is_deleted():
    table = likert_sample(60, 10)
    table[4] = 5
    table[9, :2] = np.nan
    table[9, 2:] = 3
    table[20] = table[30]
    table[40, 0] = table[41, 0] = np.nan
    table[41, 1:] = table[40, 1:]
    seconds = np.full(60, 90.0)
    seconds[[3, 9]] = [19.9, 15.9]
    seconds[40] = 18.1  # nine of ten items answered: two seconds for each of these
    seconds[50] = np.nan
    assert straight_liners(table).tolist() == [4, 9]
    assert [group.tolist() for group in duplicates(table)] == [[20, 30], [40, 41]]
    assert hasty(table, seconds).tolist() == [3, 9]
    found = analyse(table, context=Context(seconds=seconds))
    notes = {note.code: note.message for note in found.notes}
    assert "number 5, 10" in notes["straight_line"]
    assert "21 = 31; 41 = 42" in notes["duplicate_answer"]
    assert "number 4, 10" in notes["too_fast"]
    assert found.n == 60 - 3


def test_few_items_may_well_be_answered_alike():
    assert not len(straight_liners(np.full((5, 7), 3.0)))
    assert duplicates(np.tile([1.0, 2, 3, 4, 5], (6, 1))) == []


def test_an_item_against_the_others_is_named():
    table = likert_sample(80, 3)
    table[:, 2] = 6 - table[:, 2]
    (note,) = [note for note in analyse(table).notes if note.code == "reversed_item"]
    assert note.items == ("item_3",)


def test_an_empty_item_may_be_dropped():
    table = likert_sample(40, 3)
    table[:, 2] = np.nan
    found = analyse(table, drop=("item_3",))
    assert found.n == 40
    assert found.components is not None
    assert np.isnan(given(found.correlation).r[2]).all()


def test_gaps_in_a_dropped_item_cost_no_answer():
    table = likert_sample(40, 3)
    table[:15, 2] = np.nan
    assert analyse(table).n == 25
    assert analyse(table, drop=("item_3",)).n == 40


def test_dropping_everything_is_an_error():
    with pytest.raises(TooFewItems, match="every item is dropped"):
        analyse(likert_sample(40, 3)[:, :2], drop=("item_1", "item_2"))


def test_reliability_without_variation_of_the_sums():
    with pytest.raises(AllEqual):
        reliability(np.array([[1.0, 5], [2, 4], [5, 1]]))


# ---- GRIM -------------------------------------------------------------------------------------------------------


def test_grim_by_counting_every_sum():
    for n in (7, 20, 33):
        possible = {round(total / n + shift, 2) for total in range(n, 5 * n + 1) for shift in (1e-9, -1e-9)}
        for cents in range(100, 501):
            assert grim(f"{cents // 100}.{cents % 100:02d}", n) == (cents / 100 in possible)


def test_nine_of_the_paper_s_thirteen_means_are_impossible_with_twenty_people():
    impossible = [mean for mean in PRINTED if not grim(mean, 20)]
    assert sorted(impossible) == sorted("4.46 4.88 4.84 4.98 4.92 4.57 4.94 4.27 4.78".split())
    # All fit from 89 people on when halves are rounded up, from 80 on when they may be rounded either way.
    assert least_n(PRINTED, half_up=True) == 89
    assert least_n(PRINTED) == 80


def test_grim_counts_the_items_of_a_mean_and_refuses_what_is_none():
    assert not grim("4.46", 20)
    assert grim("4.46", 20, items=24)
    for wrong in ("x", "1/3", "1e0", ""):
        with pytest.raises(NotAMean, match="is no mean"):
            grim(wrong, 20)
    with pytest.raises(NotAMean):
        grim("4.46", 0)
