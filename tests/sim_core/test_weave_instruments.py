"""Virtual instruments: loops of what slides, set yarns between plates and under pull, readings against closed forms."""

from dataclasses import replace
from math import radians
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import minimize

from sim_core.weave import Weave, examined, relax, solve
from sim_core.weave.instruments import Assumed, Laboratory, Load, Reading, Sliding, Specimen
from sim_core.weave.yarns import beam_stiffness

WEAVES = Path(__file__).parents[2] / "assets" / "weaves"
GF_CM = 0.980665  # [N/m] of 1 gf/cm


def load(name: str) -> Weave:
    return Weave.load(WEAVES / f"{name}.toml")


def specimen(name: str, **assumed: float) -> Specimen:
    weave = load(name)
    return Specimen(weave, relax(weave), Assumed(**assumed))


def readings(tests: dict) -> list[Reading]:
    found = []
    for value in tests.values():
        found += [value] if isinstance(value, Reading) else readings(value)
    return found


def test_a_loop_of_friction_alone_is_as_wide_as_twice_its_limit():
    loop = Sliding(first=100.0, second=0.0, limit=2.0)
    assert loop.width(0.0, 1.0) == pytest.approx(4.0)
    assert loop.slope(0.2, 0.6, 1.0) == pytest.approx(0.0)
    assert loop.once(0.01) == pytest.approx(1.0)  # not yet sliding


def test_a_loop_turns_where_it_was_turned_and_is_the_same_both_ways():
    loop = Sliding(first=10.0, second=2.0, limit=1.0)
    assert loop.rising(3.0, 3.0) == pytest.approx(loop.once(3.0))
    assert loop.rising(-3.0, 3.0) == pytest.approx(-loop.once(3.0))
    assert loop.width(1.0, 3.0) == pytest.approx(loop.width(-1.0, 3.0))
    assert loop.slope(1.5, 2.5, 3.0) == pytest.approx(2.0)


def test_where_nothing_yields_there_is_no_loop():
    assert Sliding(first=5.0, second=1.0, limit=1e9).width(1.0, 2.0) == pytest.approx(0.0)


@pytest.mark.parametrize("name", ["juan", "satin", "twill"])
def test_yarns_that_finishing_did_not_set_press_as_stage_a_has_it(name):
    """With their own stiffness and nothing set, heights and forces are those of stage A without the loom's tension."""
    weave = load(name)
    loose = replace(weave, warp=replace(weave.warp, tension=0.0), weft=replace(weave.weft, tension=0.0))
    rest = relax(loose)
    one = Specimen(loose, rest, Assumed(kept=0.0))
    slack = replace(one.beams, weave=loose).settle(Load())
    unit = (weave.warp.height + weave.weft.height) / 2
    gap = slack.warp - slack.weft
    np.testing.assert_allclose(gap, rest.warp_height - rest.weft_height, atol=1e-4 * unit)
    np.testing.assert_allclose(slack.force, rest.force, atol=1e-3 * rest.force.max())


def test_yarns_that_are_wholly_set_do_not_press():
    one = specimen("satin", kept=1.0)
    assert one.slack.force.max() < 1e-4 * one.rest.force.max()
    assert one.slack.crimp == pytest.approx(
        (one.rest.warp_crimp.mean(), one.rest.weft_crimp.mean()), rel=1e-3
    )


def bending_matrix(count: int, spacing: float, stiffness: float) -> np.ndarray:
    """K of one yarn over the crossings, by its modes."""
    modes = np.fft.fft(np.eye(count), axis=0)
    return (modes.conj().T @ np.diag(beam_stiffness(count, spacing, stiffness, 0.0)) @ modes).real / count


def test_thickness_under_plates_is_the_least_energy_of_a_long_way_round():
    """A 3/1 twill at 50 gf/cm2, solved once more as a dense problem with inequalities."""
    one = specimen("twill")
    weave, beams = one.beams.weave, one.beams
    unit = (weave.warp.height + weave.weft.height) / 2
    picks, ends = one.rest.warp_height.shape
    stiff = [
        bending_matrix(picks, weave.pick_spacing, weave.warp.stiffness),
        bending_matrix(ends, weave.end_spacing, weave.weft.stiffness),
    ]
    scale = max(float(np.abs(k).max()) for k in stiff)
    shapes = [beams.kept * z / unit for z in (one.rest.warp_height, one.rest.weft_height)]
    weight = 5000 * weave.end_spacing * weave.pick_spacing * picks * ends / (scale * unit)
    sign, reach = np.where(weave.draft.lift, 1.0, -1.0), beams.reach / unit

    def parts(x):
        heights = x[:-1].reshape(2, picks, ends)
        return heights[0], heights[1], x[-1]

    def energy(x):
        warp, weft, thickness = parts(x)
        a, b = warp - shapes[0], weft - shapes[1]
        return float((a * (stiff[0] @ a)).sum() + (b @ stiff[1] * b).sum()) / (2 * scale) + weight * thickness

    def slope(x):
        warp, weft, _ = parts(x)
        a, b = stiff[0] @ (warp - shapes[0]), (weft - shapes[1]) @ stiff[1]
        return np.concatenate([a.ravel(), b.ravel(), [weight * scale]]) / scale

    def room(x):
        warp, weft, thickness = parts(x)
        half = thickness / 2
        sides = [half - warp, half + warp, half - weft, half + weft]
        return np.concatenate(
            [
                (sign * (warp - weft) - 1).ravel(),
                *((s - r).ravel() for s, r in zip(sides, reach, strict=True)),
            ]
        )

    begin = np.concatenate([one.slack.warp.ravel() / unit, one.slack.weft.ravel() / unit, [4.0]])
    found = minimize(
        energy, begin, jac=slope, constraints={"type": "ineq", "fun": room}, method="SLSQP",
        options={"maxiter": 2000, "ftol": 1e-14},
    )  # fmt: skip
    assert found.success, found.message
    pressed = beams.settle(Load(pressure=5000.0), one.slack)
    assert pressed.thickness == pytest.approx(found.x[-1] * unit, rel=2e-3)


