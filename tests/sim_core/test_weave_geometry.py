"""Stage A against closed forms, force balance, complementarity, jamming."""

import numpy as np
import pytest

from sim_core.errors import WeaveError
from sim_core.weave import Weave, Yarn, YarnGeometry, plain, relax, satin, twill
from sim_core.weave.draft import damask
from sim_core.weave.instruments import Assumed, Load, Specimen
from sim_core.weave.yarns import beam_stiffness, draft_shift

D = 1e-4


def weave(draft, *, ends=4.0, picks=4.0, ratio=1.0, flattening=1.0, tension=0.0) -> Weave:
    """Spacings in yarn diameters; ratio of the warp's EI to the weft's."""
    warp = Yarn(D, 5e-6, flattening, 1e-9 * ratio, tension=tension)
    return Weave("test", draft, warp, Yarn(D, 5e-6, flattening, 1e-9), 1 / (ends * D), 1 / (picks * D))


@pytest.mark.parametrize("spacing", [8, 4, 3, 2])
def test_balanced_plain_weave(spacing):
    cloth = weave(plain(), ends=spacing, picks=spacing)
    geometry = relax(cloth)
    h1, h2 = geometry.crest_to_trough()
    p = spacing * D
    assert h1 == pytest.approx(D, rel=1e-8)
    assert h1 + h2 == pytest.approx(2 * D, rel=1e-8)
    np.testing.assert_allclose(geometry.force, 24 * 1e-9 * h1 / p**3, rtol=1e-8)  # V = 24 EI h / p^3
    crimp = geometry.warp_crimp
    np.testing.assert_allclose(crimp, 0.6 * (h1 / p) ** 2, rtol=1e-8)
    np.testing.assert_allclose(h1 / (p * np.sqrt(crimp)), 1.2910, rtol=1e-4)


@pytest.mark.parametrize("ratio", [2, 4, 8, 0.125])
def test_stiffness_ratio_law(ratio):
    h1, h2 = relax(weave(plain(), ratio=ratio)).crest_to_trough()
    assert h2 / h1 == pytest.approx(ratio, rel=1e-8)


@pytest.mark.parametrize(("ends", "picks"), [(6, 4), (3, 4), (4, 4)])
def test_spacing_law(ends, picks):
    h1, h2 = relax(weave(plain(), ends=ends, picks=picks)).crest_to_trough()
    assert h1 / h2 == pytest.approx((picks / ends) ** 3, rel=1e-8)


def test_flattened_yarns_touch_at_their_height():
    cloth = weave(plain(), flattening=2.0)
    h1, h2 = relax(cloth).crest_to_trough()
    assert h1 + h2 == pytest.approx(cloth.warp.height + cloth.weft.height, rel=1e-8)
    area = (cloth.warp.width - cloth.warp.height) * cloth.warp.height + np.pi / 4 * cloth.warp.height**2
    assert area == pytest.approx(np.pi / 4 * D**2, rel=1e-12)


DRAFTS = {
    "plain": plain(),
    "twill": twill(2, 2),
    "ling": twill(3, 1),
    "duan": satin(5, 2),
    "satin": satin(8, 3),
}


@pytest.mark.parametrize("name", DRAFTS)
@pytest.mark.parametrize("options", [{}, {"ends": 3, "picks": 5, "ratio": 5}, {"tension": 0.02}])
def test_force_balance_and_contact(name, options):
    cloth = weave(DRAFTS[name], **options)
    geometry = relax(cloth)
    assert geometry.residual <= 1e-6
    assert geometry.penetration <= 1e-6 * D
    assert geometry.complementarity <= 1e-6
    assert geometry.force.min() >= 0
    assert abs(geometry.warp_height.mean() + geometry.weft_height.mean()) <= 1e-9 * D


