"""The time loop over lanes in both precisions, the lanes, and the pace of a run."""

from dataclasses import replace

import numpy as np
import pytest

from sim_core.cloth import Live, Phase, drape
from sim_core.cloth.contact import Holds
from sim_core.cloth.scenes import GF_CM, bar, disc, hang_edge, scene
from sim_core.cloth.sheet import Sheet
from sim_core.cloth.step import Engine, Pace
from sim_core.cloth.step.kernels import (
    SAME,
    bands_of,
    lane_bends,
    lane_further,
    lane_leap,
    lane_odd_bends,
    lane_strains,
    lane_tensions,
    lattice_lanes,
    ordered,
    plain_lanes,
)
from sim_core.errors import SimCoreError

SINGLE, LONG = Pace("single"), Pace("single", 0.95)
UNDAMPED = replace(GF_CM, mass_damping=0.0, stiffness_damping=0.0)


def run(made, pace=None, **more):
    given = {"pins": made.pins, "air": made.air, "collider": made.collider, "contact": made.contact}
    return drape(made.sheet, made.positions, made.phases, pace=pace, **given, **more)


def apart(a, b):
    return 1e3 * float(np.linalg.norm(a.positions - b.positions, axis=1).mean())


def accelerations(sheet, lanes, x):
    """M^-1 f of membrane and bending by lanes: (3, V) for x (3, V)."""
    real = lanes.bands.own.dtype
    inverse, b = sheet.stencil.inverse_mass.astype(real), lanes.bands
    here = x.astype(real)
    strain, tension = (np.zeros(lanes.edges + len(sheet.mass), real) for _ in range(2))
    out, aside = np.zeros_like(here), np.zeros_like(here)
    at, speed, there = tuple(here), tuple(out), tuple(aside)
    lane_strains(b.edge_runs, b.length2, at, strain)
    lane_tensions(b.tension_runs, b.own, b.coupling, strain, tension)
    lane_leap(b.vertex_runs, tension, inverse, at, np.zeros(3), (0.0, 1.0, 0.0), speed, there)
    if len(lanes.further_runs):
        lane_further(lanes.further_runs, tension, inverse, at, 1.0, speed)
    lane_bends(b.bend_runs, b.bend, inverse, 1.0, at, speed)
    lane_odd_bends(lanes.odd, inverse, 1.0, at, speed)
    return out


def expected(sheet, x):
    from sim_core.cloth.sheet import edge_tensions, vertex_forces

    s, place = sheet.stencil, np.ascontiguousarray(x.T)
    strain, tension, force = np.zeros(len(s.edges)), np.zeros(len(s.edges)), np.zeros_like(place)
    edge_tensions(s, place, np.zeros_like(place), 0.0, strain, tension)
    vertex_forces(s, place, tension, force)
    return (force * s.inverse_mass[:, None]).T


def crumpled(sheet, seed=1):
    rng = np.random.default_rng(seed)
    flat = np.column_stack([sheet.rest, np.zeros(len(sheet.rest))]).T
    return flat * 1.02 + 1e-3 * rng.standard_normal(flat.shape)


@pytest.mark.parametrize("edge", [0.11, 0.06, 0.021])
@pytest.mark.parametrize(("real", "off"), [(np.float32, 2e-4), (np.float64, 1e-9)])
def test_lanes_of_a_lattice_have_the_forces_of_the_book(edge, real, off):
    sheet, _ = ordered(hang_edge(edge).sheet)
    lanes, x = lattice_lanes(sheet, bands_of(sheet), real), crumpled(sheet)
    there = expected(sheet, x)
    assert np.abs(accelerations(sheet, lanes, x) - there).max() < off * np.abs(there).max()


def test_lanes_of_any_mesh_have_the_forces_of_the_book():
    sheet, _ = ordered(Sheet.of(*disc(0.3, 0.02), GF_CM))
    x = crumpled(sheet)
    there = expected(sheet, x)
    found = accelerations(sheet, plain_lanes(bands_of(sheet)), x)
    assert np.abs(found - there).max() < 2e-4 * np.abs(there).max()


def test_coefficients_of_a_lattice_repeat_in_a_short_table_and_a_disc_is_none():
    sheet, _ = ordered(hang_edge(0.0134).sheet)
    lanes = lattice_lanes(sheet, bands_of(sheet))
    assert lanes.bands.own.size < 0.2 * len(sheet.edges)
    assert lanes.bands.bend.shape[1] < 0.3 * len(sheet.mass)
    assert lanes.bands.vertex_runs[:, 1].sum() == len(sheet.mass)
    assert lanes.edges < 1.1 * len(sheet.edges)
    round_, _ = ordered(Sheet.of(*disc(0.3, 0.02), GF_CM))
    assert lattice_lanes(round_, bands_of(round_)) is None


