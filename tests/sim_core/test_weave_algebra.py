"""Draft algebra, facts of a draft, generators and channels: exact."""

import numpy as np
import pytest

from sim_core.errors import WeaveError
from sim_core.weave.draft import (
    Channels,
    Draft,
    Harness,
    basket,
    brocade,
    damask,
    diamond,
    draft_of_words,
    drawdown,
    float_statistics,
    four_end_gauze,
    gauze,
    generators,  # its rounds are counted
    hangs_together,
    harness,
    herringbone,
    lift_plan,
    limit_floats,
    motif_of,
    plain,
    satin,
    satin_of_six,
    summary,
    tapestry,
    tie_up,
    twill,
    warp_compound,
    weft_compound,
    weft_faced,
)
from sim_core.weave.files import dressed

RNG = np.random.default_rng(5)


@pytest.mark.parametrize("size", [(1, 1), (2, 5), (8, 8), (31, 17), (64, 40)])
def test_lift_to_harness_and_back_is_exact_with_the_fewest_shafts(size):
    lift = RNG.integers(0, 2, size).astype(bool)
    made = harness(lift)
    np.testing.assert_array_equal(made.lift, lift)
    assert made.threading.shape[1] == len({tuple(c) for c in lift.T})
    plan = lift_plan(made.tieup, made.treadling)
    np.testing.assert_array_equal(drawdown(made.threading, plan), lift)
    np.testing.assert_array_equal(lift_plan(*tie_up(plan)), plan)


def test_several_treadles_and_shafts_lift_together():
    matrices = [[1, 0], [0, 1], [1, 1]], [[1, 0, 0], [0, 1, 0]], [[1, 1, 0], [1, 0, 0], [0, 0, 1]]
    made = Harness(*(np.array(matrix) for matrix in matrices))
    np.testing.assert_array_equal(made.lift, [[1, 1, 1], [1, 0, 1], [0, 0, 0]])
    with pytest.raises(WeaveError, match="must agree"):
        Harness(np.array([[1, 0, 0]]), np.array([[1], [0]]), np.array([[1]]))


def brute_floats(line):
    n = len(line)
    starts = [k for k in range(n) if line[k] != line[k - 1]]
    if not starts:
        return [n]
    return sorted((b - a) % n or n for a, b in zip(starts, [*starts[1:], starts[0]], strict=True))


def test_floats_of_random_drafts_against_counting():
    for _ in range(60):
        draft = Draft("r", RNG.integers(0, 2, RNG.integers(1, 9, 2)))
        for side, lines in zip(float_statistics(draft), (draft.lift.T, draft.lift), strict=True):
            lengths = sorted(length for length, count in (*side.face, *side.back) for _ in range(count))
            assert lengths == sorted(length for line in lines for length in brute_floats(line))


def test_facts_of_the_basic_weaves():
    for draft, face, longest, mean, changes in (
        (plain(), "same", 1, 1.0, 8), (draft_of_words("twill:2/1"), "warp", 2, 1.5, 12),
        (draft_of_words("satin:8/3"), "warp", 7, 4.0, 32), (draft_of_words("satin:8/3:weft"), "weft", 7, 4.0, 32),
    ):  # fmt: skip
        facts = summary(Draft("tiled", np.tile(draft.lift, (2, 3))))
        assert (facts.ends, facts.picks) == (draft.ends, draft.picks)
        assert (facts.face, facts.warp.longest, facts.warp.mean) == (face, longest, mean)
        assert facts.interlacings == changes
        assert facts.integral


def test_conventions_of_the_words():
    lift = draft_of_words("twill:2/1").lift
    np.testing.assert_array_equal(np.roll(lift[0], 1), lift[1])  # one end on, a pick
    np.testing.assert_array_equal(
        np.roll(draft_of_words("twill:2/1:S").lift[0], -1), draft_of_words("twill:2/1:S").lift[1]
    )
    for ends, step in ((8, 3), (5, 2), (7, 4), (10, 3)):
        satin_lift = draft_of_words(f"satin:{ends}/{step}").lift
        for pick in range(ends):
            assert np.flatnonzero(~satin_lift[pick]).tolist() == [step * pick % ends]
        weft = draft_of_words(f"satin:{ends}/{step}:weft").lift
        np.testing.assert_array_equal(weft, ~satin_lift)