def test_bending_balances_the_contact_forces_in_real_space():
    """Independent of the Fourier solution: the jump of the spline's third derivative is the crossing force."""
    cloth = weave(satin(8, 3), ends=3, picks=5)
    geometry = relax(cloth)
    n, p = 8, cloth.pick_spacing
    ring = np.eye(n)
    side = np.roll(ring, 1, axis=1) + np.roll(ring, -1, axis=1)
    curvature = np.linalg.solve(4 * ring + side, 6 / p**2 * (side - 2 * ring) @ geometry.warp_height)
    force = cloth.warp.stiffness / p * (side - 2 * ring) @ curvature
    wanted = np.where(cloth.draft.lift, 1, -1) * geometry.force
    np.testing.assert_allclose(force, wanted, atol=1e-7 * geometry.force.max())


def test_swapping_warp_and_weft_swaps_the_result():
    """Turning the cloth over a diagonal and upside down is the same cloth."""
    cloth = weave(twill(3, 1), ends=3, picks=5, ratio=3)
    turned = Weave("turned", type(cloth.draft)("t", ~cloth.draft.lift.T), cloth.weft, cloth.warp, cloth.picks_per_m,
                   cloth.ends_per_m)  # fmt: skip
    first, second = relax(cloth), relax(turned)
    np.testing.assert_allclose(first.warp_height, second.weft_height.T, atol=1e-7 * D)
    np.testing.assert_allclose(first.force, second.force.T, rtol=1e-5, atol=1e-7 * first.force.max())


def test_tension_flattens_floats():
    slack, taut = (relax(weave(satin(8, 3), tension=t)) for t in (0.0, 0.1))
    assert taut.crest_to_trough()[0] < slack.crest_to_trough()[0]


def test_beam_stiffness_of_the_plain_mode():
    stiffness = beam_stiffness(2, 2e-4, 1e-9, 0.0)
    np.testing.assert_allclose(stiffness, [0, 48 * 1e-9 / (2e-4) ** 3], rtol=1e-12)


@pytest.mark.parametrize(("spacing", "fits"), [(1.80, True), (1.74, True), (1.72, False), (1.2, False)])
def test_square_plain_weave_jams_at_0_866(spacing, fits):
    cloth = weave(plain(), ends=spacing, picks=spacing)
    if fits:
        assert relax(cloth).penetration <= 1e-6 * D
    else:
        with pytest.raises(WeaveError, match="jammed"):
            relax(cloth)


def test_overfull_satin_is_jammed():
    with pytest.raises(WeaveError, match="at most 10000 ends_per_m"):
        relax(weave(satin(8, 3), ends=0.7))


def compliance(cloth: Weave, rest: YarnGeometry | None = None) -> np.ndarray:
    return Specimen(cloth, rest or relax(cloth), Assumed()).compliance()


@pytest.mark.parametrize("name", DRAFTS)
def test_tensile_compliance_is_symmetric_and_positive(name):
    matrix = compliance(weave(DRAFTS[name], ends=3, picks=5, ratio=2))
    assert np.linalg.eigvalsh(matrix).min() > 0
    assert matrix[0, 1] == matrix[1, 0]


@pytest.mark.parametrize("name", ["plain", "twill", "ling"])
def test_pulling_one_yarn_system_shortens_the_other(name):
    assert compliance(weave(DRAFTS[name]))[0, 1] < 0


def test_reciprocity_holds_before_symmetrising():
    """Strain of the weft per warp tension equals strain of the warp per weft tension (Maxwell, Betti)."""
    cloth = weave(satin(5, 2), ends=3, picks=5, ratio=2)
    specimen = Specimen(cloth, relax(cloth), Assumed())
    changes = []
    for side, count in enumerate((cloth.ends_per_m, cloth.picks_per_m)):
        pulls = (0.1 / count, 0.0) if side == 0 else (0.0, 0.1 / count)
        loaded = specimen.beams.settle(Load(pulls), specimen.slack)
        changes.append(loaded.crimp[1 - side] - specimen.slack.crimp[1 - side])
    assert changes[0] == pytest.approx(changes[1], rel=5e-3)


