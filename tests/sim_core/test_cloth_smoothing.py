"""Hopeless starts: smoothed into a sheet that hangs where a flat start does; every other start is left as it is."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial import Delaunay

from sim_core.cloth import Contact, Drape, HalfSpace, Holds, Live, Material, Phase, Sheet, drape
from sim_core.cloth.run import Run, RunState, Setup, Smoother, load_checkpoint, save_checkpoint, smoothed
from sim_core.cloth.scenes import GF_CM, equilateral_sheet, hang_edge
from sim_core.metrics import intersections

CLOTH = Material(0.05, 49.0, 0.3, 4.9e-5)


def thrown(x: np.ndarray, pins: tuple[int, ...], size: float, seed: int = 0) -> np.ndarray:
    """Every vertex but the pins moved by noise of `size` [m]."""
    wild = x + np.random.default_rng(seed).normal(0, size, x.shape)
    wild[list(pins)] = x[list(pins)]
    return wild


def ratios(sheet: Sheet, x: np.ndarray) -> np.ndarray:
    a, b = sheet.edges.T
    return np.sqrt(((x[a] - x[b]) ** 2).sum(1) / sheet.stencil.length2)


def irregular(h: float) -> Sheet:
    rest, _ = equilateral_sheet(1.0, 1.0, h)
    inner = ((rest > 1e-9) & (rest < rest.max(0) - 1e-9)).all(1)
    rest[inner] += np.random.default_rng(3).uniform(-0.3 * h, 0.3 * h, (inner.sum(), 2))
    faces = Delaunay(rest).simplices.astype(np.int64)
    a, b = rest[faces[:, 1]] - rest[faces[:, 0]], rest[faces[:, 2]] - rest[faces[:, 0]]
    return Sheet.of(rest, faces[np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) > 1e-9], CLOTH)


def hung(sheet: Sheet, x: np.ndarray, pins: tuple[int, ...]) -> Drape:
    return drape(sheet, x, [Phase(8.0, damping=2.0), Phase(6.0, damping=6.0)], pins=pins)


@pytest.mark.parametrize("size", [0.05, 0.3, 1.0])
def test_points_thrown_about_come_to_hang_as_a_flat_start_does(size: float) -> None:
    made = hang_edge(0.08)
    flat = hung(made.sheet, made.positions, made.pins)
    end = hung(made.sheet, thrown(made.positions, made.pins, size), made.pins)
    assert end.smoothed > 0.1
    assert flat.smoothed == 0.0
    assert np.linalg.norm(end.positions - flat.positions, axis=1).max() < 1e-3
    assert intersections(end.positions, made.sheet.faces) == 0
    assert end.fallbacks == end.rollbacks == 0


@pytest.mark.parametrize("held", ["edge", "corners", "nothing"])
@pytest.mark.parametrize("size", [0.3, 1.0])
def test_a_smoothed_start_is_a_sheet(held: str, size: float) -> None:
    sheet = irregular(0.08)
    flat = np.column_stack([sheet.rest[:, 0], np.zeros(len(sheet.rest)), sheet.rest[:, 1]])
    edge = np.flatnonzero(sheet.rest[:, 1] < 1e-9)
    pins = {"edge": edge, "corners": edge[[0, -1]], "nothing": edge[:0]}[held]
    for seed in range(3):
        wild = thrown(flat, tuple(pins), size, seed)
        x, length = smoothed(sheet, wild, pins.tolist())
        assert length > 0
        assert np.array_equal(x[pins], wild[pins])
        least, low, high, most = np.quantile(ratios(sheet, x), [0, 0.05, 0.95, 1])
        assert 0.9 < low < high < 1.1
        assert 0.5 < least < most < 2.0
        assert intersections(x, sheet.faces) == 0
        if held == "nothing":
            gone = sheet.mass @ (x - wild) / sheet.mass.sum()
            assert np.abs(gone).max() < 1e-6


def test_other_starts_are_left_to_the_bit() -> None:
    made = hang_edge(0.08)
    x, pins = made.positions, made.pins
    inverted = x * [-1.0, 1.0, 1.0] + [1.0, 0.0, 0.0]
    inverted[list(pins)] = x[list(pins)]  # a row of edges twelve times their length
    torn = x.copy()
    torn[-1] += 5.0
    shaken, wide = thrown(x, pins, 0.015), 4.0 * thrown(x, pins, 0.005)
    crumpled = 0.2 * thrown(x, (), 0.3)
    for start in (x, inverted, torn, shaken, wide, crumpled, 0.0 * x):
        there, length = smoothed(made.sheet, start, pins)
        assert length == 0.0
        assert there is start


def test_folded_squares_and_sheets_that_are_all_pins_are_left_alone() -> None:
    corner = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    square = Sheet.of(corner, np.array([[0, 1, 2], [0, 2, 3]]), CLOTH)
    folded = np.array([[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [2.0, 0.5, 0.5]])
    made = hang_edge(0.1)
    every = tuple(range(len(made.positions)))
    wild = thrown(made.positions, made.pins, 0.3)
    for sheet, start, pins in ((square, folded, (0,)), (made.sheet, wild, every)):
        there, length = smoothed(sheet, start, pins)
        assert length == 0.0
        assert there is start


def test_solids_holds_and_the_certifier_leave_a_start_as_it_is() -> None:
    made = hang_edge(0.1)
    x, count = thrown(made.positions, made.pins, 0.3), len(made.positions)

    def begun(**kinds: Any) -> RunState:
        run = Run(Setup(made.sheet, [Phase(0.04)], pins=made.pins, **kinds))
        return run.begun(x, np.zeros_like(x))

    assert begun().smoothed > 0
    assert begun(contact=Contact(thickness=0.002)).smoothed > 0  # it passes through itself nowhere
    for kinds in (
        {"collider": HalfSpace((0.0, -5.0, 0.0))},
        {"holds": Holds.of(count, low=np.full(count, -9.0))},
        {"holds": Holds.of(count, limit=(0.03, 0.02))},
        {"holds": Holds.of(count, pairs=np.array([[0, 5]]), positions=x)},
    ):
        state = begun(**kinds)
        assert state.smoothed == 0.0
        assert state.positions is x


def test_a_start_of_layers_that_touch_has_no_crossing_on_its_way() -> None:
    made = hang_edge(0.1)
    live = Live(
        made.sheet,
        thrown(made.positions, made.pins, 0.3),
        pins=made.pins,
        contact=Contact(thickness=0.002),
        damping=2.0,
    )
    assert live.smoothed > 0
    assert max(intersections(live.step(), made.sheet.faces) for _ in range(15)) == 0


def test_waves_are_let_through_by_their_length() -> None:
    """1 / (1 + (k l)^4) of a wave is left, and all of what is flat."""
    sheet = Sheet.of(*equilateral_sheet(3.0, 0.4, 0.03), CLOTH)
    u = sheet.rest[:, 0]
    for length, share in ((0.05, 1 / (1 + 0.5**4)), (0.1, 0.5), (0.2, 1 / (1 + 2.0**4))):
        wave = np.column_stack([sheet.rest, 0.01 * np.cos((u - 1.5) / 0.1)])
        found = Smoother(sheet, wave, np.zeros(0, np.int64)).low_pass(length)
        middle = np.abs(u - 1.5) < 0.25
        left = found[middle, 2] @ wave[middle, 2] / (wave[middle, 2] @ wave[middle, 2])
        assert left == pytest.approx(share, abs=0.02)
        assert np.abs(found[:, :2] - sheet.rest).max() < 1e-9


def test_a_state_keeps_what_was_smoothed(tmp_path: Path) -> None:
    x = np.zeros((4, 3))
    save_checkpoint(tmp_path / "run", "key", RunState(x, x, smoothed=0.25))
    again = load_checkpoint(tmp_path / "run", "key")
    assert again is not None
    assert again.smoothed == 0.25


def test_a_run_from_a_hopeless_start_is_gone_on_with_to_the_bit(tmp_path: Path) -> None:
    made, file = hang_edge(0.2), tmp_path / "run.npz"
    x = thrown(made.positions, made.pins, 0.5)

    def run(**more) -> Drape:
        return drape(made.sheet, x, [Phase(0.4)], pins=made.pins, **more)

    def stopped(index: int, _: np.ndarray) -> None:
        if index == 4:
            raise KeyboardInterrupt

    whole = run(on_frame=lambda *_: None)
    with pytest.raises(KeyboardInterrupt):
        run(on_frame=stopped, checkpoint=file)
    end = run(on_frame=lambda *_: None, checkpoint=file)
    assert end.positions.tobytes() == whole.positions.tobytes()
    assert end.smoothed == whole.smoothed > 0


def test_a_heavy_hem_does_not_move_the_smoothing() -> None:
    """The start is weighed by mass; that of a thousandfold density is smoothed as well as the light one."""
    made = hang_edge(0.1)
    heavy = Sheet.of(made.sheet.rest, made.sheet.faces, replace(GF_CM, density=50.0))
    wild = thrown(made.positions, made.pins, 0.3)
    (a, first), (b, second) = (smoothed(sheet, wild, made.pins) for sheet in (made.sheet, heavy))
    assert first == second
    assert np.abs(a - b).max() < 1e-9
