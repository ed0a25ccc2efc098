"""A body that moves along its own surface takes cloth with it by friction: a belt, a drum that turns in place."""

import numpy as np
import pytest

from sim_core.cloth import Contact, Material, MovingGrid, Phase, Sheet, drape, moving_mesh
from sim_core.cloth.scenes import equilateral_sheet, limb_mesh
from sim_core.cloth.step import FRAME

G = 9.81
CLEARANCE = Contact().clearance


def square(side: float, edge: float, friction: float) -> tuple[Sheet, np.ndarray]:
    """A heavy sheet about the origin of the plane y = 0, and where its vertices are."""
    rest, faces = equilateral_sheet(side, side, edge)
    rest -= (rest.min(0) + rest.max(0)) / 2
    sheet = Sheet.of(rest, faces, Material(0.2, 200.0, 0.3, 1e-4, friction))
    return sheet, np.column_stack([rest[:, 0], np.zeros(len(rest)), rest[:, 1]])


def slab(x: float, y: float, z: float) -> tuple[np.ndarray, np.ndarray]:
    """Corners (8, 3) and faces (12, 3) of a block of this size, the middle of its top at the origin."""
    corners = np.array(
        [[a, b, c] for a in (-0.5 * x, 0.5 * x) for b in (-y, 0.0) for c in (-0.5 * z, 0.5 * z)]
    )
    faces = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1]]
    return corners, np.array(faces + [[2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]])


def going(velocity: tuple[float, float, float], frames: int, size: tuple[float, float, float]) -> MovingGrid:
    """A block that goes at a velocity [m/s]."""
    corners, faces = slab(*size)
    way = FRAME * np.arange(frames + 1)[:, None, None] * np.array(velocity)
    return moving_mesh(corners + way, faces, cell=0.01)


def played(sheet: Sheet, start: np.ndarray, body: MovingGrid, frames: int) -> np.ndarray:
    """Where the cloth is after each frame (T, V, 3) [m], nothing but friction and contact in its way."""
    film: list[np.ndarray] = []
    phase = Phase(frames * FRAME, damping=0.0, body=(0.0, float(frames)))
    drape(sheet, start, [phase], collider=body, on_frame=lambda _, x: film.append(x.copy()))
    return np.array(film)


@pytest.mark.parametrize(("speed", "friction"), [(0.5, 0.3), (-0.5, 0.3), (1.0, 0.2)])
def test_a_belt_takes_cloth_along_as_friction_says(speed: float, friction: float) -> None:
    """It gains mu g until it goes with the belt: mu g t² / 2, then the belt's speed, half a slip's way behind."""
    frames = 10
    sheet, flat = square(0.2, 0.03, friction)
    start = flat + [0.0, CLEARANCE, 0.0]
    film = played(sheet, start, going((speed, 0.0, 0.0), frames, (1.2, 0.08, 0.4)), frames)
    t, slip = FRAME * np.arange(1, frames + 1), abs(speed) / (friction * G)
    way = np.where(t < slip, 0.5 * friction * G * t * t, abs(speed) * (t - 0.5 * slip))
    x, y, z = (film.mean(1) - start.mean(0)).T
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
    end = played(sheet, lying, moving_mesh(turned, faces), frames)[-1]
    before, after = np.arctan2(lying[:, 2], lying[:, 1]), np.arctan2(end[:, 2], end[:, 1])
    slip = 0.5 * rate * rate * radius / (0.8 * G)  # [rad] lost while it is sped up
    assert (after - before).mean() == pytest.approx(rate * frames * FRAME - slip, rel=0.05)
    assert np.abs(end[:, 0].mean() - 0.25) < 1e-3


def test_a_turntable_of_two_faces_turns_cloth_as_one_of_many_would() -> None:
    """Speed is that of the place under the cloth, not that of the middle of a face."""
    rate, frames = 1.0, 12  # [rad/s]
    corners, faces = slab(0.5, 0.1, 0.5)
    angle = rate * FRAME * np.arange(frames + 1)
    c, s, x, z = np.cos(angle)[:, None], np.sin(angle)[:, None], corners[:, 0], corners[:, 2]
    turned = np.stack(np.broadcast_arrays(c * x + s * z, corners[:, 1], c * z - s * x), -1)
    sheet, flat = square(0.2, 0.03, 0.8)
    end = played(sheet, flat + [0.0, CLEARANCE, 0.0], moving_mesh(turned, faces, cell=0.01), frames)[-1]
    out = np.hypot(flat[:, 0], flat[:, 2]) > 0.05
    there, here = (np.arctan2(p[out, 0], p[out, 2]) for p in (end, flat))
    went = (there - here + np.pi) % (2 * np.pi) - np.pi
    assert went.mean() == pytest.approx(rate * frames * FRAME, rel=0.02)
    assert np.ptp(went) < 0.02
    assert np.hypot(*end.mean(0)[[0, 2]]) < 5e-4


@pytest.mark.parametrize("velocity", [(0.0, 3.0, 0.0), (0.5, 1.5, 0.0)])
def test_a_quick_block_carries_cloth_however_narrow_the_band(velocity: tuple[float, float, float]) -> None:
    """It goes 12 cm a frame, thrice the band that was asked for; thick enough not to be missed."""
    frames = 5
    sheet, flat = square(0.2, 0.03, 0.8)
    body = going(velocity, frames, (0.6, 0.4, 0.4))
    way = played(sheet, flat + [0.0, CLEARANCE, 0.0], body, frames)[-1].mean(0) - flat.mean(0)
    gone = np.array(velocity) * frames * FRAME
    slip = 0.5 * velocity[0] ** 2 / (0.8 * G)
    assert way[1] - CLEARANCE == pytest.approx(gone[1], abs=0.01)
    assert gone[0] - 1.1 * slip - 1e-3 < way[0] <= gone[0] + 1e-3
