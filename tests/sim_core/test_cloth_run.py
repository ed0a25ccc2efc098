"""Whole runs: analytic sag, order in time, watchdog, determinism, resuming, bad input."""

from pathlib import Path

import numpy as np
import pytest

from sim_core.cloth import Checkpoint, HalfSpace, Material, Phase, Sheet, drape
from sim_core.cloth.run import RESTED, drape_run
from sim_core.cloth.scenes import bar, equilateral_sheet, hang_edge, scene
from sim_core.errors import SimCoreError


def test_hanging_sheet_sags_as_the_nonlinear_bar_does() -> None:
    """nu = 0: N(F) = k (F^3 - F) / 2 = rho g (L - s), integrated over the length; error below 0.1 %."""
    k, rho, length = 49.0, 0.05, 0.5
    material = Material(rho, k, 0.0, 1e-6, mass_damping=0.0, stiffness_damping=1e-4)
    sheet = Sheet.of(*equilateral_sheet(0.05, length, 0.0125), material)
    start = np.column_stack([sheet.rest[:, 0], -sheet.rest[:, 1], np.zeros(len(sheet.rest))])
    pins = np.flatnonzero(sheet.rest[:, 1] < 1e-9)
    end = drape(sheet, start, [Phase(0.6, damping=40.0), Phase(0.6, damping=90.0)], pins=pins.tolist())
    s = np.linspace(0, length, 4001)
    stretch = [np.real(max(np.roots([k / 2, 0, -k / 2, -rho * 9.81 * (length - u)]), key=np.real)) for u in s]
    sag = float(np.trapezoid(np.array(stretch) - 1, s))
    bottom = sheet.rest[:, 1] > length - 1e-9
    assert -end.positions[bottom, 1].mean() - length == pytest.approx(sag, rel=1e-3)
    assert end.rest_max < 1e-7


def test_second_order_in_time() -> None:
    material = Material(0.05, 49.0, 0.3, 4.9e-5, mass_damping=0.5, stiffness_damping=0.0)
    scene = hang_edge(0.1, seconds=0.16, material=material)

    def end(substeps: int) -> np.ndarray:
        return drape(scene.sheet, scene.positions, scene.phases, pins=scene.pins, substeps=substeps).positions

    finest = end(1280)
    errors = [np.abs(end(n) - finest).max() for n in (80, 160, 320)]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders.min() > 1.8
    assert errors[-1] < 1e-5


def test_step_follows_the_tangent_of_a_stretched_sheet() -> None:
    """Stretched by 1.6 the tangent is (3 F^2 - 1) / 2 = 3.3 times stiffer: a step fixed at rest would diverge."""
    material = Material(0.05, 50.0, 0.3, 5e-5, mass_damping=0.0, stiffness_damping=0.0)
    sheet = Sheet.of(*equilateral_sheet(0.3, 0.3, 0.05), material)
    rest = np.column_stack([sheet.rest, np.zeros(len(sheet.rest))])
    calm = drape(sheet, rest, [Phase(0.04, (0.0, 0.0))]).substeps
    tight = drape(sheet, rest * 1.6, [Phase(0.04, (0.0, 0.0))])
    assert tight.substeps > 1.5 * calm
    assert np.isfinite(tight.positions).all()
    assert np.abs(tight.positions).max() < 1.0


def test_watchdog_rolls_back_a_frame_that_blows_up(monkeypatch: pytest.MonkeyPatch) -> None:
    """With a step that is promised stable but is not, the frame is done again with half of it."""
    from sim_core.cloth.step import engine

    scene = hang_edge(0.1, seconds=0.08)
    true_step = engine.stable_step
    monkeypatch.setattr(engine, "stable_step", lambda *a, **k: 3.0 * true_step(*a, **k))
    end = drape(scene.sheet, scene.positions, scene.phases, pins=scene.pins, integrator="explicit")
    assert end.rollbacks >= 1
    assert end.fallbacks == 0
    assert np.isfinite(end.positions).all()
    assert end.positions[:, 1].min() > -0.2
    monkeypatch.setattr(engine, "stable_step", lambda *a, **k: 1e4 * true_step(*a, **k))
    with pytest.raises(SimCoreError, match="no step is short enough"):
        drape(scene.sheet, scene.positions, scene.phases, pins=scene.pins, integrator="explicit")
    saved = drape(scene.sheet, scene.positions, scene.phases, pins=scene.pins)
    assert saved.fallbacks >= 1
    monkeypatch.undo()
    true = drape(scene.sheet, scene.positions, scene.phases, pins=scene.pins)
    assert true.fallbacks == 0
    assert np.abs(saved.positions - true.positions).max() < 0.01


def test_same_input_same_bits() -> None:
    scene = bar(0.04, seconds=0.4)
    ends = [
        drape(scene.sheet, scene.positions, scene.phases, collider=scene.collider, contact=scene.contact)
        for _ in range(2)
    ]
    assert ends[0].positions.tobytes() == ends[1].positions.tobytes()
    assert ends[0].velocities.tobytes() == ends[1].velocities.tobytes()


class _Stopped(Exception):
    pass


