"""One contact at a time: what an impulse between layers takes away, and which gradients of a grid push."""

from dataclasses import replace

import numpy as np
import pytest

from sim_core.cloth import Contact, GridSdf
from sim_core.cloth.contact import (
    LEVER,
    Mesh,
    NearPairs,
    Push,
    Shell,
    collide_samples,
    collide_vertices,
    near_pairs_of,
    repel,
)

THICKNESS = 0.004  # [m]
LAYERS = Contact(thickness=THICKNESS, spring=1e-9)  # so weak that damping and friction are seen alone
FACE = np.array([[-0.02, 0.0, -0.01], [0.02, 0.0, -0.01], [0.0, 0.0, 0.02]])  # about the origin
BAR = np.array([[0.0, 0.0, -0.01], [0.0, 0.0, 0.01]])


def shell_of(friction: float) -> Shell:
    return replace(LAYERS, self_friction=friction).shell()


def mesh_of(inverse: np.ndarray, faces: np.ndarray, edges: np.ndarray) -> Mesh:
    same = np.arange(len(inverse), dtype=np.int32)
    return Mesh(inverse, np.zeros((len(inverse), 2)), edges, faces, np.ones(len(edges)), same)


def near_of(points: list[list[int]], crossings: list[list[int]], vertices: int = 4) -> NearPairs:
    """Lists that hold these pairs, awake."""

    def awake(pairs: list[list[int]]) -> np.ndarray:
        return np.array([[*pair, 0] for pair in pairs], np.int32).reshape(-1, 3)

    counts = np.array([0, len(points), len(crossings)])
    lists = near_pairs_of(vertices, 2, 0)
    now = lists.now._replace(points=awake(points), crossings=awake(crossings), count=counts)
    return lists._replace(now=now)


def met(gap: float, velocity: tuple[float, float, float], friction: float, kind: str) -> np.ndarray:
    """Velocity (3,) [m/s] of a layer relative to the one `gap` [m] below it, after one impulse."""
    if kind == "vertex on face":
        x = np.concatenate([[[0.0, gap, 0.0]], FACE])
        faces, edges = np.array([[1, 2, 3]], np.int32), np.zeros((0, 2), np.int32)
        near = near_of([[0, 0]], [])
        upper, below = [1.0, 0, 0, 0], [0, 1 / 4, 1 / 4, 1 / 2]
    else:
        x = np.concatenate([[[-0.01, gap, 0.0], [0.01, gap, 0.0]], BAR])
        faces, edges = np.zeros((0, 3), np.int32), np.array([[0, 1], [2, 3]], np.int32)
        near = near_of([], [[0, 1]])
        upper, below = [0.5, 0.5, 0, 0], [0, 0, 0.5, 0.5]
    v = np.asarray(upper)[:, None].astype(bool) * np.array(velocity)
    v = np.ascontiguousarray(v, float)
    repel(x, v, mesh_of(np.ones(4), faces, edges), near, shell_of(friction), 1e-3, 0)
    weights = np.array(below)
    return np.asarray(upper) @ v - weights @ v


KINDS = pytest.mark.parametrize("kind", ["vertex on face", "edge on edge"])


@KINDS
def test_near_the_surface_the_whole_approach_is_taken_away(kind: str) -> None:
    """Deeper than three quarters of the shell nothing may come nearer: the pair would lose its side."""
    assert met(0.2 * THICKNESS, (0.0, -1.0, 0.0), 0.0, kind)[1] == pytest.approx(0.0, abs=1e-6)
    assert met(0.5 * THICKNESS, (0.0, -1.0, 0.0), 0.0, kind)[1] == pytest.approx(-0.7, abs=1e-6)
    assert met(1.1 * THICKNESS, (0.0, -1.0, 0.0), 0.0, kind)[1] == -1.0


@KINDS
@pytest.mark.parametrize("friction", [0.0, 0.2, 0.35])
def test_sliding_loses_friction_times_the_normal_impulse(kind: str, friction: float) -> None:
    slide = met(0.2 * THICKNESS, (2.0, -1.0, 0.0), friction, kind)[0]
    assert slide == pytest.approx(2.0 - friction * 1.0, abs=1e-6)


@KINDS
def test_friction_takes_half_of_the_sliding_at_most(kind: str) -> None:
    assert met(0.2 * THICKNESS, (0.4, -1.0, 0.0), 1.0, kind)[0] == pytest.approx(0.2, abs=1e-6)


