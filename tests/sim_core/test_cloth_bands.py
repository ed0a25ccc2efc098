"""Runs of equal offsets: the fast loops are the forces of the book on every kind of mesh, in any numbering."""

import numpy as np
import pytest
from scipy.spatial import Delaunay

from sim_core.cloth import Air, Material, Phase, Sheet, drape
from sim_core.cloth.scenes import equilateral_sheet
from sim_core.cloth.sheet import edge_tensions, vertex_forces
from sim_core.cloth.step import Engine, first_mode, stiffness_times, tensions_at
from sim_core.cloth.step.kernels import band_air, band_bends, band_pulls, band_strains, band_tensions
from sim_core.mesh import panel_mesh

CLOTH = Material(0.05, 80.0, 0.2, 1e-4, stretch_warp=300.0, shear=11.0)


def scattered() -> tuple[np.ndarray, np.ndarray]:
    """An irregular mesh: valences from 3 to 11."""
    rng = np.random.default_rng(3)
    side = np.linspace(0, 0.4, 9)
    frame = np.array([(a, b) for a in side for b in side if a in (0, 0.4) or b in (0, 0.4)])
    points = np.concatenate([frame, rng.uniform(0.03, 0.37, (90, 2))])
    faces = Delaunay(points).simplices
    a, b = points[faces[:, 1]] - points[faces[:, 0]], points[faces[:, 2]] - points[faces[:, 0]]
    return points, faces[np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) > 1e-4].astype(np.int32)


def shuffled() -> tuple[np.ndarray, np.ndarray]:
    rest, faces = equilateral_sheet(0.4, 0.3, 0.04)
    new = np.random.default_rng(4).permutation(len(rest))
    return rest[np.argsort(new)], new[faces].astype(np.int32)


def grown() -> tuple[np.ndarray, np.ndarray]:
    panel = panel_mesh(np.array([[0, 0], [0.3, 0], [0.33, 0.25], [0.02, 0.2]]), edge=0.03)
    return panel.vertices, panel.faces


MESHES = pytest.mark.parametrize("make", [scattered, shuffled, grown])


def crumpled(sheet: Sheet) -> np.ndarray:
    flat = np.column_stack([sheet.rest, np.zeros(len(sheet.rest))])
    return flat + np.random.default_rng(5).normal(0, 0.004, flat.shape)


def banded_forces(engine: Engine, x: np.ndarray) -> np.ndarray:
    b, room, at = engine.bands, engine.room, tuple(engine.inward(x))
    band_strains(b.edge_runs, b.length2, at, room.strain)
    band_tensions(b.tension_runs, b.own, b.coupling, room.strain, room.tension)
    band_pulls(b.vertex_runs, room.tension, at, tuple(room.force))
    band_bends(b.bend_runs, b.bend, 1.0, at, tuple(room.force))
    return engine.outward(room.force)


def plain_forces(sheet: Sheet, x: np.ndarray) -> np.ndarray:
    strain, tension, out = np.zeros(len(sheet.edges)), np.zeros(len(sheet.edges)), np.zeros_like(x)
    edge_tensions(sheet.stencil, x, np.zeros_like(x), 0.0, strain, tension)
    vertex_forces(sheet.stencil, x, tension, out)
    return out


@MESHES
def test_runs_give_the_forces_of_the_book(make) -> None:
    sheet = Sheet.of(*make(), CLOTH)
    engine, x = Engine(sheet), crumpled(sheet)
    plain = plain_forces(sheet, x)
    assert np.abs(banded_forces(engine, x) - plain).max() < 1e-12 * np.abs(plain).max()


def test_a_regular_mesh_lies_in_few_runs_whatever_its_numbering() -> None:
    engine = Engine(Sheet.of(*shuffled(), CLOTH))
    rows = len(np.unique(engine.sheet.rest[:, 1]))
    assert len(engine.bands.edge_runs) <= 4 * rows
    assert len(engine.bands.vertex_runs) <= 6 * rows
    assert sum(int(n) for n in engine.bands.edge_runs[:, 1]) == len(engine.sheet.edges)


