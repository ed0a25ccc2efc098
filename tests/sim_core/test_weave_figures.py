"""Large figures: rest in a close sett, curves kept apart, common waves, static friction."""

from pathlib import Path

import numpy as np
import pytest

from sim_core.weave import Weave, Yarn, plain, relax_particles, surface_maps
from sim_core.weave.draft import Draft, damask, satin
from sim_core.weave.files import dressed, weave_of
from sim_core.weave.yarns import beam_stiffness, resampled
from sim_core.weave.yarns.particles import (
    CommonWaves,
    NotAtRest,
    System,
    Units,
    contact_forces,
    curve_gaps,
    gathered,
    is_figure,
)

NOTHING = np.zeros((0, 0, 2))


def blobs(size: int, seed: int) -> np.ndarray:
    """A motif that does not repeat: smooth noise over the repeat, cut at a height."""
    rng = np.random.default_rng(seed)
    y, x = np.fft.fftfreq(size)[:, None], np.fft.rfftfreq(size)
    waves = np.fft.rfft2(rng.standard_normal((size, size))) * np.exp(-((x**2 + y**2) * 700))
    field = np.fft.irfft2(waves, (size, size))
    return field > 0.3 * field.std()


@pytest.fixture(scope="module")
def figure():
    weave = dressed(damask(blobs(26, 3), longest=8))
    return weave, relax_particles(weave, per=8)


def catmull(points: np.ndarray, s: np.ndarray) -> np.ndarray:
    """points (2, n) periodic at places s -> (2, len(s))."""
    k = np.floor(s).astype(int)
    f = s - k
    a, b, c, d = (points[:, (k + m) % points.shape[1]] for m in (-1, 0, 1, 2))
    return b + f / 2 * (c - a + f * (2 * a - 5 * b + 4 * c - d + f * (3 * (b - c) + d - a)))


def test_a_figure_in_a_close_sett_comes_to_rest(figure):
    _, cell = figure
    assert cell.residual <= 1e-3
    assert cell.penetration <= 5e-4
    assert cell.force.min() >= 0
    # each yarn is in balance as a whole, up to what is left on its particles
    size = cell.force.max() * cell.residual * cell.warp_side.shape[1]
    lift = np.where(figure[0].draft.lift, 1.0, -1.0) * cell.force
    assert np.abs(lift.sum(axis=0)).max() <= size + 0.05 * cell.force.max()


def test_curves_of_a_figure_do_not_meet(figure):
    """Independent of the kernels: a dense search of both norms round every crossing."""
    weave, cell = figure
    per, size = cell.per, (weave.warp.height + weave.weft.height) / 2
    wide_x, wide_y = (weave.warp.width + weave.weft.height) / 2, (weave.weft.width + weave.warp.height) / 2
    s = np.linspace(-1.2 * per, 1.2 * per, 121)
    least = np.inf
    for i in range(weave.draft.picks):
        for j in range(weave.draft.ends):
            u, zw = catmull(np.stack([cell.warp_side[j], cell.warp_height[j]]), i * per + s)
            v, zf = catmull(np.stack([cell.weft_side[i], cell.weft_height[i]]), j * per + s)
            x = u[:, None] - s * weave.end_spacing / per
            y = s[:, None] * weave.pick_spacing / per - v
            z = (zw[:, None] - zf) ** 2
            for a, b in ((size, wide_y), (wide_x, size)):
                least = min(least, float(((x / a) ** 2 + (y / b) ** 2 + z / size**2).min()))
    assert np.sqrt(least) >= 1 - 5e-4


def test_a_figure_crimps_as_by_pins():
    """In an open net, where both ways come to rest, they give the same cloth."""
    yarn = Yarn(1e-4, 5e-6, 2.0, 1e-9)
    weave = Weave("net", damask(blobs(24, 5), longest=8), yarn, yarn, 2400, 2400)
    import sim_core.weave.yarns.particles.cell as particles

    way, plain_way = relax_particles(weave, per=8), None
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(particles, "FIGURE", 10**9)
        plain_way = relax_particles(weave, per=8)
    assert way.steps != plain_way.steps
    assert way.warp_crimp.mean() == pytest.approx(plain_way.warp_crimp.mean(), rel=0.01)
    assert way.weft_crimp.mean() == pytest.approx(plain_way.weft_crimp.mean(), rel=0.01)


