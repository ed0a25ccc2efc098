"""Bending on regular and irregular meshes: the curvature energy, what costs nothing, seams, several cloths."""

import numpy as np
import pytest
from scipy.spatial import Delaunay

from sim_core.cloth import Material, Sheet
from sim_core.cloth.scenes import disc, equilateral_sheet
from sim_core.cloth.sheet import energies
from sim_core.mesh import panel_mesh

SIDE, BEND = 0.6, 1e-4
CLOTH = Material(0.05, 1e-9, 0.0, BEND)


def squares(kind: str, count: int = 12) -> tuple[np.ndarray, np.ndarray]:
    """A grid of squares cut along one diagonal, along changing ones, or along both."""
    ticks = np.linspace(0, SIDE, count + 1)
    points, faces = [(a, b) for b in ticks for a in ticks], []
    for row in range(count):
        for column in range(count):
            a = row * (count + 1) + column
            b, c, d = a + 1, a + count + 1, a + count + 2
            if kind == "both":
                points.append(tuple(np.mean([points[a], points[d]], axis=0)))
                m = len(points) - 1
                faces += [(a, b, m), (b, d, m), (d, c, m), (c, a, m)]
            elif kind == "one" or (row + column) % 2:
                faces += [(a, b, d), (a, d, c)]
            else:
                faces += [(a, b, c), (b, d, c)]
    return np.array(points), np.array(faces, np.int32)


def scattered() -> tuple[np.ndarray, np.ndarray]:
    rng, ticks = np.random.default_rng(1), np.linspace(0, SIDE, 17)
    points = [(a, b) for a in ticks for b in ticks if a in (0, SIDE) or b in (0, SIDE)]
    while len(points) < 330:
        new = rng.uniform(0.02, SIDE - 0.02, 2)
        if np.hypot(*(np.array(points) - new).T).min() > 0.022:
            points.append(tuple(new))
    return np.array(points), Delaunay(np.array(points)).simplices.astype(np.int32)


def grown() -> tuple[np.ndarray, np.ndarray]:
    panel = panel_mesh(np.array([[0, 0], [SIDE, 0], [SIDE, SIDE], [0, SIDE]]), edge=0.035)
    return panel.vertices, panel.faces


MESHES = {
    "rows": lambda: equilateral_sheet(SIDE, SIDE, 0.035),
    "one diagonal": lambda: squares("one"),
    "changing diagonals": lambda: squares("changing"),
    "both diagonals": lambda: squares("both"),
    "scattered": scattered,
    "grown": grown,
    "disc": lambda: disc(SIDE, 0.035),
}
EACH = pytest.mark.parametrize("name", MESHES)


def stored(sheet: Sheet, height: np.ndarray) -> float:
    x = np.column_stack([sheet.rest, height])
    flat = np.column_stack([sheet.rest, 0 * height])
    v = np.zeros_like(x)
    # The quadratic form also measures the flat sheet's own coordinates, which are linear: nothing.
    return energies(sheet.stencil, x, v)[1] - energies(sheet.stencil, flat, v)[1]


@EACH
@pytest.mark.parametrize(
    "form",
    [np.diag([1.0, 0]), np.diag([0, 1.0]), np.full((2, 2), 0.5), np.diag([1.0, 1]), np.diag([1.0, -1])],
    ids=["along x", "along y", "along the diagonal", "dome", "saddle"],
)
def test_constant_curvature_stores_the_plates_energy(name: str, form: np.ndarray) -> None:
    """B/2 kappa:kappa per area, border and all; the bound asked for is 5 %."""
    sheet = Sheet.of(*MESHES[name](), CLOTH)
    middle = sheet.rest - sheet.rest.mean(0)
    kappa = 0.5 * form
    height = 0.5 * np.einsum("ni,ij,nj->n", middle, kappa, middle)
    a, b = (sheet.rest[sheet.faces[:, k]] - sheet.rest[sheet.faces[:, 0]] for k in (1, 2))
    area = 0.5 * np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum()
    assert stored(sheet, height) == pytest.approx(BEND / 2 * (kappa**2).sum() * area, rel=1e-6)


