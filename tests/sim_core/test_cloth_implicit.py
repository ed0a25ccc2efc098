"""Backward Euler: its step is the minimum it claims, its error falls with the step, it recovers bad starts."""

import numpy as np
import pytest

from sim_core.cloth import HalfSpace, Material, Phase, Sheet, drape
from sim_core.cloth.scenes import equilateral_sheet, hang_edge
from sim_core.cloth.step import Engine, Factored, Frame, State, Stride
from sim_core.errors import SimCoreError

CLOTH = Material(0.05, 80.0, 0.2, 1e-4, stretch_warp=300.0, shear=11.0, stiffness_damping=1e-3)


def small() -> tuple[Engine, np.ndarray]:
    sheet = Sheet.of(*equilateral_sheet(0.2, 0.2, 0.05), CLOTH)
    engine = Engine(sheet)
    flat = np.column_stack([sheet.rest[:, 0], np.zeros(len(sheet.rest)), sheet.rest[:, 1]])
    return engine, engine.inward(flat + np.random.default_rng(2).normal(0, 0.003, flat.shape))


BLOWN, WIND = Frame(np.array([0.0, -9.81, 0.0]), damping=0.5, friction=0.0, press=0.1), np.array([1.0, 0, 0])


def test_a_converged_step_is_where_the_gradient_vanishes() -> None:
    engine, x = small()
    start, h, inverse = State(x, np.zeros_like(x)), 0.005, engine.inverse_mass((0, 3))
    solver = engine.implicit
    now = solver.step(BLOWN, WIND, start, inverse, h, 30)
    problem = solver.problem(BLOWN, WIND, start, h)
    gradient = solver.gradient(problem, now)
    assert np.abs(gradient[:, inverse > 0]).max() < 1e-8
    for vertex in (5, 9):  # the gradient is that of the energy
        at = solver.gradient(problem, x)[:, vertex].copy()
        for axis in range(3):
            step = np.zeros_like(x)
            step[axis, vertex] = 1e-7
            ends = [solver.energy(problem, x + s * step) for s in (1, -1)]
            assert at[axis] == pytest.approx((ends[0] - ends[1]) / 2e-7, rel=1e-4, abs=1e-6)


def test_error_falls_with_the_step() -> None:
    scene = hang_edge(0.05, seconds=0.2)
    kinds = {"pins": scene.pins}
    true = drape(scene.sheet, scene.positions, scene.phases, substeps=400, **kinds).positions
    off = [
        np.linalg.norm(
            drape(
                scene.sheet, scene.positions, scene.phases, integrator="implicit", substeps=n, **kinds
            ).positions
            - true,
            axis=1,
        ).mean()
        for n in (8, 16, 32)
    ]
    assert off[0] < 0.004
    assert off[1] < 0.6 * off[0]
    assert off[2] < 0.6 * off[1]


def test_it_lands_on_a_floor_and_stays() -> None:
    sheet = Sheet.of(*equilateral_sheet(0.2, 0.2, 0.04), CLOTH)
    start = np.column_stack([sheet.rest[:, 0], np.full(len(sheet.rest), 0.05), sheet.rest[:, 1]])
    end = drape(sheet, start, [Phase(1.0, damping=5.0)], collider=HalfSpace(), integrator="implicit")
    assert end.positions[:, 1].min() > 0.0029
    assert end.positions[:, 1].max() < 0.004
    assert end.rest_max < 1e-4


def test_a_random_start_comes_back_to_a_sheet_that_hangs() -> None:
    """Points thrown about by 5 cm; the edges are torn to many times their length and come back."""
    scene = hang_edge(0.1, seconds=0.4)
    wild = scene.positions + np.random.default_rng(4).normal(0, 0.05, scene.positions.shape)
    wild[list(scene.pins)] = scene.positions[list(scene.pins)]
    end = drape(scene.sheet, wild, [Phase(3.0, damping=5.0)], pins=scene.pins)
    calm = drape(scene.sheet, scene.positions, [Phase(3.0, damping=5.0)], pins=scene.pins)
    assert np.isfinite(end.positions).all()
    assert end.positions[:, 1].min() == pytest.approx(calm.positions[:, 1].min(), abs=0.1)


def test_unknown_integrators_are_named() -> None:
    scene = hang_edge(0.25, seconds=0.04)
    with pytest.raises(SimCoreError, match="integrator: 'magic'"):
        drape(scene.sheet, scene.positions, scene.phases, integrator="magic")
    with pytest.raises(SimCoreError, match="substeps: 0"):
        drape(scene.sheet, scene.positions, scene.phases, substeps=0)


def test_factors_solve_the_matrix() -> None:
    engine, _ = small()
    membrane, bend = engine.implicit._matrix
    from scipy import sparse

    matrix = (sparse.diags_array(engine.sheet.mass / 1e-4) + membrane + bend).tocsc()
    b = np.random.default_rng(1).normal(size=(matrix.shape[0], 3))
    assert np.abs(matrix @ Factored(matrix).solve(b) - b).max() < 1e-10


def test_pulls_and_gravity_move_a_free_sheet_as_newton_says() -> None:
    engine, x = small()
    rest = engine.inward(np.column_stack([engine.sheet.rest, np.zeros(len(x[0]))])[np.argsort(engine.order)])
    v, mass = np.zeros_like(rest), engine.sheet.mass.sum()
    pull = {"pulled": np.array([3]), "pulls": np.array([[0.0, 0.02, 0.0]])}
    frame = Frame(np.array([0.0, -9.81, 0.0]), damping=0.0, friction=0.0, **pull)
    for scheme in ("explicit", "implicit"):
        state = State(rest.copy(), v.copy())
        if scheme == "explicit":
            engine.advance(frame, state, Stride(4000, 0.0))
        else:
            engine.advance_implicit(frame, state, 8)
        expected = (0.02 - 9.81 * mass) * 0.04
        speed = (engine.sheet.mass * state.v[1]).sum()
        assert speed == pytest.approx(expected, rel=0.01)