def test_a_pair_that_was_woken_in_contact_stays_awake() -> None:
    """By a jerk long before it would have woken by itself: it is asked in the substep after, too, where nobody is."""
    x = np.concatenate([[[0.0, 0.6 * THICKNESS, 0.0]], FACE])
    v, mesh = (
        np.zeros((4, 3)),
        mesh_of(np.ones(4), np.array([[1, 2, 3]], np.int32), np.zeros((0, 2), np.int32)),
    )
    near = near_of([[0, 0]], [])
    near.now.points[0, 2] = 100
    near.jerks.sway2[:] = 0.01
    for step, woken in ((50, True), (51, False), (60, False)):
        near.jerks.jerked[0] = near.jerks.some[0] = woken
        v[0, 1] = -0.05
        _, nearest2 = repel(x, v, mesh, near, shell_of(0.0), 1e-3, step)
        assert v[0, 1] > -0.05, step
        assert nearest2 == pytest.approx((0.6 * THICKNESS) ** 2)


@pytest.mark.parametrize(("speed", "asked"), [(-0.2, False), (-3.0, True)])
def test_who_is_struck_wakes_its_pairs_in_the_same_pass(speed: float, asked: bool) -> None:
    """A vertex meets a face; the pair of it and another face, which comes later, sleeps as long as the blow is soft."""
    x = np.concatenate([[[0.0, 0.2 * THICKNESS, 0.0]], FACE, FACE + [0.0, 3 * THICKNESS, 0.0]])
    faces = np.array([[1, 2, 3], [4, 5, 6]], np.int32)
    near = near_of([[0, 0], [0, 1]], [], vertices=7)
    v = np.zeros((7, 3))
    v[0, 1] = speed
    near.now.points[1, 2] = 100
    near.jerks.going[:] = v.T
    near.jerks.sway2[:] = 0.3
    repel(x, v, mesh_of(np.ones(7), faces, np.zeros((0, 2), np.int32)), near, shell_of(0.0), 1e-3, 5)
    assert v[0, 1] > 0.5 * speed
    assert (near.now.points[1, 2] < 100) == asked


@pytest.mark.parametrize("arm", [0.5, 0.1, 0.01, 1e-4])
def test_what_is_pushed_near_its_pin_is_not_thrown(arm: float) -> None:
    """A led edge meets another one `arm` of its length from its pin: to give way there its end would need 1 / arm."""
    x = np.array([[0.0, 0.0, 0.0], [0.02, 0.0, 0.0], [0.02 * arm, 2e-4, -0.01], [0.02 * arm, 2e-4, 0.01]])
    v = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, -1.0, 0.0]])
    free, edges = np.array([0.0, 1.0, 0.0, 0.0]), np.array([[0, 1], [2, 3]], np.int32)
    mesh = mesh_of(free, np.zeros((0, 3), np.int32), edges)
    repel(x, v, mesh, near_of([], [[0, 1]]), shell_of(0.0), 1e-3, 0)
    assert v[1] == pytest.approx([0.0, -min(1 / arm, LEVER), 0.0], abs=1e-4)


@pytest.mark.parametrize(("slope", "pushed"), [(1.0, True), (0.78, True), (0.72, False), (0.0, False)])
def test_a_grid_pushes_only_where_its_gradient_is_clear(slope: float, pushed: bool) -> None:
    """Between two surfaces the sampled gradient shrinks; below three quarters it says no direction."""
    axis = 0.01 * np.arange(5)
    values = np.broadcast_to(slope * (axis - 0.02)[:, None, None], (5, 5, 5))
    packed = GridSdf((0.0, 0.0, 0.0), 0.01, np.array(values)).packed()
    start = np.array([[0.021, 0.012, 0.013], [0.021, 0.014, 0.013], [0.021, 0.012, 0.016]])
    near = np.repeat(np.arange(3, dtype=np.int32)[:, None], 3, axis=1)
    x, v = start.copy(), np.zeros((3, 3))
    push = Push(clearance=0.003, cap=1.0, friction=0.0, dt=1e-3)
    collide_vertices(packed, np.ones(3), x, v, near, push)
    depth = 0.003 - slope * 0.001
    assert x[:, 0] - start[:, 0] == pytest.approx(depth if pushed else 0.0, abs=1e-9)
    x = start.copy()
    collide_samples(packed, np.ones(3), x, v, np.array([[0, 1, 2]], np.int32), push)
    assert (x[:, 0].mean() - start[:, 0].mean()) == pytest.approx(depth if pushed else 0.0, abs=1e-9)
