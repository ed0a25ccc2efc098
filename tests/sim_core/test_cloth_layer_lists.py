"""Lists of what may touch go on from frame to frame, and tell for sure where nothing crosses."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from sim_core import metrics
from sim_core.cloth import Contact, Material, Pace, Phase, Sheet
from sim_core.cloth.contact import none_crosses
from sim_core.cloth.run import Run, Setup
from sim_core.cloth.scenes import equilateral_sheet

CLOTH = Material(0.05, 50.0, 0.3, 1e-6, 0.3, 1.0)
LAYERS = Contact(thickness=0.003, untangle=20)
FRAMES = 16


def sinking(precision: str = "double", at: float = 0.0) -> tuple[Run, Any]:
    """A sheet that sinks slowly onto another, which is held, from 5 mm above it; the first state of its run.

    at [m]: how far from the origin.
    """
    rest, faces = equilateral_sheet(0.2, 0.2, 0.019)
    count = len(rest)
    sheet = Sheet.of(np.concatenate([rest, rest + [0.3, 0.0]]), np.concatenate([faces, faces + count]), CLOTH)
    flat = np.column_stack([rest[:, 0], np.zeros(count), rest[:, 1]])
    x = np.concatenate([flat, flat + [0.004, 0.005, 0.003]])
    phases, held = [Phase(FRAMES / 25, (0.5, 0.5), damping=30.0)], list(range(count))
    run = Run(Setup(sheet, phases, pins=held, contact=LAYERS, pace=Pace(precision)))
    return run, run.begun(x + [at, 0.0, 0.0], np.zeros_like(x))


def closing(frames: int, edge: float = 0.019) -> tuple[Run, Any]:
    """A sheet bent over by half a turn 12 mm wide, whose upper half sinks onto the lower one, which is held."""
    rest, faces = equilateral_sheet(0.1, 0.3, edge)
    sheet, bend, radius = Sheet.of(rest, faces, CLOTH), 0.15, 0.006
    turned = np.clip((rest[:, 1] - bend) / radius, 0.0, np.pi)
    along = np.minimum(rest[:, 1], bend) - np.maximum(rest[:, 1] - bend - np.pi * radius, 0.0)
    x = np.column_stack([rest[:, 0], radius * (1 - np.cos(turned)), along + radius * np.sin(turned)])
    held = np.flatnonzero(rest[:, 1] < bend - 0.03).tolist()
    run = Run(Setup(sheet, [Phase(frames / 25, (3.0, 3.0), damping=5.0)], pins=held, contact=LAYERS))
    return run, run.begun(x, np.zeros_like(x))


def test_lists_that_go_on_give_the_bits_of_lists_begun_anew() -> None:
    """What an interrupted run begins anew, a whole one has kept; they touched in the same order."""
    (kept, one), (anew, two) = sinking(), sinking()
    went_on = 0
    for _ in range(FRAMES):
        kept.frame(one)
        went_on += kept.engine.near.kept[1] == 1.0
        anew.frame(two)
        anew.engine.near.kept[:] = 0.0
    assert went_on > 0
    np.testing.assert_array_equal(one.positions, two.positions)
    np.testing.assert_array_equal(one.velocities, two.velocities)


@pytest.mark.parametrize("edge", [0.019, 0.0085])
def test_a_run_that_is_resumed_anywhere_gives_the_bits_of_a_whole_one(edge: float) -> None:
    """Also while a fold closes, where it tells which stretches count as flat when they are looked at."""
    frames = 24
    (run, state), states = closing(frames, edge), []
    for _ in range(frames):
        states.append(replace(state, tally=replace(state.tally)))
        run.frame(state)
    assert run.engine.near.now.count[1:].min() > 0
    for begin in range(0, frames, 5):
        again, later = closing(frames, edge)[0], states[begin]
        for _ in range(begin, frames):
            again.frame(later)
        assert np.array_equal(later.positions, state.positions), begin


@pytest.mark.parametrize(("precision", "at"), [("double", 0.0), ("single", 0.0), ("single", 40.0)])
def test_who_is_sure_that_nothing_crosses_is_right(precision: str, at: float) -> None:
    run, state = sinking(precision, at)
    engine, sure = run.engine, 0
    for _ in range(FRAMES):
        run.frame(state)
        x = state.positions[engine.order]
        if none_crosses(x, engine.mesh, engine.third, engine.near, LAYERS.thickness):
            sure += 1
            assert metrics.intersections(x, engine.mesh.faces) == 0
    assert sure > FRAMES // 2


@pytest.mark.parametrize("way", [0.004, 0.01])
def test_nobody_is_sure_of_cloth_that_was_pushed_through_itself(way: float) -> None:
    run, state = sinking()
    for _ in range(FRAMES):
        run.frame(state)
    engine = run.engine
    x = state.positions[engine.order]
    x[(x[:, 1] > 0.001) & (x[:, 0] > 0.1), 1] -= way  # half of the upper sheet
    assert metrics.intersections(x, engine.mesh.faces) > 0
    assert not none_crosses(x, engine.mesh, engine.third, engine.near, LAYERS.thickness)