@pytest.mark.parametrize("name", ["juan", "satin", "ling", "cotton", "gauze"])
def test_plates_make_a_cloth_thinner_and_never_thinner_than_its_yarns(name):
    one = specimen(name)
    read, weave = one.thickness(), one.weave
    assert read["free"] >= read["T0"] * (1 - 1e-4) >= read["TM"] * (1 - 1e-3)
    assert read["TM"] >= max(weave.warp.height, weave.weft.height)


def test_a_stated_stiffness_is_what_bending_reads():
    """No filaments to hold or to slide: B = EI n / (1 + crimp), and no loop."""
    weave = load("juan")
    weave = replace(weave, warp=replace(weave.warp, stiffness=3e-10))
    one = Specimen(weave, relax(weave), Assumed())
    crimp = float(one.rest.warp_crimp.mean())
    assert one.bending()["warp"]["B"] == pytest.approx(3e-10 * weave.ends_per_m / (1 + crimp))
    assert one.bending()["warp"]["2HB"] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("name", ["juan", "satin", "cotton"])
def test_a_yarn_bends_between_its_free_and_its_held_filaments(name):
    one = specimen(name)
    for yarn, of_file in zip(one.yarns, (one.weave.warp, one.weave.weft), strict=True):
        assert of_file.stiffness_free <= yarn.free * (1 + 1e-9) <= yarn.stiffness <= yarn.held
        assert (
            yarn.held <= of_file.stiffness_stuck * 4
        )  # a flat bundle, filaments spread over all of its section
    for side in one.bending().values():
        assert side["2HB"] > 0


def test_shear_reads_the_pull_of_the_instrument_and_twice_the_friction():
    one = specimen("juan")
    loop, read = one.shearing(), one.shear()
    assert read["G"] == pytest.approx(
        10 * GF_CM, rel=1e-6
    )  # crossings slide long before .5 degrees of the way back
    assert read["2HG"] == read["2HG5"] == pytest.approx(2 * loop.limit)
    assert read["secant"] * radians(8) == pytest.approx(loop.limit)


def test_a_pulled_strip_keeps_its_width_and_gives_way_more_than_its_fibres():
    one = specimen("juan")
    count, other = one.weave.ends_per_m, one.weave.weft
    pull = 500 * GF_CM / count
    last, cross = one._held_width(one.slack, 0, pull, 0.0, other.axial)
    width = one.slack.crimp[1] - last.crimp[1] + cross / other.axial
    assert abs(width) < 5e-5
    read = one.tensile()["warp"]
    assert read["EMT"] > pull / one.weave.warp.axial
    assert 0 < read["LT"] < 1.2
    assert 0 < read["RT"] < 1


def test_more_pull_straightens_the_yarn():
    one = specimen("juan", kept=0.9)
    crimps = [one.beams.settle(Load((pull, 0.0)), one.slack).crimp[0] for pull in (0.0, 0.01, 0.05, 0.5)]
    assert all(np.diff(crimps) < 0)


@pytest.mark.parametrize("name", ["juan", "gauze", "twill", "sha", "jin", "lozenge-qi", "ramie"])
def test_no_band_is_wider_than_a_factor_of_four(name):
    weave = load(name)
    geometry = solve(weave)
    parameters, tests = examined(weave, geometry)
    bands = list(parameters.bounds.values()) + [one.band for one in readings(tests)]
    assert len(bands) == 6 + 17
    assert all(0 < least <= most <= 4 * least for least, most in bands)
    assert all(one.band[0] <= one.value <= one.band[1] for one in readings(tests))


def test_the_same_reading_in_units_of_the_instrument():
    told = Reading("B", 9.80665e-5, (9e-5, 1e-4)).to_dict()
    assert (told["kes"], told["kes_unit"]) == (pytest.approx(1.0), "gf cm2/cm")
    told = Reading("G", GF_CM / radians(1), (50.0, 60.0)).to_dict()
    assert (told["kes"], told["kes_unit"]) == (pytest.approx(1.0), "gf/(cm deg)")


def test_silk_is_in_the_range_that_is_told_of_silk():
    """Light degummed tabby: a shear hysteresis of some gf/cm, a bending stiffness of hundredths of a gf cm2/cm."""
    weave = load("juan")
    read = Laboratory(weave, relax(weave))
    assert 0.005 < read.bending["warp"]["B"].to_dict()["kes"] < 0.06
    assert 0.1 < read.shear["2HG"].to_dict()["kes"] < 5