@MESHES
def test_tangent_is_the_derivative_of_the_force(make) -> None:
    sheet = Sheet.of(*make(), CLOTH)
    engine, x = Engine(sheet), crumpled(sheet)
    p = np.random.default_rng(6).normal(0, 1.0, x.shape)
    slope = (plain_forces(sheet, x + 1e-6 * p) - plain_forces(sheet, x - 1e-6 * p)) / 2e-6
    out, own = np.zeros((3, len(x))), engine.inward(x)
    tensions_at(engine.bands, engine.room, own)
    stiffness_times(engine.bands, engine.room, own, engine.inward(p), out)
    assert np.abs(engine.outward(out) - slope).max() < 1e-6 * np.abs(slope).max()


@MESHES
def test_air_on_the_faces_adds_up(make) -> None:
    """Against a sum over faces, one by one; forces on all vertices are those on all faces."""
    sheet = Sheet.of(*make(), CLOTH)
    engine, x, rng = Engine(sheet), crumpled(sheet), np.random.default_rng(7)
    v, wind, press = rng.normal(0, 2.0, x.shape), np.array([4.0, 0.5, 1.0]), 0.1
    expected = np.zeros_like(x)
    for f in sheet.faces:
        area = np.cross(x[f[1]] - x[f[0]], x[f[2]] - x[f[0]]) / 2
        size = np.linalg.norm(area)
        speed = (wind - v[f].mean(0)) @ area / size
        expected[f] += 12 * press / 2 * size * abs(speed) * speed * area / size / 3
    out, aside = np.zeros((3, len(x))), tuple(engine.room.face)
    at, speed = tuple(engine.inward(x)), tuple(engine.inward(v))
    band_air(engine.bands.face_runs, at, speed, 0.0, tuple(wind), press, tuple(out), aside)
    assert np.abs(engine.outward(out) - expected).max() < 1e-12 * np.abs(expected).max()


def test_power_iteration_finds_the_largest_eigenvalue() -> None:
    sheet = Sheet.of(*shuffled(), CLOTH)
    engine, x = Engine(sheet), crumpled(sheet)
    own, count = engine.inward(x), len(x)
    tensions_at(engine.bands, engine.room, own)
    matrix, out = np.zeros((3 * count, 3 * count)), np.zeros((3, count))
    for k in range(3 * count):
        unit = np.zeros((3, count))
        unit.flat[k] = 1.0
        stiffness_times(engine.bands, engine.room, own, unit, out)
        matrix[:, k] = -(out * engine.sheet.stencil.inverse_mass).ravel()
    exact = np.sqrt(np.linalg.eigvals(matrix).real.max())
    mode = first_mode(count)
    first = 2 / engine.step((), own, mode, first=True)
    later = [2 / engine.step((), own, mode, first=False) for _ in range(8)][-1]
    beta = CLOTH.stiffness_damping
    damped = 2 / (np.sqrt(beta**2 + 4 / exact**2) - beta)
    assert 0.9 * damped < first <= damped * 1.0001
    assert 0.97 * damped < later <= damped * 1.0001


def test_numbering_changes_no_more_than_the_rounding() -> None:
    rest, faces = equilateral_sheet(0.3, 0.3, 0.05)
    new = np.random.default_rng(8).permutation(len(rest))
    start = np.column_stack([rest[:, 0], np.zeros(len(rest)), rest[:, 1]])
    pins = np.flatnonzero(rest[:, 1] < 1e-9)
    old = np.argsort(new)
    one = drape(Sheet.of(rest, faces, CLOTH), start, [Phase(0.2)], pins=pins.tolist(), substeps=200)
    two = drape(
        Sheet.of(rest[old], new[faces].astype(np.int32), CLOTH),
        start[old],
        [Phase(0.2)],
        pins=new[pins].tolist(),
        substeps=200,
    )
    assert np.abs(two.positions[new] - one.positions).max() < 1e-12


def test_air_slows_a_falling_sheet_to_its_terminal_speed() -> None:
    """v = sqrt(2 rho g / (rho_air Cd)) for a stiff horizontal sheet, within 1 %."""
    rest, faces = equilateral_sheet(0.2, 0.2, 0.05)
    sheet = Sheet.of(rest, faces, Material(0.05, 500.0, 0.3, 1e-2, mass_damping=0.0))
    start = np.column_stack([rest[:, 0], np.zeros(len(rest)), rest[:, 1]])
    end = drape(sheet, start, [Phase(1.0)], air=Air(density=1.2, drag=1.0))
    assert end.velocities[:, 1].mean() == pytest.approx(-np.sqrt(2 * 0.05 * 9.81 / 1.2), rel=0.01)
