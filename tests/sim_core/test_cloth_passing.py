"""Cloth pulled through a ring, and sheets that fly at each other: at no frame does anything pass through itself."""

import numpy as np
import pytest
from full_matrix import by_day

from sim_core import metrics
from sim_core.cloth import Capsule, Contact, Live, Material, Phase, Sheet, Union, drape

CLOTH = Material(density=0.1, stretch=49.0, bend=5e-6)


def square(count: int, size: float) -> tuple[np.ndarray, np.ndarray]:
    """Where the vertices of a square lie in the pattern (V, 2), its middle at the origin, and its faces."""
    u, w = np.meshgrid(*[np.linspace(-size / 2, size / 2, count)] * 2, indexing="ij")
    a = (np.arange(count - 1)[:, None] * count + np.arange(count - 1)).ravel()
    faces = [np.stack([a, a + 1, a + count], 1), np.stack([a + 1, a + count + 1, a + count], 1)]
    return np.stack([u.ravel(), w.ravel()], axis=1), np.concatenate(faces).astype(np.int32)


def ring(wide: float, thick: float, parts: int = 32) -> Union:
    """A ring of rod, `wide` [m] within and lying level, whose rod is `thick` [m] in radius."""
    angle, radius = 2 * np.pi * np.arange(parts + 1) / parts, 0.5 * wide + thick
    at = [(float(radius * np.cos(a)), 0.0, float(radius * np.sin(a))) for a in angle]
    return Union(tuple(Capsule(p, q, thick) for p, q in zip(at[:-1], at[1:], strict=True)))


@pytest.mark.nightly
@pytest.mark.slow
def test_cloth_goes_through_a_ring_and_never_through_itself() -> None:
    """A sheet of 400 mm is drawn by its middle through a ring of 96 mm at 250 mm/s."""
    rest, faces = square(41, 0.4)
    x = np.column_stack([rest[:, 0], np.full(len(rest), 0.014), rest[:, 1]])
    pins = np.flatnonzero((rest**2).sum(1) < 0.012**2).tolist()
    contact = Contact(clearance=0.002, sample_clearance=0.001, thickness=0.002, untangle=20, partly=True)
    cloth = Live(Sheet.of(rest, faces, CLOTH), x, pins=pins, collider=ring(0.096, 0.01), contact=contact)
    for frame in range(40):
        drawn = x[pins] - [0.0, 0.01 * (frame + 1), 0.0]
        assert metrics.intersections(cloth.step(targets=drawn), faces) == 0, frame
    assert cloth.positions[:, 1].max() < 0.0  # it is through


@pytest.mark.slow
@pytest.mark.parametrize("count", by_day([41], [41, 224]))
def test_sheets_that_meet_at_forty_metres_a_second_do_not_pass(count: int) -> None:
    rest, faces = square(count, 1.0)
    many = len(rest)
    sheet = Sheet.of(np.concatenate([rest, rest + [2.0, 0.0]]), np.concatenate([faces, faces + many]), CLOTH)
    low = np.column_stack([rest[:, 0], np.zeros(many), rest[:, 1]])
    start = np.concatenate([low, low + [0.013, 0.3, 0.007]])
    speed = np.repeat([[0.0, 20.0, 0.0], [0.0, -20.0, 0.0]], many, axis=0)
    contact = Contact(thickness=0.004, untangle=20, partly=True, speed_limit=1000.0)
    crossed: list[int] = []

    def seen(_: int, x: np.ndarray) -> None:
        crossed.append(metrics.intersections(x, sheet.faces))

    end = drape(sheet, start, [Phase(0.12)], velocities=speed, contact=contact, on_frame=seen)
    assert crossed == [0, 0, 0]
    assert end.fallbacks == 0
    before, after = (at[many:, 1].mean() - at[:many, 1].mean() for at in (start, end.positions))
    assert before > 0
    assert after > 0.0  # each is still on its own side
