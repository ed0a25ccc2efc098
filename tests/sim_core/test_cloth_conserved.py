"""What no step may change: linear and angular momentum, and the outcome of a run seen from elsewhere."""

import numpy as np
import pytest

from sim_core.cloth import Contact, Material, Phase, Sheet, drape
from sim_core.cloth.scenes import equilateral_sheet
from sim_core.cloth.sheet import energies
from sim_core.mesh import panel_mesh

FREE = Material(0.05, 50.0, 0.3, 5e-5, mass_damping=0.0, stiffness_damping=0.0)
CLOTHS = {
    "stretch and bending": FREE,
    "woven": Material(0.05, 80.0, 0.2, 5e-5, 0.3, 0.0, 0.0, stretch_warp=300.0, shear=11.0, bend_warp=5e-4),
    "stiffness damping": Material(0.05, 50.0, 0.3, 5e-5, mass_damping=0.0, stiffness_damping=1e-4),
}
STEPS = 400  # of a frame


def crumpled(sheet: Sheet, rng: np.random.Generator) -> np.ndarray:
    flat = np.column_stack([sheet.rest, 0.02 * np.sin(25 * sheet.rest[:, 0])])
    return flat + rng.normal(0, 0.002, flat.shape)


def momenta(sheet: Sheet, x: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Linear and angular momentum: m x (cross) v with v half a step behind x is what central forces keep exactly."""
    return sheet.mass @ v, (sheet.mass[:, None] * np.cross(x, v)).sum(0)


def kept(sheet: Sheet, x: np.ndarray, v: np.ndarray, contact: Contact | None = None) -> tuple:
    """Changes of both momenta over a frame, as shares of what the vertices have, and the frame's end."""
    end = drape(
        sheet, x, [Phase(0.04, (0.0, 0.0), damping=0.0)], velocities=v, substeps=STEPS, contact=contact
    )
    before, after = momenta(sheet, x, v), momenta(sheet, end.positions, end.velocities)
    speed = np.linalg.norm(v, axis=1)
    scales = sheet.mass @ speed, sheet.mass @ (np.linalg.norm(x, axis=1) * speed)
    lost = [float(np.abs(b - a).max() / s) for a, b, s in zip(before, after, scales, strict=True)]
    return *lost, end


@pytest.mark.parametrize("name", CLOTHS)
@pytest.mark.parametrize("mesh", ["rows", "grown"])
def test_momenta_stay(name: str, mesh: str) -> None:
    """1e-12 a step, in a cloth that stretches, bends and swings: both momenta over a whole frame of 400."""
    rng = np.random.default_rng(5)
    panel = panel_mesh(np.array([[0, 0], [0.2, 0], [0.22, 0.17], [0.02, 0.15]]), edge=0.03)
    rest, faces = (panel.vertices, panel.faces) if mesh == "grown" else equilateral_sheet(0.2, 0.16, 0.03)
    sheet = Sheet.of(rest, faces, CLOTHS[name])
    x, v = crumpled(sheet, rng), rng.normal(0, 0.5, (len(rest), 3))
    linear, angular, end = kept(sheet, x, v)
    stored = energies(sheet.stencil, x, v), energies(sheet.stencil, end.positions, end.velocities)
    assert abs(stored[1][0] / stored[0][0] - 1) > 0.01  # the membrane and the bending have worked
    assert abs(stored[1][1] / stored[0][1] - 1) > 0.01
    assert linear < 1e-12
    assert angular < 1e-12


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_momenta_stay_where_layers_meet(friction: float) -> None:
    """Two sheets meet at 2 m/s, turned against each other. Friction acts over the gap the layers keep: a couple of
    at most thickness times its impulse, which middle surfaces cannot take up; without it both momenta stay."""
    rest, faces = equilateral_sheet(0.12, 0.1, 0.02)
    count = len(rest)
    sheet = Sheet.of(
        np.vstack([rest, rest + [1.0, 0.0]]), np.vstack([faces, faces + count]), CLOTHS["stiffness damping"]
    )
    level = np.column_stack([rest[:, 0], 0 * rest[:, 0], rest[:, 1]])
    turn = np.array([[np.cos(0.4), 0, np.sin(0.4)], [0, 1, 0], [-np.sin(0.4), 0, np.cos(0.4)]])
    x = np.vstack([level, level @ turn + [0.0, 0.02, 0.01]])
    v = np.repeat([[0.3, 1.0, 0.0], [0.0, -1.0, 0.2]], count, axis=0)
    contact = Contact(thickness=0.004, self_friction=friction)
    linear, angular, end = kept(sheet, x, v, contact)
    closing = end.velocities[:count, 1].mean() - end.velocities[count:, 1].mean()
    assert closing < 1.5  # 2 m/s before they met
    assert linear < 1e-12
    slid = float(np.abs((end.velocities - v)[:count, [0, 2]]).max())
    impulse = friction * sheet.mass[:count].sum() * 2.0
    scale = sheet.mass @ (np.linalg.norm(x, axis=1) * np.linalg.norm(v, axis=1))
    assert angular < 1e-12 + 0.004 * impulse / scale
    assert friction == 0.0 or slid > 0.01


@pytest.mark.parametrize("boost", [0.0, 3.0])
def test_a_run_is_the_same_seen_from_elsewhere(boost: float) -> None:
    """Turned, moved and (where nothing but the cloth itself acts) passing by at 3 m/s: the same to 1e-9 m."""
    rng = np.random.default_rng(8)
    rest, faces = equilateral_sheet(0.2, 0.16, 0.03)
    sheet = Sheet.of(rest, faces, CLOTHS["stiffness damping"])
    x, v = crumpled(sheet, rng), rng.normal(0, 0.3, (len(rest), 3))
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    turn *= np.sign(np.linalg.det(turn))
    pull, down, go = (0.0, 0.0) if boost else (9.81, 9.81), np.array([0.0, -1.0, 0.0]), boost * np.ones(3)
    phases = [Phase(0.2, pull, damping=0.0 if boost else 1.0)]
    one = drape(sheet, x, phases, velocities=v, substeps=STEPS, down=down)
    two = drape(
        sheet,
        x @ turn.T + [0.7, -0.4, 0.9],
        phases,
        velocities=v @ turn.T + go,
        substeps=STEPS,
        down=turn @ down,
    )
    seen = (two.positions - [0.7, -0.4, 0.9] - 0.2 * go) @ turn
    assert np.abs(one.positions - x).max() > 0.01
    assert np.abs(seen - one.positions).max() < 1e-9
