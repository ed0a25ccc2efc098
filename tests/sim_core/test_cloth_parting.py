"""Starts whose layers lie exactly on each other: they part and stay parted, whichever way they are folded or piled."""

import numpy as np
import pytest

from sim_core import metrics
from sim_core.cloth import Contact, HalfSpace, Material, Phase, Sheet, drape
from sim_core.cloth.run import Run, Setup

MATERIAL = Material(density=0.1, stretch=49.0)
LAYERS = Contact(thickness=0.002)
SIZE = 0.3


def square(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Where the vertices of a square lie in the pattern (V, 2), and its faces."""
    u, w = np.meshgrid(*[np.linspace(0.0, SIZE, count)] * 2, indexing="ij")
    a = (np.arange(count - 1)[:, None] * count + np.arange(count - 1)).ravel()
    faces = [np.stack([a, a + 1, a + count], 1), np.stack([a + 1, a + count + 1, a + count], 1)]
    return np.stack([u.ravel(), w.ravel()], axis=1), np.concatenate(faces)


def folded(rest: np.ndarray) -> np.ndarray:
    """Level, and folded flat in the middle of its length."""
    along = np.where(rest[:, 0] > SIZE / 2, SIZE - rest[:, 0], rest[:, 0])
    return np.column_stack([along, np.zeros(len(rest)), rest[:, 1]])


def start(name: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Rest, faces and positions."""
    rest, faces = square(13)
    if name == "pile":
        count = len(rest)
        rest, faces = np.concatenate([rest, rest + [1.0, 0.0]]), np.concatenate([faces, faces + count])
        x = np.column_stack([rest[:, 0] % 1.0, np.zeros(len(rest)), rest[:, 1]])
        return rest, faces, x
    return rest, faces, folded(rest)


@pytest.mark.parametrize("name", ["fold", "pile"])
def test_layers_that_lie_on_each_other_part_and_never_cross(name):
    rest, faces, x = start(name)
    seen: list[int] = []
    drape(
        Sheet.of(rest, faces, MATERIAL),
        x,
        [Phase(0.6)],
        collider=HalfSpace((0.0, -0.01, 0.0)),
        contact=LAYERS,
        on_frame=lambda _, there: seen.append(int(metrics.intersections(there, faces))),
    )
    assert seen == [0] * 15


def test_a_start_whose_layers_are_apart_is_left_as_it_is():
    rest, faces, x = start("fold")
    x[rest[:, 0] > SIZE / 2 + 1e-9, 1] += 0.001
    run = Run(Setup(Sheet.of(rest, faces, MATERIAL), [Phase(0.4)], contact=LAYERS))
    assert run.begun(x, np.zeros_like(x)).positions is x