@EACH
def test_only_flat_sheets_cost_nothing(name: str) -> None:
    """Three motions of the heights are free: up and the two tilts; no other is, nor nearly so."""
    sheet = Sheet.of(*MESHES[name](), CLOTH)
    s, count = sheet.stencil, len(sheet.rest)
    matrix = np.zeros((count, count))
    own = np.repeat(np.arange(count), np.diff(s.rows))
    np.add.at(matrix, (own, s.neighbour), s.bend)
    matrix[np.arange(count), np.arange(count)] -= matrix.sum(1)
    low = np.linalg.eigvalsh(matrix / np.sqrt(np.outer(sheet.mass, sheet.mass)))
    assert np.abs(low[:3]).max() < 1e-6 * low[3]
    # The first free plate mode of a square or disc of this size: 13.5 to 20 B / (rho a^4), squared frequencies.
    assert low[3] > 50 * BEND / (0.05 * SIDE**4)


def test_a_fine_wave_costs_what_a_plate_says() -> None:
    """z = sin(k x): B k^4 / 4 per area, within 3 % at 20 edges a wave."""
    sheet = Sheet.of(*equilateral_sheet(0.8, 0.8, 0.01), CLOTH)
    k = 2 * np.pi / 0.2
    height = 1e-3 * np.sin(k * sheet.rest[:, 0])
    assert stored(sheet, height) == pytest.approx(1e-6 * BEND * k**4 / 4 * 0.64, rel=0.03)


def test_a_welded_seam_bends_like_the_whole() -> None:
    rest, faces = equilateral_sheet(0.3, 0.2, 0.05)
    corner = rest[faces].copy()
    away = corner[:, :, 0].mean(1) > 0.15
    turn = np.array([[0.0, -1.0], [1.0, 0.0]])
    corner[away] = corner[away] @ turn + [1.0, -2.0]
    welded = Sheet.of_corners(corner, faces, [CLOTH], np.zeros(len(faces), int))
    whole = Sheet.of(rest, faces, CLOTH)
    height = 0.1 * (rest[:, 0] - 0.15) ** 2
    x = np.column_stack([rest, height])
    v = np.zeros_like(x)
    assert energies(welded.stencil, x, v)[1] == pytest.approx(energies(whole.stencil, x, v)[1], rel=0.02)


WOVEN = Material(0.05, 1e-9, 0.0, BEND, bend_warp=9 * BEND)
CYLINDERS = {
    "about the warp": (1, 0, 1.0),
    "about the weft": (0, 1, 9.0),
    "at 45 degrees": (0.5**0.5, 0.5**0.5, 4.0),
}


@EACH
@pytest.mark.parametrize("way", CYLINDERS)
def test_a_woven_cloth_bends_as_its_yarns_do(name: str, way: str) -> None:
    """Cylinders of a plate nine times as stiff along the warp: k^2/2 (sqrt(B) cos^2 + sqrt(9 B) sin^2)^2 per area."""
    sheet = Sheet.of(*MESHES[name](), WOVEN)
    a, b, times = CYLINDERS[way]
    middle = sheet.rest - sheet.rest.mean(0)
    height = 0.25 * (middle @ [a, b]) ** 2
    first, second = (sheet.rest[sheet.faces[:, k]] - sheet.rest[sheet.faces[:, 0]] for k in (1, 2))
    area = 0.5 * np.abs(first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]).sum()
    assert stored(sheet, height) == pytest.approx(BEND / 2 * times * 0.25 * area, rel=1e-6)


def test_a_panel_keeps_its_own_warp_when_it_is_laid_another_way() -> None:
    """A strip of two welded panels, the second cut across: one bends its weft where the other bends its warp."""
    rest, faces = equilateral_sheet(0.3, 0.2, 0.05)
    corner = rest[faces].copy()
    away = corner[:, :, 0].mean(1) > 0.15
    corner[away] = corner[away] @ np.array([[0.0, -1.0], [1.0, 0.0]]) + [1.0, -2.0]
    kinds = np.zeros(len(faces), int)
    welded = Sheet.of_corners(corner, faces, [WOVEN], kinds)
    height = 0.1 * (rest[:, 0] - 0.15) ** 2
    x = np.column_stack([rest, height])
    a, b = rest[faces[:, 1]] - rest[faces[:, 0]], rest[faces[:, 2]] - rest[faces[:, 0]]
    area = 0.5 * np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
    wanted = 0.5 * 0.04 * (BEND * area[~away].sum() + 9 * BEND * area[away].sum())
    assert energies(welded.stencil, x, np.zeros_like(x))[1] == pytest.approx(wanted, rel=1e-6)


def test_equal_bends_are_the_isotropic_cloth_to_the_bit() -> None:
    for name in ("rows", "scattered"):
        one, two = (
            Sheet.of(*MESHES[name](), Material(0.05, 50.0, 0.3, BEND, bend_warp=warp))
            for warp in (None, BEND)
        )
        assert np.array_equal(one.stencil.bend, two.stencil.bend)