@pytest.mark.parametrize("steps", [100, 101, 115, 150])
def test_a_figure_takes_no_more_steps_than_allowed(figure, steps):
    watch = np.zeros(2)
    with pytest.raises(NotAtRest, match=f"after {steps} steps"):
        relax_particles(figure[0], most=steps, watch=watch)
    assert watch[0] == steps


def test_satins_are_no_figures_and_rest_by_pins():
    """Floats of 30 crossings slide too little to leave their pins, and do not come to rest the figures' way."""
    assert not is_figure(satin(32, 23).lift)
    assert not is_figure(np.tile(satin(8, 3).lift, (4, 4)))
    cell = relax_particles(dressed(satin(32, 23)), most=2000)
    assert cell.residual <= 1e-3
    assert cell.penetration <= 5e-4


def overshot(ends: int, picks: int) -> np.ndarray:
    """(picks, ends) bool: blocks of two shafts in turn, pattern picks that float over a block between tabby picks."""
    pairs, blocks = [(0, 1), (1, 2), (2, 3), (3, 0)], np.repeat(np.resize([0, 1, 2, 3, 2, 1], ends // 4), 4)
    shafts = np.array([pairs[block][k % 2] for k, block in enumerate(blocks)])
    rows = []
    for pick in range(picks):
        tabby = (0, 2) if pick % 4 == 0 else (1, 3)
        pattern = set(range(4)) - set(pairs[blocks[(pick * ends // picks) % ends]])
        rows.append(np.isin(shafts, tabby if pick % 2 == 0 else list(pattern)))
    return np.array(rows)


@pytest.mark.nightly
@pytest.mark.parametrize("kind", ["32 shafts", "overshot"])
def test_ordinary_drafts_rest_the_figures_way(kind):
    """A 62 x 62 twill of 32 shafts and a 92 x 60 overshot, which pins and contacts set out twice left swinging."""
    lift = overshot(92, 60)
    weave = dressed(Draft(kind, lift))
    if kind == "32 shafts":
        weave, _ = weave_of(str(Path(__file__).parent / "drafts/weaveit-32-shafts.wif"))
    cell = relax_particles(weave, most=7000)
    assert cell.residual <= 1e-3
    assert cell.penetration <= 5e-4
    assert 0 < cell.static < 2


def test_what_does_not_rest_the_figures_way_rests_by_pins_from_the_start(monkeypatch):
    """A satin with one crossing turned over is a figure of long floats."""
    lift = satin(32, 23).lift.copy()
    lift[3, 5] ^= True
    assert is_figure(lift)
    monkeypatch.setattr("sim_core.weave.yarns.particles.cell.FIGURE_STEPS", 150)
    watch = np.zeros(2)
    cell = relax_particles(dressed(Draft("turned", lift)), most=3000, watch=watch)
    assert cell.residual <= 1e-3
    assert cell.penetration <= 5e-4
    assert cell.steps == watch[0] <= 3000


def test_gaps_are_those_of_the_curves_not_of_the_particles():
    """Straight yarns that touch half way between their particles."""
    n, step = 32, 2.5 / 8
    away = np.abs(np.arange(n) % 8 - 3.5) / 4
    wz, fz = np.tile(0.45 + 0.2 * away, (4, 1)), np.tile(-0.45 - 0.2 * away, (4, 1))
    side, gaps = np.full((4, n), 3.5 * step), np.zeros((4, 4, 2))
    curve_gaps(side, wz, side, fz, np.ones((4, 4), bool), 8, step, step, 1.0, 1.0, 7, 7, gaps)
    least = 2 * (0.45 + 0.2 * (9 / 8 * 0.125 - 1 / 8 * 0.375))  # Catmull-Rom at the middle of a piece
    np.testing.assert_allclose(gaps, least - 1, atol=1e-9)


@pytest.mark.parametrize("count", [8, 9])
def test_forces_are_gathered_as_the_splines_hand_them_out(count):
    """The adjoint of `resampled`: force times way is the same at the crossings and along the yarn."""
    rng = np.random.default_rng(2)
    height, force = rng.standard_normal((3, count)), rng.standard_normal((3, count * 6))
    work = (force * resampled(height, 6)).sum()
    assert (gathered(force, 6) * height).sum() == pytest.approx(work, rel=1e-12)


def test_a_common_wave_goes_back_by_its_share():
    """Heights z of both systems with the forces of beams, -K z at the crossings, are moved by -0.8 z."""
    rng = np.random.default_rng(4)
    wave = rng.standard_normal((9, 12))
    wave -= wave.mean()
    spare = {"wide": 1.0, "reach": 3, "spacing": 2.0, "side": 0.0, "high": 1.0}
    warp_units = System(piece=0.5, bend=1.3, pull=0.1, **spare)
    units = Units(warp_units, System(piece=0.4, bend=0.7, pull=0.2, **spare), friction=0.3)
    warp, weft = beam_stiffness(9, 3.0, 1.3, 0.1)[:, None], beam_stiffness(12, 2.4, 0.7, 0.2)
    bent_warp = np.fft.ifft(np.fft.fft(wave, axis=0) * warp, axis=0).real
    bent_weft = np.fft.ifft(np.fft.fft(wave, axis=1) * weft, axis=1).real
    along_warp, along_weft = np.zeros((12, 54)), np.zeros((9, 72))
    along_warp[:, ::6], along_weft[:, ::6] = -bent_warp.T, -bent_weft  # at the crossings themselves
    moved_warp, moved_weft = np.zeros((12, 54)), np.zeros((9, 72))
    CommonWaves.of((9, 12), 6, units, 1e-6).move(moved_warp, moved_weft, along_warp, along_weft)
    np.testing.assert_allclose(moved_warp[:, ::6].T, -0.8 * wave, atol=1e-5)
    np.testing.assert_allclose(moved_weft[:, ::6], -0.8 * wave, atol=1e-5)


@pytest.mark.parametrize("share", [0.2, 0.7])
def test_static_friction_holds_where_a_crossing_stuck(share):
    """A crossing that slid is held at its new place by at most a share of mu x N, on top of sliding friction."""

    def pull(stuck):
        n = 16
        wu, fu = np.full((2, n), 0.3), np.full((2, n), -0.2)
        wz, fz = np.full((2, n), 0.45), np.full((2, n), -0.45)
        force = [np.zeros((2, n)) for _ in range(4)]
        spare = [np.zeros((2, n)) for _ in range(4)]
        crossings = np.full((2, 2, 14), 1, np.uint8)
        pressing = np.full((2, 2), 2.0)
        given: list = [
            wu, wz, fu, fz, *force, np.ones((2, 2), bool), pressing, crossings, 0.0 * crossings, False, 8, 0.3, 0.3,
            1.0, 1.0, 3, 3, 100.0, 0.3, 0.01, False, *spare, np.zeros(0, np.int64), NOTHING, stuck,
        ]  # fmt: skip
        contact_forces(*given)
        return force[0][0, 0], force[2][0, 0]

    at_most = np.full((2, 2), share)
    free, here = pull(NOTHING), pull(np.dstack([np.full((2, 2), 0.3), np.full((2, 2), -0.2), at_most]))
    assert here == pytest.approx(free)  # nothing where it stuck
    away = pull(np.dstack([np.full((2, 2), 0.2), np.full((2, 2), -0.2), at_most]))
    assert away[0] - free[0] == pytest.approx(-share * 0.3 * 2.0, rel=0.01)
    assert away[1] == pytest.approx(free[1])


def test_directions_do_not_turn_round_between_neighbours():
    """A filter between pixels would blend opposite directions to naught; warp and weft are far from the turn."""
    weave = dressed(plain())
    maps = surface_maps(weave, relax_particles(weave), pixels=128)
    run = maps.direction[..., :2].astype(float) - 127.5
    sure = maps.direction[..., 2] > 150
    for axis in (0, 1):
        alike = (run * np.roll(run, 1, axis=axis)).sum(axis=2)
        crossed = np.abs(
            run[..., 0] * np.roll(run, 1, axis=axis)[..., 1]
            - run[..., 1] * np.roll(run, 1, axis=axis)[..., 0]
        )
        near = (
            sure & np.roll(sure, 1, axis=axis) & (crossed < np.abs(alike))
        )  # of one yarn: less than 45 degrees
        assert near.mean() > 0.3
        assert alike[near].min() > 0