def test_a_row_unlike_the_others_keeps_its_own_coefficients():
    sheet, _ = ordered(hang_edge(0.03).sheet)
    stiff = sheet.stencil.own.copy()
    stiff[len(stiff) // 2] *= 1 + 100 * SAME
    other = replace(sheet, stencil=sheet.stencil._replace(own=stiff))
    x = crumpled(sheet)
    change = accelerations(other, lattice_lanes(other, bands_of(other)), x)
    change -= accelerations(sheet, lattice_lanes(sheet, bands_of(sheet)), x)
    assert 1 <= (np.abs(change).max(axis=0) > 0).sum() <= 2


def test_a_lattice_in_double_falls_over_lanes_as_over_bands():
    made = scene("flag", frames=6, vertices=500)
    lanes = Engine(made.sheet).laned
    assert lanes is not None
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("sim_core.cloth.step.engine.lanes_for", lambda *_: None)
        bands = run(made)
    assert apart(run(made), bands) < 1e-5


def test_lanes_are_taken_in_the_precision_asked_for_unless_lengths_are_kept():
    sheet = hang_edge(0.05).sheet
    for pace, real in ((None, np.float64), (SINGLE, np.float32)):
        laned = Engine(sheet, pace=pace).laned
        assert laned is not None
        assert laned.real is real
    assert Engine(sheet, holds=Holds.of(len(sheet.rest), limit=(1.0, 0.04))).laned is None


def test_a_disc_in_single_falls_as_in_double():
    made = scene("drape", frames=4, vertices=400)
    assert apart(run(made, SINGLE), run(made)) < 0.02


def test_undamped_sheet_stays_within_a_tenth_of_a_millimetre_of_the_limit():
    made = hang_edge(0.03, seconds=0.2, material=UNDAMPED)
    limit = run(made, substeps=800)
    for pace in (SINGLE, LONG, Pace("double", 0.95)):
        found = run(made, pace)
        assert apart(found, limit) < 0.1, pace
        assert found.rollbacks == found.fallbacks == 0


@pytest.mark.parametrize("pace", [LONG, Pace("double", 0.95)])
def test_impulses_of_bending_feed_no_mode_at_the_longest_step(pace):
    made = hang_edge(0.03, seconds=0.6, material=UNDAMPED)
    rng = np.random.default_rng(2)
    noisy = replace(made, positions=made.positions + 1e-6 * rng.standard_normal(made.positions.shape))
    found, limit = run(noisy, pace), run(made, substeps=512)
    assert found.rollbacks == found.fallbacks == 0
    assert found.worst_stretch < 1.02 * limit.worst_stretch


def test_single_with_solids_and_layers_keeps_out_and_falls_like_double():
    made = bar(0.04, seconds=0.4)
    found, usual = run(made, SINGLE), run(made)
    assert made.collider.distance(found.positions).min() > -1e-4
    assert abs(found.positions[:, 1].mean() - usual.positions[:, 1].mean()) < 0.01


def test_single_in_wind_and_far_from_the_origin():
    made = scene("flag", frames=5, vertices=400)
    away = np.array([300.0, 20.0, -100.0])
    near, far = run(made, SINGLE), run(replace(made, positions=made.positions + away), SINGLE)
    assert apart(near, run(made)) < 0.5
    assert 1e3 * np.abs(near.positions - (far.positions - away)).max() < 0.5


def test_single_resumes_with_the_same_bits(tmp_path):
    made, kept = hang_edge(0.06, seconds=0.4), tmp_path / "run"

    def stop(index, _):
        if index == 4:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run(made, LONG, checkpoint=kept, on_frame=stop)
    resumed = run(made, LONG, checkpoint=kept, on_frame=lambda *_: None)
    assert np.array_equal(resumed.positions, run(made, LONG).positions)


def test_pins_in_single_are_exactly_where_they_are_led():
    made = hang_edge(0.1)
    live = Live(made.sheet, made.positions, pins=made.pins, pace=SINGLE)
    aim = made.positions[list(made.pins)] + [0.0, 0.01, 0.0]
    assert np.abs(live.step(targets=aim)[list(made.pins)] - aim).max() < 1e-9


def test_a_pace_that_is_none_is_refused():
    with pytest.raises(SimCoreError, match="precision"):
        Pace("half")
    for share in (0.0, 1.0, float("nan")):
        with pytest.raises(SimCoreError, match="courant"):
            Pace(courant=share)


def test_default_pace_guards_nothing():
    engine = Engine(hang_edge(0.1).sheet)
    assert engine.pace.guard(1e-3, engine.bend_omega2) == 0.0


def test_cases_of_the_hanging_cloth_name_the_step_their_corners_need():
    assert scene("hanging", 2).courant == 0.7  # an edge
    assert scene("hanging", 1).courant < 0.5  # two corners


def test_error_of_the_corners_at_the_step_of_the_scene():
    made = scene("hanging", 1, frames=10, vertices=600)
    limit = run(made, substeps=600)
    assert apart(run(made, Pace(courant=made.courant)), limit) < 0.05


def test_flag_is_within_half_a_millimetre_of_its_limit():
    made = scene("flag", frames=10, vertices=800)
    assert apart(run(made, substeps=256), run(made, substeps=1024)) < 0.5


def test_phases_of_a_garment_run_in_single():
    made = hang_edge(0.08)
    phases = (Phase(0.08, damping=3.0, speed_limit=2.0), Phase(0.08, gravity=(0.0, 9.81)))
    found = run(replace(made, phases=phases), SINGLE)
    assert apart(found, run(replace(made, phases=phases))) < 0.1
