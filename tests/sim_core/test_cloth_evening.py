"""Mass shared out evenly: light vertices at borders no longer set the step of all."""

import numpy as np
import pytest

from sim_core.cloth import Material, Sheet
from sim_core.cloth.scenes import equilateral_sheet
from sim_core.cloth.sheet import evened
from sim_core.cloth.step import Engine, first_mode

CLOTH = Material(0.05, 50.0, 0.3, 1e-6)


def step_of(sheet: Sheet) -> float:
    """The stable step [s] of the flat sheet."""
    engine, x = Engine(sheet), np.column_stack([sheet.rest, np.zeros(len(sheet.rest))])
    mode = first_mode(len(x))
    for k in range(20):
        step = engine.step((), engine.inward(x), mode, first=k == 0)
    return step


def with_a_thin_border() -> Sheet:
    """Equilateral triangles, and along one side a row of right-angled ones a third as high."""
    rest, faces = equilateral_sheet(0.2, 0.2, 0.02)
    rest = rest.copy()
    last = rest[:, 1] > rest[:, 1].max() - 1e-9
    rest[last, 1] -= 0.6 * 0.02 * np.sqrt(0.75)
    return Sheet.of(rest, faces, CLOTH)


def test_light_vertices_become_heavier_and_the_whole_stays() -> None:
    sheet = with_a_thin_border()
    even = evened(sheet, np.ones(len(sheet.faces)))
    assert even.mass.sum() == pytest.approx(sheet.mass.sum(), rel=1e-12)
    assert even.stencil.inverse_mass == pytest.approx(1 / even.mass, rel=1e-12)
    last = sheet.rest[:, 1] > sheet.rest[:, 1].max() - 1e-9
    assert (even.mass[last] > 1.2 * sheet.mass[last]).all()
    rest = sheet.rest
    inner = (rest > 0.025).all(1) & (rest < rest.max(0) - [0.025, 0.06]).all(1)
    assert np.ptp(even.mass[inner] / sheet.mass[inner]) < 1e-9  # all of these give alike
    assert step_of(even) > 1.15 * step_of(sheet)


def test_a_part_keeps_its_own_mass() -> None:
    sheet = with_a_thin_border()
    even = evened(sheet, np.ones(len(sheet.faces)), own=40)
    assert even.mass[:40].sum() == pytest.approx(sheet.mass[:40].sum(), rel=1e-12)


def test_cloth_laid_double_is_as_even_as_single() -> None:
    """Twice the mass and the stiffness: what is held twice as firmly is twice as heavy already."""
    rest, faces = equilateral_sheet(0.2, 0.2, 0.02)
    double = rest[faces].mean(1)[:, 0] > 0.1
    twice = Material(0.10, 100.0, 0.3, 1e-6)
    sheet = Sheet.of_corners(rest[faces], faces, [CLOTH, twice], double.astype(np.int32))
    even = evened(sheet, np.where(double, 0.10, 0.05))
    inner = (rest > 0.025).all(1) & (rest < rest.max(0) - 0.025).all(1)
    assert np.ptp(even.mass[inner] / sheet.mass[inner]) < 0.35
