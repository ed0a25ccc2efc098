"""A body that moves along its own surface takes cloth with it by friction: a belt, a drum that turns in place."""

import numpy as np
import pytest

from sim_core.cloth import Contact, Material, MovingGrid, Phase, Sheet, drape, moving_mesh
from sim_core.cloth.limb import limb_mesh
from sim_core.cloth.phases import FRAME
from sim_core.cloth.rows import equilateral_sheet

G = 9.81
CLEARANCE = Contact().clearance


def square(side: float, edge: float, friction: float) -> tuple[Sheet, np.ndarray]:
    """A heavy sheet about the origin of the plane y = 0, and where its vertices are."""
    rest, faces = equilateral_sheet(side, side, edge)
    rest -= (rest.min(0) + rest.max(0)) / 2
    sheet = Sheet.of(rest, faces, Material(0.2, 200.0, 0.3, 1e-4, friction))
    return sheet, np.column_stack([rest[:, 0], np.zeros(len(rest)), rest[:, 1]])


def belt(speed: float, frames: int) -> MovingGrid:
    """A slab whose top is y = 0, going along x at `speed` [m/s]."""
    corners = np.array([[x, y, z] for x in (-0.6, 0.6) for y in (-0.08, 0.0) for z in (-0.2, 0.2)])
    faces = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1]]
    faces += [[2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]
    way = speed * FRAME * np.arange(frames + 1)
    return moving_mesh(corners + way[:, None, None] * [1.0, 0.0, 0.0], np.array(faces), cell=0.01)


@pytest.mark.parametrize(("speed", "friction"), [(0.5, 0.3), (-0.5, 0.3), (1.0, 0.2)])
def test_a_belt_takes_cloth_along_as_friction_says(speed: float, friction: float) -> None:
    """It gains mu g until it goes with the belt: mu g t² / 2, then the belt's speed, half a slip's way behind."""
    frames, film = 10, []
    sheet, flat = square(0.2, 0.03, friction)
    phase = Phase(frames * FRAME, damping=0.0, body=(0.0, float(frames)))
    start = flat + [0.0, CLEARANCE, 0.0]
    drape(sheet, start, [phase], collider=belt(speed, frames), on_frame=lambda _, x: film.append(x.mean(0)))
    t, slip = FRAME * np.arange(1, frames + 1), abs(speed) / (friction * G)
    way = np.where(t < slip, 0.5 * friction * G * t * t, abs(speed) * (t - 0.5 * slip))
    x, y, z = (np.array(film) - start.mean(0)).T
    assert x * np.sign(speed) == pytest.approx(way, rel=0.01, abs=2e-5)
    assert np.abs(y).max() < 1e-4
    assert np.abs(z).max() < 1e-6


def test_a_drum_that_turns_in_place_takes_cloth_round() -> None:
    """Its distance field never changes: whoever sees that alone lets the cloth lie."""
    radius, rate, frames = 0.15, 1.0, 10  # [m], [rad/s]
    vertices, faces = limb_mesh(0.5, radius)
    angle = rate * FRAME * np.arange(frames + 1)
    c, s, y, z = np.cos(angle)[:, None], np.sin(angle)[:, None], vertices[:, 1], vertices[:, 2]
    turned = np.stack(np.broadcast_arrays(vertices[:, 0], c * y - s * z, s * y + c * z), -1)
    sheet, flat = square(0.1, 0.015, 0.8)
    high = radius + CLEARANCE
    lying = np.column_stack(
        [flat[:, 0] + 0.25, high * np.cos(flat[:, 2] / high), high * np.sin(flat[:, 2] / high)]
    )
    phase = Phase(frames * FRAME, damping=0.0, body=(0.0, float(frames)))
    end = drape(sheet, lying, [phase], collider=moving_mesh(turned, faces))
    before, after = np.arctan2(lying[:, 2], lying[:, 1]), np.arctan2(end.positions[:, 2], end.positions[:, 1])
    slip = 0.5 * rate * rate * radius / (0.8 * G)  # [rad] lost while it is sped up
    assert (after - before).mean() == pytest.approx(rate * frames * FRAME - slip, rel=0.05)
    assert np.abs(end.positions[:, 0].mean() - 0.25) < 1e-3