BAD_WORDS = (
    "", "knit", "twill", "twill:2", "twill:a/b", "satin:8/2", "satin:8/3:Q", "plain:weft", "twill:1/3:weft",
    "twill:9999/1", "satin:5/1", "twill:2/1:S:Z", "satin:8/3:warp:weft",
)  # fmt: skip


@pytest.mark.parametrize("words", BAD_WORDS)
def test_bad_words_are_one_line(words):
    with pytest.raises(WeaveError) as caught:
        draft_of_words(words)
    assert "\n" not in str(caught.value)
    assert "–" in str(caught.value)


def brute_integral(lift):
    """Every proper set of yarns, tried: none may lie over all the rest."""
    picks, ends = lift.shape
    for bits in range(1, 2 ** (picks + ends) - 1):
        warp = [bits >> j & 1 for j in range(ends)]
        weft = [bits >> (ends + i) & 1 for i in range(picks)]
        if all(lift[i, j] if warp[j] > weft[i] else not lift[i, j] if warp[j] < weft[i] else True
               for i in range(picks) for j in range(ends)):  # fmt: skip
            return False
    return True


def test_integrity_against_trying_every_set():
    seen = set()
    for _ in range(150):
        lift = RNG.integers(0, 2, RNG.integers(2, 5, 2)).astype(bool)
        assert hangs_together(Draft("r", lift)) == brute_integral(lift)
        seen.add(brute_integral(lift))
    assert seen == {True, False}


def test_two_cloths_one_over_the_other_fall_apart():
    double = np.zeros((4, 4), bool)
    double[0::2, 0::2], double[1::2, 1::2] = np.eye(2, dtype=bool), np.eye(2, dtype=bool)
    double[1::2, 0::2] = True  # upper ends over lower picks
    assert not hangs_together(Draft("double", double))
    double[1, 0] = False  # one stitch
    assert hangs_together(Draft("stitched", double))


def test_gauze_holds_by_its_crossings_alone():
    for draft in (gauze(), gauze(3), four_end_gauze()):
        assert hangs_together(draft)
        assert not hangs_together(Draft("no order", draft.lift))
    still = np.tile(np.arange(2), (2, 1))
    assert not hangs_together(
        Draft("uncrossed", gauze().lift, Channels(end_series=np.array([0, 1]), order=still))
    )
    order = four_end_gauze().channels.order
    assert order is not None
    assert all(len({p % 4 for p in row}) == 4 for row in order.tolist())  # one end a place


def test_tapestry_with_a_slit_all_the_way_falls_into_strips():
    strips = np.zeros((4, 8), int)
    strips[:, 4:] = 1
    assert not hangs_together(tapestry(strips))
    strips[:2] = 0
    assert hangs_together(tapestry(strips))


def test_compound_shows_the_chosen_series_and_weft_compound_is_its_turn():
    motif = RNG.integers(0, 3, (4, 6))
    draft = warp_compound(motif, 3)
    inner = draft.lift[1::2].reshape(4, 6, 3)
    np.testing.assert_array_equal(inner.argmax(axis=2), motif)
    np.testing.assert_array_equal(inner.sum(axis=2), 1)
    np.testing.assert_array_equal(weft_compound(motif.T, 3).lift, ~draft.lift.T)
    assert hangs_together(draft)


def test_brocade_is_bound_and_only_where_its_figure_is():
    motif = np.full((8, 16), -1)
    motif[2:6, 3:13] = 1
    motif[3, 1] = 0  # too short to be bound
    draft = brocade(motif, every=4)
    kind, region = draft.channels.pick_kind, draft.channels.region
    assert kind is not None
    assert region is not None
    extra = np.flatnonzero(kind == 2)
    assert len(extra) == 4
    assert (region[extra] == np.where(motif[2:6] == 1, 2, -1)).all()
    assert hangs_together(draft)
    np.testing.assert_array_equal(np.delete(draft.lift, extra, axis=0), np.tile(plain().lift, (4, 8)))


