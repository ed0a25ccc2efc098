"""What a draft tells by counting on its factors, against weaving it out; and drafts of twenty thousand yarns."""

import numpy as np
import pytest

from sim_core.errors import WeaveError
from sim_core.weave.draft import (
    Draft,
    Factors,
    Harness,
    hangs_together,
    lift_plan,
    summary,
    summary_of_factors,
)


def lifts(count: int):
    """Random lifts, sparse and dense, square and not, one in three of them repeated."""
    rng = np.random.default_rng(5)
    for k in range(count):
        lift = rng.random(rng.integers(1, 8, 2)) < rng.choice([0.2, 0.5, 0.8])
        yield np.tile(lift, (2, 3)) if k % 3 == 0 else lift


def lengths_of_runs(cycle: np.ndarray) -> list[int]:
    """Lengths of the runs of True in a cyclic sequence."""
    if cycle.all():
        return [cycle.size]
    from_gap = np.roll(cycle, -int(np.argmin(cycle)))
    return [len(run) for run in "".join("1" if over else " " for over in from_gap).split()]


def test_counting_gives_what_the_cloth_itself_gives():
    together = 0
    for lift in lifts(1500):
        draft, factors = Draft("x", lift), Factors.of_lift(lift)
        np.testing.assert_array_equal(factors.lift(), lift)
        assert factors.hangs_together() == hangs_together(
            draft
        )  # by counting, and by the graph of what lies over what
        facts, small = summary_of_factors(factors), draft.repeat()
        assert (facts.picks, facts.ends, facts.face) == (small.picks, small.ends, small.face)
        for told, yarns in ((facts.warp, small.lift.T), (facts.weft, ~small.lift)):
            floats = sorted(length for yarn in yarns for length in lengths_of_runs(yarn))
            assert sorted(length for length, count in told.face for _ in range(count)) == floats
        ends, picks = small.interlacings()
        assert facts.interlacings == ends.sum() + picks.sum()
        together += facts.integral
    assert 100 < together < 1400


def test_a_harness_is_counted_without_weaving_it_out():
    rng = np.random.default_rng(6)
    for _ in range(200):
        ends, picks, shafts, treadles = rng.integers(1, 12, 4)
        harness = Harness(
            *(rng.random(s) < 0.3 for s in ((ends, shafts), (shafts, treadles), (picks, treadles)))
        )
        factors = Factors.of_harness(harness)
        np.testing.assert_array_equal(factors.lift(), harness.lift)
        assert len({row.tobytes() for row in factors.core}) == len(factors.core)
        assert summary_of_factors(factors) == summary(Draft("x", harness.lift))


def test_twenty_thousand_ends_and_picks_are_counted_by_their_shafts_and_treadles():
    shafts = 12
    walk = np.arange(20_000) % (2 * shafts - 2)
    point = np.minimum(walk, 2 * shafts - 2 - walk)
    straight = np.eye(shafts, dtype=bool)
    tieup = np.add.outer(np.arange(shafts), np.arange(shafts)) % shafts < 6
    factors = Factors.of_harness(Harness(straight[point], tieup, straight[point]))
    assert factors.core.shape == (shafts, shafts)
    one = Draft("one", Harness(straight[point[:22]], tieup, straight[point[:22]]).lift)
    facts, small = summary_of_factors(factors), summary(one)
    assert factors.periods == (22, 22)  # 20,000 are 909 repeats of 22 and two yarns more
    assert (facts.ends, facts.picks, facts.integral) == (20_000, 20_000, small.integral)
    assert small.warp.longest <= facts.warp.longest <= small.warp.longest + 2


@pytest.mark.nightly
def test_what_has_no_factors_is_refused_by_name():
    rng = np.random.default_rng(7)
    many = np.eye(9_000, dtype=bool)
    plan = rng.random((9_000, 9_000)) < 0.5
    with pytest.raises(WeaveError, match="9,000 different picks by 9,000 different ends"):
        Factors.of_harness(Harness(many, many, plan))


def test_lift_plans_of_many_shafts_do_not_overflow():
    tied = np.ones((700, 700), bool)
    assert lift_plan(tied, np.ones((2, 700), bool)).all()
