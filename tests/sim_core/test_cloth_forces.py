"""The solver's forces: gradient of the energy, invariance, conservation, patch test, bending calibration."""

import numpy as np
import pytest

from sim_core.cloth import Material, Phase, Sheet, drape
from sim_core.cloth.scenes import equilateral_sheet
from sim_core.cloth.sheet import edge_tensions, energies, vertex_forces
from sim_core.cloth.step import Engine, first_mode
from sim_core.errors import SimCoreError
from sim_core.mesh import panel_mesh

ORTHOTROPIC = Material(0.05, 80.0, 0.2, 1e-4, stretch_warp=300.0, shear=11.0)


def small(material: Material = ORTHOTROPIC, edge: float = 0.04) -> Sheet:
    return Sheet.of(*equilateral_sheet(0.2, 0.16, edge), material)


def forces(sheet: Sheet, x: np.ndarray) -> np.ndarray:
    strain, tension, out = np.zeros(len(sheet.edges)), np.zeros(len(sheet.edges)), np.zeros_like(x)
    edge_tensions(sheet.stencil, x, np.zeros_like(x), 0.0, strain, tension)
    vertex_forces(sheet.stencil, x, tension, out)
    return out


def flat(sheet: Sheet) -> np.ndarray:
    return np.column_stack([sheet.rest, np.zeros(len(sheet.rest))])


def test_forces_are_the_gradient_of_the_energy(rng: np.random.Generator) -> None:
    sheet = small()
    x = flat(sheet) + rng.normal(0, 0.004, (len(sheet.rest), 3))
    force, v = forces(sheet, x), np.zeros_like(x)
    for vertex in rng.choice(len(x), 6, replace=False):
        for axis in range(3):
            step = np.zeros_like(x)
            step[vertex, axis] = 1e-6
            slope = (
                sum(energies(sheet.stencil, x + step, v)) - sum(energies(sheet.stencil, x - step, v))
            ) / 2e-6
            assert force[vertex, axis] == pytest.approx(-slope, abs=1e-6 * np.abs(force).max() + 1e-9)


def test_energy_is_the_exact_saint_venant_membrane(rng: np.random.Generator) -> None:
    sheet = small()
    x = flat(sheet) + rng.normal(0, 0.01, (len(sheet.rest), 3))
    total = 0.0
    for face in sheet.faces:
        e, f = (sheet.rest[face[1:]] - sheet.rest[face[0]]).T, (x[face[1:]] - x[face[0]]).T
        gradient = f @ np.linalg.inv(e)
        green = (gradient.T @ gradient - np.eye(2)) / 2
        g = np.array([green[0, 0], green[1, 1], green[0, 1]])
        total += abs(np.linalg.det(e)) / 4 * g @ sheet.material.elasticity() @ g
    assert energies(sheet.stencil, x, np.zeros_like(x))[0] == pytest.approx(total, rel=1e-11)


def test_rigid_motion_gives_no_force() -> None:
    sheet = small()
    a, b = 0.7, -1.1
    turn = np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]])
    tilt = np.array([[1, 0, 0], [0, np.cos(b), -np.sin(b)], [0, np.sin(b), np.cos(b)]])
    assert np.abs(forces(sheet, flat(sheet) @ (turn @ tilt) + [3.0, -2.0, 5.0])).max() < 1e-11


def test_affine_stretch_leaves_inner_vertices_in_balance() -> None:
    """Patch test, on an irregular mesh."""
    panel = panel_mesh(np.array([[0, 0], [0.3, 0], [0.33, 0.25], [0.02, 0.2]]), edge=0.04)
    sheet = Sheet.of(panel.vertices, panel.faces, ORTHOTROPIC)
    x = flat(sheet) @ np.array([[1.1, 0.05, 0.2], [-0.08, 0.93, 0.1], [0, 0, 1]])
    inner = np.setdiff1d(np.arange(len(x)), np.concatenate(panel.boundary))
    assert len(inner) > 5
    assert np.abs(forces(sheet, x)[inner]).max() < 1e-12 * ORTHOTROPIC.stretch * 0.04  # 1e-12 k h
    assert np.abs(forces(sheet, x)).max() > 1e-3


def test_momentum_and_energy_are_conserved_without_damping(rng: np.random.Generator) -> None:
    material = Material(0.05, 50.0, 0.3, 5e-5, mass_damping=0.0, stiffness_damping=0.0)
    sheet = small(material)
    x, v = flat(sheet) * 1.03, rng.normal(0, 0.05, (len(sheet.rest), 3))
    before = sum(energies(sheet.stencil, x, v))
    end = drape(sheet, x, [Phase(0.4, (0.0, 0.0))], velocities=v, substeps=800)
    momentum = sheet.mass @ v
    assert sheet.mass @ end.velocities == pytest.approx(momentum, abs=1e-13)
    spin = (sheet.mass[:, None] * np.cross(x, v)).sum(0)
    spin_after = (sheet.mass[:, None] * np.cross(end.positions, end.velocities)).sum(0)
    assert spin_after == pytest.approx(spin, abs=2e-3 * np.abs(spin).max())  # v lies half a step behind x
    assert sum(energies(sheet.stencil, end.positions, end.velocities)) == pytest.approx(before, rel=0.02)


