"""Stage B against the elastica, its own energy, friction, flattening, jam; leno and laid wefts."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from elastica import elastica_crimp, peirce_crimp
from full_matrix import by_day

from sim_core.errors import WeaveError
from sim_core.weave import Channels, Draft, Weave, Yarn, plain, satin, twill
from sim_core.weave.draft import basket, gauze
from sim_core.weave.yarns import (
    beam_stiffness,
    check_jam,
    ground_of,
    jam_limits,
    lay_beams,
    solve,
    strands,
    turns_of,
)
from sim_core.weave.yarns.particles import (
    advance,
    contact_forces,
    curve_overlap,
    factored,
    pin_forces,
    relax_particles,
    side_forces,
    yarn_forces,
)

D = 1e-4
NO_TURNS = np.zeros(0, np.int64)
FOLDER = Path(__file__).parents[2] / "assets" / "weaves"


def cloth(
    draft: Draft, spacing: float, *, picks: float = 0.0, ratio: float = 1.0, flattening: float = 1.0
) -> Weave:
    warp, weft = Yarn(D, 5e-6, flattening, 1e-9 * ratio), Yarn(D, 5e-6, flattening, 1e-9)
    return Weave(draft.name, draft, warp, weft, 1 / (spacing * D), 1 / ((picks or spacing) * D))


@pytest.mark.parametrize("spacing", [8, 4, 3, 2])
@pytest.mark.parametrize("per", [8, 16])
def test_plain_crimp_within_one_and_a_half_per_cent_of_the_elastica(spacing, per):
    cell = relax_particles(cloth(plain(), spacing), per=per)
    assert cell.warp_crimp == pytest.approx(elastica_crimp(spacing), rel=0.015)
    # warp and weft are treated alike: equal to rounding where the yarns touch in one point. Round yarns at p/d = 2 wrap
    # each other; which places along that contact are pinned is left to rounding, and many states nearby are at rest.
    assert cell.weft_crimp == pytest.approx(cell.warp_crimp[0], rel=1e-12 if spacing > 2 else 1e-4)
    assert cell.penetration <= 5e-4
    assert cell.residual <= 1e-3
    if spacing > 2:  # round yarns that touch in one point
        assert sum(cell.crest_to_trough()) == pytest.approx(2 * D, rel=5e-3)


def test_elastica_of_small_slope_is_the_beam():
    assert elastica_crimp(60.0) == pytest.approx(0.6 / 60**2, rel=1e-3)


def test_near_jam_the_crimp_is_peirces():
    assert peirce_crimp(1.76) == pytest.approx(0.199, abs=0.001)
    for per in (8, 16):
        assert relax_particles(cloth(plain(), 1.76), per=per).warp_crimp[0] == pytest.approx(0.199, abs=0.003)


def test_beyond_jam_is_refused_with_the_limit():
    with pytest.raises(
        WeaveError, match=r"jammed.*jam limit of a square sett is 173 um \(0.866 D\).*at most 56"
    ):
        relax_particles(cloth(plain(), 1.70))


def test_the_limits_of_a_jam_are_the_closest_setts_that_pass():
    yarn = Yarn(D, 5e-6, 1.6, 1e-9)
    for draft in (plain(), twill(2, 1), satin(5, 2)):
        jammed = Weave(draft.name, draft, yarn, yarn, 0.99 / (1.2 * yarn.width), 1 / (1.2 * yarn.width))
        ends, picks = jam_limits(jammed)
        for key, most in (("ends_per_m", ends), ("picks_per_m", picks)):
            check_jam(replace(jammed, **{key: 0.9999 * most}))
            with pytest.raises(WeaveError, match="jammed"):
                check_jam(replace(jammed, **{key: 1.0001 * most}))


def test_yarns_closer_than_their_height_are_refused_however_open_the_other_system():
    yarn = Yarn(D, 5e-6, 1.0, 1e-9)
    with pytest.raises(WeaveError, match="at most 10000 ends_per_m"):
        check_jam(Weave("x", plain(), yarn, yarn, 10100.0, 1000.0))


def test_unequal_stiffness_goes_beyond_the_beams_ratio_as_slopes_grow():
    wide, close = (relax_particles(cloth(plain(), p, ratio=2), per=16).crest_to_trough() for p in (8, 4))
    assert wide[1] / wide[0] == pytest.approx(2.0, rel=0.1)
    assert close[1] / close[0] > wide[1] / wide[0] > 2.0


def test_more_particles_change_the_crimp_of_a_satin_little():
    crimps = [relax_particles(cloth(satin(8, 3), 3), per=per).warp_crimp.mean() for per in (16, 32)]
    assert crimps[1] == pytest.approx(crimps[0], rel=0.02)


def test_friction_holds_a_twill_in_place():
    """Sideways shift at the crossings of a 2/2 twill: with friction small, without it larger."""
    held, free = (relax_particles(cloth(twill(2, 2), 2.5), friction=mu, tolerance=2e-4) for mu in (0.3, 0.0))
    assert max(held.skew) <= 0.05 * D
    assert max(free.skew) > 1.5 * max(held.skew)


SLOW = [pytest.param(name, marks=pytest.mark.slow) for name in ("qi", "anhuaduan")]


@pytest.mark.parametrize("name", ["gauze", "juan", "kesi", "ling", "satin", "twill", "zhuanghua", *SLOW])
def test_shipped_weaves_come_to_rest(name):
    """Steep and flat yarns under tension too: satin and twill once fluttered between two nearest points for ever, and
    the damask turns more steeply than eight particles a crossing can show."""
    cell = relax_particles(ground_of(Weave.load(FOLDER / f"{name}.toml")))
    assert cell.per == (12 if name == "anhuaduan" else 8)
    assert cell.residual <= 1e-3
    assert cell.penetration <= 5e-4
    assert cell.force.min() >= 0


def test_flattened_yarns_touch_at_their_heights_and_cover_more():
    weave = cloth(plain(), 4, flattening=2.0)
    cell = relax_particles(weave)
    assert sum(cell.crest_to_trough()) == pytest.approx(weave.warp.height + weave.weft.height, rel=5e-3)
    assert weave.openness < cloth(plain(), 4).openness


def test_tubes_do_not_meet_when_measured_between_particles():
    """Independent of the contact kernel: nearest distance of finely sampled splines of crossing yarns."""
    from scipy.interpolate import CubicSpline

    weave = cloth(twill(2, 2), 2.5)
    cell = relax_particles(weave, per=16)
    n = cell.warp_side.shape[1]
    p = weave.end_spacing
    t = np.linspace(-1.2, 1.2, 500)

    def curve(side, height, number, crossing):
        knots = np.arange(n + 1) / 16
        closed = np.column_stack(
            [np.append(side[number], side[number][0]), np.append(height[number], height[number][0])]
        )
        return CubicSpline(knots, closed, bc_type="periodic")((crossing + t) % 4)

    for j, i in ((0, 0), (0, 1), (1, 3)):
        warp, weft = (
            curve(cell.warp_side, cell.warp_height, j, i),
            curve(cell.weft_side, cell.weft_height, i, j),
        )
        a = np.column_stack([warp[:, 0], t * p, warp[:, 1]])
        b = np.column_stack([t * p, weft[:, 0], weft[:, 1]])
        nearest = np.linalg.norm(a[:, None] - b[None], axis=2).min()
        assert nearest >= D * (1 - 2e-3)


def test_forces_are_the_slope_of_the_energy():
    """Bending, tension, side and crossing contact, each against differences of its energy."""
    rng = np.random.default_rng(3)
    u, z = 0.05 * rng.standard_normal((3, 16)), 0.3 * rng.standard_normal((3, 16))

    def check(energy, force):
        for which in (0, 1):
            for _ in range(6):
                y, k = rng.integers(3), rng.integers(16)
                step = np.zeros_like(u)
                step[y, k] = 1e-6
                ends = [energy(*((u + s * step, z) if which == 0 else (u, z + s * step))) for s in (1, -1)]
                assert force[which][y, k] == pytest.approx(-(ends[0] - ends[1]) / 2e-6, rel=1e-4, abs=1e-6)

    def bend(a, b):
        return yarn_forces(a, b, 0.5, 1.3, 0.2, np.zeros_like(a), np.zeros_like(a))

    g = np.zeros_like(u), np.zeros_like(u)
    yarn_forces(u, z, 0.5, 1.3, 0.2, *g)
    check(bend, g)
    h = [np.zeros_like(u) for _ in range(4)]
    g = np.zeros_like(u), np.zeros_like(u)
    out = 0.02 * rng.random(u.shape)

    def side(a, b, ga, gb, weigh):
        given: list = [a, b, 0.6, 0.9, 0.8, 5.0, ga, gb, out, False, weigh, *h[:2], 0]
        return side_forces(*given)

    assert side(u, z, *g, True)[1] > 0.05
    check(lambda a, b: side(a, b, np.zeros_like(a), np.zeros_like(a), False)[0], g)


def test_contact_acts_equally_on_both_yarns():
    rng = np.random.default_rng(4)
    lift = np.array([[True, False], [False, True]])
    shape = (2, 16)
    wz = 0.4 * np.cos(np.pi * (np.arange(16) / 8 + np.arange(2)[:, None]))
    state = [0.02 * rng.standard_normal(shape), wz, 0.02 * rng.standard_normal(shape), -wz]
    g = [np.zeros(shape) for _ in range(4)]
    stiffness = [np.zeros(shape) for _ in range(4)]
    everywhere = np.ones((2, 2, 14), np.uint8)
    values = (
        *state,
        *g,
        lift,
        np.zeros((2, 2)),
        everywhere,
        0.01 * everywhere,
        False,
        8,
        0.3,
        0.3,
        1.0,
        1.0,
        3,
        3,
        100.0,
        0.0,
        0.01,
        False,
    )
    given: list = [*values, *stiffness, NO_TURNS, *2 * [np.zeros((0, 0, 2))]]
    _, deepest, largest = contact_forces(*given)
    assert deepest > 0.05
    assert largest > 0
    assert g[1].sum() == pytest.approx(-g[3].sum(), rel=1e-9)


@pytest.mark.parametrize("count", [8, 9, 30])
def test_a_step_is_solved_with_the_whole_yarn(count):
    """The first step is length (1 + 1/4) K^-1 g with the dense cyclic stiffness K of bending, tension and contact."""
    rng = np.random.default_rng(6)
    weight, force = rng.uniform(0.5, 4.0, (2, 3, count)), 0.01 * rng.standard_normal((2, 3, count))
    made = np.zeros((2, 3, count, 5))
    bent = 2 * np.eye(count) - np.roll(np.eye(count), 1, 0) - np.roll(np.eye(count), -1, 0)
    for which in (0, 1):
        factored(weight[which], 1.3, 0.2, made[which])
    places, speeds = np.zeros((2, 3, count)), np.zeros((2, 3, count))
    given: list = [*places, *speeds, *force, *made, np.zeros((3, 2)), 0.7]
    advance(*given)
    for which in (0, 1):
        for yarn in range(3):
            stiffness = 1.3 * bent @ bent + 0.2 * bent + np.diag(weight[which, yarn])
            wanted = 0.7 * np.linalg.solve(stiffness, force[which, yarn])
            np.testing.assert_allclose(speeds[which, yarn], wanted, rtol=1e-10, atol=1e-14)
            np.testing.assert_allclose(places[which, yarn], 1.25 * wanted, rtol=1e-10, atol=1e-14)


def test_contacts_set_out_press_as_before_and_do_not_overlap():
    """Soft contact would let the yarns of this weave overlap by 2e-2 D, and lower the crest by as much."""
    cell = relax_particles(cloth(plain(), 4), per=16)
    assert cell.penetration <= 5e-4
    assert sum(cell.crest_to_trough()) == pytest.approx(2 * D, rel=1e-3)


def test_the_same_weave_gives_the_same_bits():
    first, second = (relax_particles(cloth(twill(3, 1), 3)) for _ in range(2))
    np.testing.assert_array_equal(first.warp_height, second.warp_height)


@pytest.mark.parametrize(
    ("draft", "spacing", "flattening"),
    [
        (satin(8, 3), 4, 1.0),
        (satin(8, 3), 2.6, 1.8),
        (satin(5, 2), 4, 2.0),
        (twill(3, 1), 3.5, 1.6),
        (twill(2, 1), 3, 1.0),
    ],
)
def test_one_end_and_one_pick_stand_for_all_of_a_satin(monkeypatch, draft, spacing, flattening):
    """As satins above 10,000 crossings are relaxed, against all yarns of the repeat; 2.6: neighbours touch."""
    weave = cloth(draft, spacing, flattening=flattening)
    whole = relax_particles(weave)
    monkeypatch.setattr("sim_core.weave.yarns.particles.cell.MANY", 0)
    one = relax_particles(weave)
    assert one.steps == whole.steps
    for name in ("warp_side", "warp_height", "weft_side", "weft_height"):
        np.testing.assert_allclose(getattr(one, name), getattr(whole, name), atol=1e-9 * D)
    np.testing.assert_allclose(one.force, whole.force, atol=1e-9 * whole.force.max())
    np.testing.assert_allclose(one.warp_crimp, whole.warp_crimp, rtol=1e-8)
    np.testing.assert_allclose(one.weft_crimp, whole.weft_crimp, rtol=1e-8)
    assert one.energy == pytest.approx(whole.energy)


def test_drafts_whose_yarns_are_no_shifts_of_one_are_relaxed_whole():
    assert turns_of(basket(2, 2).lift) is None
    assert turns_of(np.vstack([satin(5, 2).lift] * 2)) is None
    turns = turns_of(twill(2, 2).lift)
    assert turns is not None
    assert turns.shift in (1, 3)


def test_particles_out_of_range_are_named():
    with pytest.raises(WeaveError, match="particles"):
        relax_particles(cloth(plain(), 4), per=3)


def test_a_beam_laid_over_one_obstacle_is_the_periodic_spline():
    sign = np.full((1, 8), -1.0)
    limit = np.full((1, 8), 1e-3)
    sign[0, 0], limit[0, 0] = 1.0, 2e-4
    sign[0, 4], limit[0, 4] = -1.0, 0.0
    z = lay_beams(beam_stiffness(8, 1e-4, 1e-9, 0.0), sign, limit, 4000)[0]
    assert z[0] == pytest.approx(2e-4, rel=1e-3)
    assert abs(z[4]) <= 1e-3 * 2e-4
    assert z[2] == pytest.approx(1e-4, rel=0.01)  # halfway up, by symmetry


@pytest.mark.parametrize("name", ["sha", "luo"])
def test_leno_doups_lie_over_every_pick_and_beneath_the_end_they_cross(name):
    weave = Weave.load(FOLDER / f"{name}.toml")
    solve(weave)
    warp, weft = strands(weave, solve(weave), per=16)[:2]
    series = weave.draft.channels.end_series
    assert series is not None
    doup, ground = series == 1, series == 0
    need = (weave.warp.height + weave.weft.height) / 2
    picks = warp.height[:, ::16]
    at = weft.height[:, ::16].T
    assert (picks - at)[doup].min() >= need * (1 - 1e-5)
    assert (at - picks)[ground].min() >= need * (1 - 1e-5)
    middle = warp.height[:, 8::16]
    assert middle[ground].mean() - middle[doup].mean() >= weave.warp.height * (1 - 1e-5)


def test_brocade_lies_on_its_ground():
    weave = Weave.load(FOLDER / "zhuanghua.toml")
    warp, _, extra = strands(weave, solve(weave))
    shown = extra.height[extra.colour >= 0]
    assert np.median(shown) > warp.height.max() * 0.5
    assert (
        shown.max() < warp.height.max() + 3 * extra.yarn.height
    )  # floats lie on the ground, no arches over it
    assert extra.colour.max() <= 3


@pytest.mark.parametrize("name", ["sha", "luo"])
def test_a_leno_is_in_balance_and_says_how_well(name):
    weave = Weave.load(FOLDER / f"{name}.toml")
    made = solve(weave)
    assert 0 < made.residual < 1e-6
    assert made.penetration <= 1e-5 * (weave.warp.height + weave.weft.height) / 2
    assert made.force.min() >= 0
    assert made.force.max() > 0
    # each pick is pressed up by its ground ends as much as down by its doups
    signed = np.where(weave.draft.lift, -1, 1) * made.force
    assert np.abs(signed.sum(axis=1)).max() <= 1e-3 * made.force.max()


def test_a_leno_too_large_for_its_dense_problem_is_named():
    one = gauze(64)
    channels = {name: np.vstack([v] * 5) if v.ndim == 2 else v for name, v in one.channels.items()}
    draft = Draft("wide", np.vstack([one.lift] * 5), Channels(**channels))
    weave = replace(Weave.load(FOLDER / "sha.toml"), draft=draft)
    with pytest.raises(WeaveError, match="at most 512 crossings"):
        solve(weave)


def least_norm(weave, cell):
    """Dense oracle: least of n over points of Catmull-Rom curves of crossing yarns, both norms, 24 points a piece."""
    fine = 24
    warp, weft = weave.warp, weave.weft
    size = (warp.height + weft.height) / 2
    round_weft, round_warp = (weft.width + warp.height) / 2 / size, (warp.width + weft.height) / 2 / size
    wide, high = weave.size[0] / size, weave.size[1] / size

    def curve(side, height, step, spacing, number):
        p = np.stack([side[number] + number * spacing, height[number]])
        a, b, c, d = (np.roll(p, -k, axis=1)[..., None] for k in (-1, 0, 1, 2))
        f = np.arange(fine) / fine
        made = b + f / 2 * (c - a + f * (2 * a - 5 * b + 4 * c - d + f * (3 * (b - c) + d - a)))
        return made.reshape(2, -1) / size, np.arange(made[0].size) * step / fine / size

    least = np.inf
    for i in range(weave.draft.picks):
        (y, zf), x = curve(
            cell.weft_side, cell.weft_height, weave.end_spacing / cell.per, weave.pick_spacing, i
        )
        for j in range(weave.draft.ends):
            (u, zw), v = curve(
                cell.warp_side, cell.warp_height, weave.pick_spacing / cell.per, weave.end_spacing, j
            )
            dx = (u[:, None] - x + wide / 2) % wide - wide / 2
            dy = (v[:, None] - y + high / 2) % high - high / 2
            dz = (zw[:, None] - zf) ** 2
            one, other = dx**2 + (dy / round_weft) ** 2 + dz, (dx / round_warp) ** 2 + dy**2 + dz
            least = min(least, one.min(), other.min())
    return np.sqrt(least)


CLOTHS = [
    (plain(), 4, 1.0), (twill(2, 2), 4, 1.0), (twill(2, 1), 3, 1.0), (satin(8, 3), 4, 1.0), (satin(5, 2), 4, 2.0),
    (twill(3, 1), 3.5, 1.6),
]  # fmt: skip


@pytest.mark.parametrize("per", by_day([6], [6, 8, 16]))
@pytest.mark.parametrize(("draft", "spacing", "flattening"), CLOTHS)
def test_curves_do_not_meet_between_their_particles(draft, spacing, flattening, per):
    """Every warp curve against every weft curve; `penetration` is what is found there."""
    weave = cloth(draft, spacing, flattening=flattening)
    cell = relax_particles(weave, per=per)
    deepest = 1 - least_norm(weave, cell)
    assert deepest <= 5e-4
    assert cell.penetration <= 5e-4
    assert cell.penetration >= deepest - 1e-6


NO_PINS = np.zeros((0, 6))


def test_penetration_is_measured_between_the_particles():
    """The measure itself, on straight yarns that touch half way between their particles."""
    n, step = 32, 2.5 / 8
    away = np.abs(np.arange(n) % 8 - 3.5) / 4  # least on either side of the middle between two particles
    wz, fz = np.tile(0.45 + 0.2 * away, (4, 1)), np.tile(-0.45 - 0.2 * away, (4, 1))
    shift = 3.5 * step  # brings these places over one another
    wu, fu = np.full((4, n), shift), np.full((4, n), shift)
    above = np.ones((4, 4), bool)
    found, pins = curve_overlap(wu, wz, fu, fz, above, 8, step, step, 1.0, 1.0, 7, 7, NO_PINS, 4e-4, NO_TURNS)
    # Catmull-Rom at the middle of a piece: 9/16 of each neighbour, -1/16 of the next
    least = 2 * (0.45 + 0.2 * (9 / 8 * 0.125 - 1 / 8 * 0.375))
    assert found == pytest.approx(1 - least, abs=1e-9)
    assert len(pins) == 32  # one a crossing and norm
    np.testing.assert_allclose(pins[:, 3], 3.5, atol=1e-6)
    again, more = curve_overlap(wu, wz, fu, fz, above, 8, step, step, 1.0, 1.0, 7, 7, pins, 4e-4, NO_TURNS)
    assert again == found
    assert len(more) == 0  # it is pinned
    apart, none = curve_overlap(
        wu, wz + 1, fu, fz, above, 8, step, step, 1.0, 1.0, 7, 7, NO_PINS, 4e-4, NO_TURNS
    )
    assert apart < 0
    assert len(none) == 0


def test_pins_act_equally_on_both_yarns_and_as_the_slope_of_their_energy():
    rng = np.random.default_rng(3)
    turn = 2 * np.pi * (np.arange(16) / 16 + rng.random((4, 2, 1)))
    state = [0.05 * np.cos(part) for part in turn]  # smooth: no bowl in which the partner would be held
    state[1] += 0.4
    state[3] -= 0.4
    lift, flat = np.ones((2, 2), bool), (1.3, 1.4)
    pins = np.array([[0, 1, 0, 0.3, -0.1, 0.0], [1, 0, 1, -1.6, 0.2, 0.01], [1, 1, 0, 0.0, 0.1, 0.02]])

    def forces(values):
        g, h = ([np.zeros((2, 16)) for _ in range(4)] for _ in range(2))
        pressing = np.zeros((2, 2))
        given: list = [
            pins,
            *values,
            *g,
            lift,
            pressing,
            8,
            0.3,
            0.3,
            *flat,
            7,
            7,
            100.0,
            False,
            True,
            *h,
            NO_TURNS,
        ]
        energy, deepest, largest = pin_forces(*given)
        assert deepest > 0.01
        assert largest == pressing.max() > 0
        return energy, g, h

    _, g, h = forces(state)
    assert g[1].sum() == pytest.approx(-g[3].sum())
    assert all((part >= 0).all() and part.max() > 0 for part in h)
    for k, part in enumerate(state):
        for place in zip(*np.nonzero(g[k]), strict=True):
            ends = []
            for way in (1e-6, -1e-6):
                moved = [v.copy() for v in state]
                moved[k][place] = part[place] + way
                ends.append(forces(moved)[0])
            assert (ends[0] - ends[1]) / 2e-6 == pytest.approx(-g[k][place], rel=1e-5, abs=1e-6)