@pytest.mark.parametrize("longest", [3, 5, 8])
def test_damask_keeps_its_float_limit_on_both_faces(longest):
    y, x = np.mgrid[:48, :40]
    mask = (y - 24) ** 2 + (x - 20) ** 2 < 200
    draft = damask(mask, satin(8, 3), longest=longest)
    warp, weft = float_statistics(draft)
    assert max(warp.longest, weft.longest) <= longest
    free = damask(mask, satin(8, 3))
    assert max(f.longest for f in float_statistics(free)) > longest or longest == 8
    assert (draft.lift != free.lift).mean() < 0.35
    assert draft.lift[mask].mean() < 0.5 < draft.lift[~mask].mean()


def test_a_float_limit_that_cannot_be_kept_is_named():
    with pytest.raises(WeaveError, match="at least 1"):
        limit_floats(np.ones((4, 4)), 0)
    with pytest.raises(WeaveError, match="2 ends"):
        limit_floats(np.ones((1, 4)), 2)


def test_a_limit_that_binding_cannot_reach_is_given_up_soon(monkeypatch):
    """Floats of one crossing are plain weave; binding a satin down to it breaks and makes as many, for ever."""
    rounds = []
    counted = generators._long_runs
    monkeypatch.setattr(generators, "_long_runs", lambda *given: rounds.append(1) or counted(*given))
    with pytest.raises(WeaveError, match="at most 1 cannot be kept – allow longer ones"):
        limit_floats(np.tile(satin(5, 2).lift, (20, 21)), 1)
    assert len(rounds) <= 20  # of 820 before


def test_irregular_satin_of_six_touches_nowhere_and_derivatives_close():
    binding = ~satin_of_six().lift
    assert (binding.sum(axis=0) == 1).all()
    assert (binding.sum(axis=1) == 1).all()
    for move in ((1, 1), (1, -1)):
        assert (binding & np.roll(binding, move, axis=(0, 1))).sum() <= 1
    assert weft_faced(twill(3, 1)).face == "weft"
    assert basket(2, 3).lift.shape == (6, 4)
    pointed = herringbone(2, 2, 6)
    np.testing.assert_array_equal(pointed.lift[:, 1:6], pointed.lift[:, :6:-1])
    assert hangs_together(diamond(2, 2, 8))


def test_channels_of_the_wrong_shape_are_named():
    for channels in (
        Channels(end_series=np.zeros(3, int)),
        Channels(order=np.zeros((2, 2))),
        Channels(region=-2 * np.ones((2, 2), int)),
    ):
        with pytest.raises(WeaveError, match="draft x"):
            Draft("x", plain().lift, channels)


@pytest.mark.parametrize(
    ("channels", "message"),
    [
        ({"layer": [[0, 1], [0, 1]]}, "layer without series"),
        ({"region": [[-1, -1], [-1, -1]]}, "region is -1 everywhere"),
        ({"pick_kind": [2, 2]}, "every pick is extra"),
    ],
)
def test_channels_that_make_no_cloth_are_named(channels, message):
    with pytest.raises(WeaveError, match=message):
        Draft("x", plain().lift, Channels(**{name: np.array(v) for name, v in channels.items()}))


def test_a_channel_does_not_excuse_a_loose_yarn_but_crossings_do():
    loose = np.array([[1, 1], [0, 0]])
    assert Draft("x", loose, Channels(end_series=np.array([0, 0]))).loose() == "pick 0"
    assert Draft("x", loose.T, Channels(end_series=np.array([0, 1]))).loose() == "end 0"
    assert gauze().loose() is None
    with pytest.raises(WeaveError, match="pick 0 never interlaces"):
        dressed(Draft("x", loose, Channels(end_series=np.array([0, 0]))))


@pytest.mark.parametrize("mode", ["L", "RGBA", "I;16"])
def test_a_motif_is_dark_on_light_in_any_kind_of_picture(mode, tmp_path):
    from PIL import Image

    grey = np.full((20, 20), 255, np.uint8)
    grey[5:15, 5:10] = 20
    if mode == "RGBA":  # drawn on nothing, whose colour is black
        picture = Image.fromarray(np.dstack([np.zeros((20, 20, 3), np.uint8), 255 - grey]))
    else:
        picture = Image.fromarray(grey if mode == "L" else grey.astype(np.uint16) * 200 + 3000)
    picture.save(tmp_path / "motif.png")
    dark = motif_of(tmp_path / "motif.png")
    assert np.array_equal(dark, (grey < 128)[::-1])
