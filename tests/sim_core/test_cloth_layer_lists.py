"""Lists of what may touch go on from frame to frame, and tell for sure where nothing crosses."""

from typing import Any

import numpy as np
import pytest

from sim_core import metrics
from sim_core.cloth import Contact, Material, Phase, Sheet
from sim_core.cloth.contact import none_crosses
from sim_core.cloth.run import Run, Setup
from sim_core.cloth.scenes import equilateral_sheet

CLOTH = Material(0.05, 50.0, 0.3, 1e-6, 0.3, 1.0)
LAYERS = Contact(thickness=0.003, untangle=20)
FRAMES = 16


def sinking() -> tuple[Run, Any]:
    """A sheet that sinks slowly onto another, which is held, from 5 mm above it; the first state of its run."""
    rest, faces = equilateral_sheet(0.2, 0.2, 0.019)
    count = len(rest)
    sheet = Sheet.of(np.concatenate([rest, rest + [0.3, 0.0]]), np.concatenate([faces, faces + count]), CLOTH)
    flat = np.column_stack([rest[:, 0], np.zeros(count), rest[:, 1]])
    x = np.concatenate([flat, flat + [0.004, 0.005, 0.003]])
    phases, held = [Phase(FRAMES / 25, (0.5, 0.5), damping=30.0)], list(range(count))
    run = Run(Setup(sheet, phases, pins=held, contact=LAYERS))
    return run, run.begun(x, np.zeros_like(x))


def test_lists_that_go_on_give_the_bits_of_lists_begun_anew() -> None:
    """What an interrupted run begins anew, a whole one has kept; they touched in the same order."""
    (kept, one), (anew, two) = sinking(), sinking()
    went_on = 0
    for _ in range(FRAMES):
        kept.frame(one)
        went_on += kept.engine.near.kept[2] == 1.0
        anew.frame(two)
        anew.engine.near.kept[:] = 0.0
    assert went_on > 0
    np.testing.assert_array_equal(one.positions, two.positions)
    np.testing.assert_array_equal(one.velocities, two.velocities)


def test_who_is_sure_that_nothing_crosses_is_right() -> None:
    run, state = sinking()
    engine, sure = run.engine, 0
    for _ in range(FRAMES):
        run.frame(state)
        x = state.positions[engine.order]
        if none_crosses(x, engine.mesh, engine.third, engine.near, LAYERS.thickness):
            sure += 1
            assert metrics.intersections(x, engine.mesh.faces) == 0
    assert sure > 0


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
