"""Stepping by hand, and mending of meshes."""

import numpy as np
import pytest
from full_matrix import by_day

from sim_core.cloth import Air, Contact, HalfSpace, Live, Material, Phase, Sheet, drape
from sim_core.cloth.scenes import equilateral_sheet
from sim_core.cloth.sheet import mended
from sim_core.cloth.step import MOST_PINNED, Engine, State
from sim_core.errors import SimCoreError

CLOTH = Material(0.05, 50.0, 0.3, 5e-5)


def hung(**more) -> tuple[Live, Sheet, np.ndarray, list[int]]:
    rest, faces = equilateral_sheet(0.2, 0.2, 0.05)
    sheet = Sheet.of(rest, faces, CLOTH)
    start = np.column_stack([rest[:, 0], -rest[:, 1], np.zeros(len(rest))])
    pins = np.flatnonzero(rest[:, 1] < 1e-9).tolist()
    return Live(sheet, start, pins=pins, **more), sheet, start, pins


def test_frame_by_frame_is_the_run_in_one_go() -> None:
    live, sheet, start, pins = hung(air=Air((2.0, 0.0, 1.0), gusts=0.3, seed=3))
    for _ in range(6):
        live.step()
    end = drape(sheet, start, [Phase(0.24)], pins=pins, air=Air((2.0, 0.0, 1.0), gusts=0.3, seed=3))
    assert live.positions == pytest.approx(end.positions, abs=1e-9)
    assert live.frame == 6


def test_pins_go_where_they_are_led_and_are_let_go() -> None:
    live, _, start, pins = hung()
    there = start[pins] + [0.0, 0.0, 0.03]
    x = live.step(targets=there)
    assert x[pins] == pytest.approx(there, abs=1e-12)
    x = live.step()
    assert x[pins] == pytest.approx(there, abs=1e-12)
    for _ in range(5):
        x = live.step(pins=pins[:1])
    assert x[pins[0]] == pytest.approx(there[0], abs=1e-12)
    assert x[pins[1:], 1].max() < start[pins[1:], 1].min() - 0.005


@pytest.mark.nightly
@pytest.mark.parametrize("seed", by_day([0], [0, 3]))
def test_pins_thrown_about_within_a_frame_do_not_break_layers(seed: int) -> None:
    """Neighbouring pins are torn apart by several edges: the frame is done again, and the cloth slows down after."""
    rest, faces = equilateral_sheet(1.0, 1.0, 0.05)
    sheet = Sheet.of(rest, faces, CLOTH)
    start = np.column_stack([rest[:, 0], -rest[:, 1], np.zeros(len(rest))])
    pins = np.flatnonzero(rest[:, 1] < 1e-9).tolist()
    live, thrown = (
        Live(sheet, start, pins=pins, contact=Contact(thickness=0.004)),
        np.random.default_rng(seed),
    )
    live.step(targets=start[pins] + 0.05 * thrown.standard_normal((len(pins), 3)))
    engine = live._run.engine

    def stored() -> float:
        return engine.stored(State(engine.inward(live.positions), engine.inward(live.velocities)))

    energy = [stored()]
    for _ in range(10):
        live.step()
        energy.append(stored())
    fall = sheet.mass.sum() * 9.81 * 0.5  # [J] that gravity may still give
    assert max(energy[1:]) < energy[0] + fall
    assert np.linalg.norm(live.velocities, axis=1).max() < 15.0  # [m/s]; tight threads sound on


def test_wind_and_pulls_move_it_the_way_they_go() -> None:
    live, _, start, _ = hung()
    low = int(np.argmin(start[:, 1]))
    for _ in range(4):
        x = live.step(pulls=(np.array([low]), np.array([[0.0, 0.0, 0.01]])))
    assert x[low, 2] > 0.002
    blown, _, _, _ = hung()
    for _ in range(4):
        x = blown.step(wind=(0.0, 0.0, -3.0))
    assert x[:, 2].min() < -0.002
    assert x[:, 2].max() < 1e-3


def test_what_cannot_be_done_is_named() -> None:
    live, sheet, start, _ = hung()
    with pytest.raises(SimCoreError, match="targets: shape"):
        live.step(targets=np.zeros((2, 2)))
    with pytest.raises(SimCoreError, match="pulls: vertices: index 999"):
        live.step(pulls=(np.array([999]), np.zeros((1, 3))))
    with pytest.raises(SimCoreError, match="pins: index 999"):
        live.step(pins=[999])
    with pytest.raises(SimCoreError, match="positions"):
        Live(sheet, start[:-1])
    with pytest.raises(SimCoreError, match="air.wind"):
        Air((float("nan"), 0.0, 0.0))


