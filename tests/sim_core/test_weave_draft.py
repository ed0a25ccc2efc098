"""Drafts: generators, their conditions, face class, floats."""

import numpy as np
import pytest

from sim_core.errors import WeaveError
from sim_core.weave import Draft, Weave, Yarn, plain, satin, twill
from sim_core.weave.draft import float_statistics


def test_plain_alternates():
    np.testing.assert_array_equal(plain().lift, [[1, 0], [0, 1]])
    assert plain().face == "same"
    assert [floats.face for floats in float_statistics(plain())] == [((1, 2),), ((1, 2),)]


@pytest.mark.parametrize(
    ("up", "down", "face"), [(2, 1, "warp"), (1, 3, "weft"), (2, 2, "same"), (3, 1, "warp")]
)
def test_twill_floats_and_face(up, down, face):
    draft = twill(up, down)
    size = up + down
    assert draft.lift.shape == (size, size)
    assert draft.face == face
    assert [floats.face for floats in float_statistics(draft)] == [((up, size),), ((down, size),)]
    np.testing.assert_array_equal(draft.lift, np.roll(draft.lift, (1, 1), axis=(0, 1)))


def test_twill_runs_the_other_way_with_a_negative_step():
    np.testing.assert_array_equal(twill(2, 1, -1).lift, np.roll(twill(2, 1, -1).lift, (-1, 1), axis=(0, 1)))


@pytest.mark.parametrize(("ends", "step"), [(5, 2), (5, 3), (7, 2), (8, 3), (8, 5), (10, 3), (16, 7)])
def test_satin_binds_every_yarn_once_and_never_beside(ends, step):
    draft = satin(ends, step)
    binding = ~draft.lift
    np.testing.assert_array_equal(binding.sum(axis=0), 1)
    np.testing.assert_array_equal(binding.sum(axis=1), 1)
    for move in ((1, 1), (1, -1), (0, 1), (1, 0)):
        assert not (binding & np.roll(binding, move, axis=(0, 1))).any()
    assert draft.face == "warp"
    assert float_statistics(draft)[0].face == ((ends - 1, ends),)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: satin(8, 2), "shares a factor"),
        (lambda: satin(6, 2), "no regular satin has so many ends"),
        (lambda: satin(5, 1), "makes a twill"),
        (lambda: satin(5, 4), "makes a twill"),
        (lambda: satin(4, 2), "5 ends"),
        (lambda: twill(1, 0), "at least"),
        (lambda: twill(2, 2, 2), "shares a factor"),
        (lambda: Draft("x", np.array([[2, 0], [0, 1]])), "other than 0 and 1"),
        (lambda: Draft("x", np.zeros(4)), "shape"),
    ],
)
def test_impossible_drafts_are_named(make, message):
    with pytest.raises(WeaveError, match=message):
        make()


@pytest.mark.parametrize("lift", [np.ones((2, 2)), np.array([[1, 0], [1, 0]])])
def test_a_cloth_with_a_loose_yarn_is_refused(lift):
    yarn = Yarn(1e-4, 5e-6)
    with pytest.raises(WeaveError, match="end 0 never interlaces"):
        Weave("x", Draft("x", lift), yarn, yarn, 2000, 2000)


def test_back_of_a_satin_is_weft_faced_and_twice_back_is_the_face():
    draft = satin(8, 3)
    assert draft.back().face == "weft"
    np.testing.assert_array_equal(draft.back().back().lift, draft.lift)


def test_interlacings_count_changes_of_side():
    ends, picks = twill(2, 2).interlacings()
    assert ends.tolist() == [2] * 4
    assert picks.tolist() == [2] * 4


def test_lift_cannot_be_changed():
    with pytest.raises(ValueError, match="read-only"):
        plain().lift[0, 0] = False