def test_crimp_straightening_of_plain_weave_has_a_closed_form():
    """a1 = D K2 / (K1 + K2) with K1 = (48 EI/p^3 + 4.8 T/p): strain 2.4 (a1/p)^2 less under tension."""
    cloth = weave(plain())
    p, k = cloth.pick_spacing, 48 * 1e-9 / cloth.pick_spacing**3
    change = -D * k * (4.8 / p) / (2 * k) ** 2
    per_yarn = -4.8 * (D / 2) / p**2 * change
    wanted = per_yarn / cloth.ends_per_m + 1 / (cloth.warp.axial * cloth.ends_per_m)
    matrix = compliance(cloth)
    assert matrix[0, 0] == pytest.approx(wanted, rel=1e-3)
    assert matrix[0, 1] == pytest.approx(-per_yarn / cloth.ends_per_m, rel=1e-3)


def long_hand(cloth: Weave, tolerance: float, monkeypatch, many: int):
    monkeypatch.setattr("sim_core.weave.yarns.beams.MANY", many)
    return relax(cloth, tolerance=tolerance)


@pytest.mark.parametrize("draft", [plain(), twill(2, 2), twill(5, 3), satin(8, 3), satin(31, 7)])
@pytest.mark.parametrize(("ends", "picks", "ratio"), [(4.0, 4.0, 1.0), (5.0, 3.5, 3.0)])
def test_a_draft_that_shifts_is_solved_by_one_pick(draft, ends, picks, ratio, monkeypatch):
    cloth = weave(draft, ends=ends, picks=picks, ratio=ratio)
    wanted = long_hand(cloth, 1e-11, monkeypatch, 10**9)
    made = long_hand(cloth, 1e-11, monkeypatch, 0)
    for name in ("warp_height", "weft_height", "force", "warp_crimp", "weft_crimp"):
        one, other = getattr(wanted, name), getattr(made, name)
        np.testing.assert_allclose(other, one, atol=1e-8 * np.abs(one).max())


def test_only_drafts_that_shift_have_a_shift():
    assert draft_shift(plain().lift) == 1
    assert draft_shift(twill(2, 1).lift) == 1
    lift = satin(8, 3).lift
    assert np.array_equal(lift[3], np.roll(lift[0], 3 * (draft_shift(lift) or 0)))
    broken = lift.copy()
    broken[4, 2] ^= True
    assert draft_shift(broken) is None
    assert draft_shift(np.tile(lift, (1, 2))[:4]) is None  # half a repeat does not close


def test_the_longest_satin_is_in_balance():
    draft = satin(1024, 341)
    geometry = relax(weave(draft))
    assert geometry.penetration <= 1e-6 * D
    assert geometry.complementarity <= 1e-6
    assert geometry.residual <= 1e-9
    assert (geometry.force > 0).sum() >= 3 * 1024  # each end is held from both sides


def test_large_figures_keep_their_yarns_apart(monkeypatch):
    """Long waves are so soft that heights are taken from the gap there, not from the forces."""
    rng = np.random.default_rng(1)
    noise = np.fft.ifft2(np.fft.fft2(rng.normal(size=(48, 48))) * np.exp(-((np.fft.fftfreq(48) * 24) ** 2)))
    cloth = weave(damask(noise.real > 0, satin(8, 3), longest=8), flattening=2.0)
    wanted = long_hand(cloth, 1e-10, monkeypatch, 10**9)
    made = long_hand(cloth, 1e-6, monkeypatch, 100)
    assert made.penetration <= 1e-12 * D
    for name in ("warp_height", "weft_height", "force", "warp_crimp", "weft_crimp"):
        one, other = getattr(wanted, name), getattr(made, name)
        np.testing.assert_allclose(other, one, atol=1e-4 * np.abs(one).max())
    np.testing.assert_allclose(compliance(cloth, made), compliance(cloth, wanted), rtol=1e-3)