def test_mended_meshes_have_no_doubles_and_no_empty_faces() -> None:
    rest, faces = equilateral_sheet(0.2, 0.2, 0.05)
    torn, alone = rest[faces].reshape(-1, 2), np.arange(3 * len(faces)).reshape(-1, 3)
    flat = np.vstack([torn, torn[0] * 0.5 + torn[1] * 0.5])
    alone = np.vstack([alone, [0, 1, len(torn)], alone[0]])
    points, index, number = mended(flat, alone)
    assert len(points) == len(rest)
    assert len(index) == len(faces)
    assert number[-1] == -1
    assert points[number[:-1]] == pytest.approx(torn, abs=1e-6)
    assert Sheet.of(points, index, CLOTH).mass.sum() == pytest.approx(Sheet.of(rest, faces, CLOTH).mass.sum())
    with pytest.raises(SimCoreError, match="empty once mended"):
        mended(np.zeros((3, 2)), np.array([[0, 1, 2]]))


def test_a_falling_cloth_meets_a_floor_in_live_mode() -> None:
    rest, faces = equilateral_sheet(0.2, 0.2, 0.05)
    start = np.column_stack([rest[:, 0], np.full(len(rest), 0.02), rest[:, 1]])
    live = Live(Sheet.of(rest, faces, CLOTH), start, collider=HalfSpace(), contact=Contact(clearance=0.003))
    for _ in range(10):
        x = live.step()
    assert x[:, 1].min() > 0.0029
    assert x[:, 1].max() < 0.01


@pytest.mark.parametrize("compiled", [False, True])
def test_an_interrupt_in_the_midst_of_a_frame_leaves_the_state_as_it_was(
    compiled: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Compiled code comes back from Ctrl-C with SystemErrors, the interrupt the cause of the first."""
    from sim_core.cloth.scenes import scene
    from sim_core.cloth.step import Engine

    def stopped(*_: object, **__: object) -> None:
        if compiled:
            inner = SystemError("returned a result with an exception set")
            inner.__cause__ = KeyboardInterrupt()
            raise SystemError("and so did its caller") from inner
        raise KeyboardInterrupt

    made = scene("hanging", vertices=100)
    live = Live(made.sheet, made.positions, pins=made.pins)
    live.step()
    state = live._state
    before = state.mode.tobytes(), state.positions.tobytes(), state.safety, state.rollbacks, state.frame
    with monkeypatch.context() as patch:
        patch.setattr(Engine, "advance", stopped)
        with pytest.raises(KeyboardInterrupt):
            live.step()
    after = state.mode.tobytes(), state.positions.tobytes(), state.safety, state.rollbacks, state.frame
    assert after == before


def test_what_a_loop_leaves_half_written_does_not_matter(monkeypatch: pytest.MonkeyPatch) -> None:
    """The lists of layers in particular, which go on from frame to frame."""
    cloth, twin = (hung(contact=Contact(thickness=0.003))[0] for _ in range(2))
    for _ in range(2):
        assert np.array_equal(cloth.step(), twin.step())

    def stopped(engine: Engine, *_: object) -> None:
        for part in (*engine.near.now[:5], engine.near.now.mark):
            part[:] = 2**20
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(Engine, "advance", stopped)
        with pytest.raises(KeyboardInterrupt):
            cloth.step()
    for _ in range(3):
        assert np.array_equal(cloth.step(), twin.step())


def test_pins_may_draw_cloth_out_slowly_to_any_length() -> None:
    live, _, start, pins = hung()
    middle = start[pins].mean(0)
    for far in np.linspace(1.0, 3.5, 60):
        x = live.step(targets=middle + far * (start[pins] - middle))
    assert np.isfinite(x).all()


def test_pins_that_change_for_ever_take_no_more_room() -> None:
    _, sheet, start, _ = hung()
    engine = Engine(sheet)
    for pin in range(len(start)):
        engine.inverse_mass((pin,))
    assert len(engine._inverse) <= MOST_PINNED < len(start)
    held = engine.inverse_mass((3,))
    assert np.flatnonzero(held == 0.0).tolist() == [engine.number[3]]
    assert (engine.inverse_mass(()) > 0.0).all()