def test_resumed_run_gives_the_bits_of_an_uninterrupted_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(drape_run, "CHECKPOINT_SECONDS", 0.0)  # after every frame
    scene = bar(0.04, seconds=0.4)
    file = tmp_path / "run.npz"

    def run(frames: list[np.ndarray], *, stop_at: int | None = None, checkpoint: Path | None = None):
        def on_frame(index: int, x: np.ndarray) -> None:
            assert index == len(frames)
            frames.append(x)
            if index == stop_at:
                raise _Stopped

        kinds = {"collider": scene.collider, "contact": scene.contact, "on_frame": on_frame}
        return drape(scene.sheet, scene.positions, scene.phases, **kinds, checkpoint=checkpoint)

    whole: list[np.ndarray] = []
    expected = run(whole)
    with pytest.raises(_Stopped):
        run([], stop_at=8, checkpoint=file)
    assert file.is_file()
    resumed: list[np.ndarray] = []
    result = run(resumed, checkpoint=file)
    assert result.positions.tobytes() == expected.positions.tobytes()
    assert result.velocities.tobytes() == expected.velocities.tobytes()
    assert (result.frames, result.substeps) == (expected.frames, expected.substeps)
    assert [f.tobytes() for f in resumed] == [f.tobytes() for f in whole]
    assert not file.exists()


def test_damaged_or_foreign_checkpoints_are_left_aside(tmp_path: Path) -> None:
    scene = hang_edge(0.2, seconds=0.08)
    file = tmp_path / "run.npz"
    expected = drape(scene.sheet, scene.positions, scene.phases, pins=scene.pins)
    for content in (b"", b"PK\x03\x04 cut off"):
        file.write_bytes(content)
        end = drape(scene.sheet, scene.positions, scene.phases, pins=scene.pins, checkpoint=str(file))
        assert end.positions.tobytes() == expected.positions.tobytes()
    file.write_bytes(b"notes, not a state")
    with pytest.raises(SimCoreError, match="no state of a run"):
        drape(scene.sheet, scene.positions, scene.phases, pins=scene.pins, checkpoint=file)
    assert file.read_bytes() == b"notes, not a state"


def test_a_state_is_not_gone_on_from_with_another_second_material(tmp_path: Path) -> None:
    rest, faces = equilateral_sheet(0.2, 0.2, 0.1)
    kind = (np.arange(len(faces)) > 3).astype(np.int32)
    x, file = np.column_stack([rest, np.zeros(len(rest))]), tmp_path / "run.npz"

    def run(stretch: float, **more) -> np.ndarray:
        materials = [Material(0.05, 50.0), Material(0.05, stretch)]
        sheet = Sheet.of_corners(rest[faces], faces, materials, kind)
        return drape(sheet, x, [Phase(0.2)], pins=(0,), **more).positions

    run(50.0, checkpoint=Checkpoint(file, keep=True))
    assert run(500.0, checkpoint=file).tobytes() == run(500.0).tobytes()


def test_phase_ends_early_once_at_rest() -> None:
    sheet = Sheet.of(*equilateral_sheet(0.2, 0.2, 0.1), Material(0.05, 50.0))
    x = np.column_stack([sheet.rest, np.zeros(len(sheet.rest))])
    phases = [Phase(2.0, (0.0, 0.0), rest=1e-9, label="still"), Phase(0.08, (0.0, 0.0))]
    assert drape(sheet, x, phases).frames == RESTED + 2


def test_a_single_calm_frame_is_no_rest() -> None:
    """A cloth let go hardly moves at first, and as little where it turns back."""
    sheet = Sheet.of(*equilateral_sheet(0.2, 0.2, 0.1), Material(0.05, 50.0))
    x = np.column_stack([sheet.rest[:, 0], np.zeros(len(sheet.rest)), sheet.rest[:, 1]])
    run = drape(sheet, x, [Phase(3.0, rest=0.009, damping=2.0)], pins=(0, 1, 2))
    calm = np.array([p99 < 0.009 for p99, _ in run.trace])
    assert calm[-RESTED:].all()
    assert len(calm) < 75  # it did come to rest
    firsts = [k for k in range(len(calm) - RESTED) if calm[k]]
    assert firsts  # and was calm before, for less than that
    assert not any(calm[k : k + RESTED].all() for k in range(len(calm) - RESTED))


def test_bad_input_is_named() -> None:
    scene = hang_edge(0.25, seconds=0.04)
    sheet, x, phases = scene.sheet, scene.positions, scene.phases
    with pytest.raises(SimCoreError, match="positions: shape"):
        drape(sheet, x[:-1], phases)
    broken = x.copy()
    broken[3, 1] = np.inf
    with pytest.raises(SimCoreError, match="positions: vertex 3 is not finite"):
        drape(sheet, broken, phases)
    with pytest.raises(SimCoreError, match="velocities: shape"):
        drape(sheet, x, phases, velocities=np.zeros(3))
    with pytest.raises(SimCoreError, match="pins: index 99"):
        drape(sheet, x, phases, pins=[99])
    with pytest.raises(SimCoreError, match="phases"):
        drape(sheet, x, [])
    with pytest.raises(SimCoreError, match="halfspace.normal"):
        drape(sheet, x, phases, collider=HalfSpace((0, 0, 0), (0, 0, 0)))


def test_a_hurricane_stretches_and_does_not_break() -> None:
    """140 m/s: edges of three times their length and more, which half the step confirms, and not a frame refused."""
    made = scene("flag", vertices=60, frames=5, wind=(100.0, 0.0, 100.0))
    end = drape(made.sheet, made.positions, made.phases, pins=made.pins, air=made.air)
    assert np.isfinite(end.positions).all()
    assert 3.0 < end.worst_stretch < 8.0


def test_a_cloth_of_four_faces_falls_without_a_warning() -> None:
    made = scene("hanging", vertices=12, size=(1.0, 1.0), frames=5)
    end = drape(made.sheet, made.positions, made.phases, pins=made.pins)
    assert 1.0 < end.worst_stretch < 1.5