def test_stiffness_damping_is_the_rate_of_the_tension(rng: np.random.Generator) -> None:
    """T(x, v, beta) = T(x) + beta dT/dt; tensions are quadratic in x, so that central differences are exact."""
    sheet, beta = small(), 0.03
    x = flat(sheet) + rng.normal(0, 0.004, (len(sheet.rest), 3))
    v = rng.normal(0, 1.0, x.shape)

    def tensions(x: np.ndarray, v: np.ndarray, beta: float) -> np.ndarray:
        strain, tension = np.zeros(len(sheet.edges)), np.zeros(len(sheet.edges))
        edge_tensions(sheet.stencil, x, v, beta, strain, tension)
        return tension

    rate = (tensions(x + 0.5 * v, v, 0.0) - tensions(x - 0.5 * v, v, 0.0)) / 1.0
    damped = tensions(x, v, beta) - tensions(x, v, 0.0)
    assert damped == pytest.approx(beta * rate, rel=1e-9, abs=1e-9 * np.abs(damped).max())


@pytest.mark.parametrize("damping", [0.0, 2.0, 30.0])
def test_mass_damping_bounds_the_speed_of_a_fall(damping: float) -> None:
    """v = g/d (1 - exp(-d t)), g t without damping; every vertex alike."""
    sheet = small(Material(0.05, 50.0, 0.3, 5e-5, mass_damping=0.0, stiffness_damping=0.0))
    end = drape(sheet, flat(sheet), [Phase(0.2, damping=damping)], substeps=200)
    v, passed = end.velocities, 0.2 - 0.5 * 0.04 / 200  # v lives half a step behind x
    wanted = 9.81 * passed if damping == 0 else 9.81 / damping * (1 - np.exp(-damping * passed))
    assert v[:, 1] == pytest.approx(-wanted, rel=1e-4)
    assert np.abs(v[:, [0, 2]]).max() < 1e-9


def test_stable_step_is_stable_and_not_far_from_the_limit() -> None:
    sheet = small(Material(0.05, 50.0, 0.3, 5e-5, mass_damping=0.0, stiffness_damping=0.0))
    x = flat(sheet)
    x[:, 2] += 1e-6 * np.random.default_rng(3).standard_normal(len(x))
    engine = Engine(sheet)
    limit = 0.04 / engine.step((), engine.inward(x), first_mode(len(x)), first=True)
    calm = drape(sheet, x, [Phase(0.4, (0.0, 0.0))], substeps=int(limit / 0.9) + 1)
    assert np.abs(calm.positions - x).max() < 1e-3
    wild = drape(sheet, x, [Phase(0.4, (0.0, 0.0))], substeps=int(limit / 1.3))
    assert not np.abs(wild.positions - x).max() < 1e-3


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"density": -1.0}, "density"),
        ({"stretch": float("nan")}, "stretch"),
        ({"poisson": 1.0}, "poisson"),
        ({"bend": -1e-6}, "bend"),
        ({"friction": float("inf")}, "friction"),
        ({"shear": 0.0}, "shear"),
    ],
)
def test_meaningless_materials_are_named(change: dict[str, float], word: str) -> None:
    with pytest.raises(SimCoreError, match=f"material.{word}"):
        Material(**{"density": 0.05, "stretch": 50.0, **change})


def test_bad_meshes_are_named() -> None:
    rest, faces = equilateral_sheet(0.2, 0.2, 0.1)
    with pytest.raises(SimCoreError, match=r"rest: shape .* expected \(V, 2\)"):
        Sheet.of(np.column_stack([rest, rest[:, 0]]), faces, ORTHOTROPIC)
    with pytest.raises(SimCoreError, match="faces: shape"):
        Sheet.of(rest, faces.astype(float), ORTHOTROPIC)
    with pytest.raises(SimCoreError, match="faces: index"):
        Sheet.of(rest[:-1], faces, ORTHOTROPIC)
    with pytest.raises(SimCoreError, match="not finite"):
        Sheet.of(np.where(np.arange(len(rest))[:, None] == 2, np.nan, rest), faces, ORTHOTROPIC)
    with pytest.raises(SimCoreError, match="belongs to no face"):
        Sheet.of(np.vstack([rest, [[1.0, 1.0]]]), faces, ORTHOTROPIC)
    with pytest.raises(SimCoreError, match="needle"):
        Sheet.of(np.array([[0, 0], [1, 0], [2, 1e-9]], float), np.array([[0, 1, 2]]), ORTHOTROPIC)
    with pytest.raises(SimCoreError, match="more than two faces"):
        Sheet.of(
            np.array([[0, 0], [1, 0], [0.5, 1], [0.5, -1], [0.4, 0.8]], float),
            np.array([[0, 1, 2], [0, 1, 3], [0, 1, 4]]),
            ORTHOTROPIC,
        )


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(11)
