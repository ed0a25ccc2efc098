"""Layers that are pressed together from both sides: a pair that is stopped is set going again by the next one."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

from sim_core import metrics
from sim_core.cloth import Contact, HalfSpace, Live, Material, Phase, Sheet, moving_mesh
from sim_core.cloth.contact import (
    CLOSE,
    PARTING,
    Mesh,
    NearPairs,
    hold_apart,
    listed_close,
    near_pairs_of,
    repel,
)
from sim_core.cloth.run import Run, Setup
from sim_core.cloth.step import FRAME
from sim_core.errors import SimCoreError

GAP, DT = 1e-3, 1e-3
FACE = [[-0.01, 0.0, -0.01], [0.01, 0.0, -0.01], [0.0, 0.0, 0.01]]


def one_pair(x: np.ndarray) -> NearPairs:
    """Vertex 0 and the only face, where they have leapt to x (4, 3)."""
    lists = near_pairs_of(4, 2, 0)
    now = lists.now._replace(points=np.array([[0, 0, 0]], np.int32), count=np.array([0, 1, 0]))
    lists.jerks.leapt[:] = x.T
    return lists._replace(now=now)


def one_face() -> Mesh:
    edges, face = np.zeros((0, 2), np.int32), np.array([[1, 2, 3]], np.int32)
    return Mesh(np.ones(4), np.zeros((4, 2)), edges, face, np.zeros(0), np.arange(4, dtype=np.int32))


def pressed(speed: float, pushed: float = 0.0) -> tuple[float, np.ndarray, np.ndarray]:
    """The share lost, places and velocities (4, 3) of a vertex GAP above a face, that comes down and was pushed so."""
    x = np.array([[0.0, GAP, 0.0], *FACE])
    v = np.array([[0.3, -speed, 0.0], *np.zeros((3, 3))])
    lists = one_pair(x)
    x[0, 1] -= pushed
    lists.close[:2] = 1, 0
    again, fast = x.copy(), v.copy()
    share = hold_apart(x, v, one_face(), lists, 2 * GAP, DT, 0, listed=False)
    assert share == hold_apart(again, fast, one_face(), lists, 2 * GAP, DT, 0, listed=True)
    assert (again == x).all()
    assert (fast == v).all()
    assert lists.jerks.back[0] == (pushed > 0.9 * GAP)
    return share, x, v


@pytest.mark.parametrize("speed", [0.6, 2.0, 50.0])
def test_no_pair_loses_more_than_its_share_and_momentum_stays(speed: float) -> None:
    share, _, v = pressed(speed)
    assert share == pytest.approx(speed * DT / GAP)
    closing = v[1:, 1] @ [0.25, 0.25, 0.5] - v[0, 1]
    assert closing * DT == pytest.approx(0.25 * GAP)
    assert v.sum(0) == pytest.approx([0.3, -speed, 0.0])
    assert pressed(0.4)[2][0] == pytest.approx([0.3, -0.4, 0.0])


def test_what_a_solid_pushes_through_a_layer_is_taken_back() -> None:
    there = pressed(0.0)[1]
    assert pressed(0.0, 1.5 * GAP)[1] == pytest.approx(there)
    assert pressed(0.0, 0.95 * GAP)[1] == pytest.approx(there)
    assert pressed(0.0, 0.5 * GAP)[1][0, 1] == pytest.approx(0.5 * GAP)


def test_who_is_fast_is_restless_from_then_on_and_its_pairs_are_listed() -> None:
    lists, x, v = near_pairs_of(4, 2, 0), np.zeros((3, 4)), np.zeros((3, 4))
    assert listed_close(x, v, lists, GAP, DT)
    v[1, 2] = 0.3 * CLOSE * GAP / DT  # two so fast lose more than half of what is not listed
    assert not listed_close(x, v, lists, GAP, DT)
    assert lists.jerks.restless.tolist() == [False, False, True, False]
    assert listed_close(x, v, lists, GAP, DT)
    lists.jerks.leapt[0, 0] = -0.6 * CLOSE * GAP  # pushed by a solid since
    assert not listed_close(x, v, lists, GAP, DT)
    assert listed_close(x, v, lists, GAP, DT)
    lists.close[0] = len(lists.close)  # more than there was room for
    assert not listed_close(x, v, lists, GAP, DT)


def test_a_squeezed_pair_is_thrown_no_further_than_a_share_of_the_thickness() -> None:
    """However many pairs share a vertex: here the same one again and again."""
    x, v = np.array([[0.0, 1e-5, 0.0], *FACE]), np.zeros((4, 3))
    for _ in range(30):
        near = one_pair(x)
        repel(x, v, one_face(), near, Contact(thickness=GAP).shell(), DT, 0)
        assert near.close[:2].tolist() == [1, 0]
    assert v[0, 1] - v[1:, 1] @ [0.25, 0.25, 0.5] == pytest.approx(PARTING * GAP / DT)


def stack(
    densities: list[float],
    heights: list[float],
    count: int = 12,
    size: float = 0.3,
    shares: Sequence[float] | None = None,
) -> tuple[Sheet, np.ndarray]:
    """Square sheets [kg/m2], a little beside each other, and their places (V, 3) [m]; shares: of `size` a side."""
    shares = shares or [1.0] * len(densities)
    axis = np.linspace(0, size, count)
    square = np.stack(np.meshgrid(axis, axis, indexing="ij"), axis=-1).reshape(-1, 2)
    rest = [share * square for share in shares]
    middle = [square + 0.5 * size * (1 - share) for share, square in zip(shares, rest, strict=True)]
    a = (np.arange(count - 1)[:, None] * count + np.arange(count - 1)).ravel()
    faces = np.concatenate(
        [np.column_stack([a, a + 1, a + count]), np.column_stack([a + 1, a + count + 1, a + count])]
    )
    numbers = range(len(densities))
    every = np.concatenate([faces + len(square) * k for k in numbers]).astype(np.int32)
    flat = np.concatenate([rest[k] + [2 * size * k, 0.0] for k in numbers])
    materials = [Material(density, 49.0, bend=5e-6) for density in densities]
    sheet = Sheet.of_corners(
        flat[every], every, materials, np.repeat(np.arange(len(densities)), len(faces)).astype(np.int32)
    )
    x = np.concatenate(
        [
            np.column_stack([middle[k][:, 0] + 4e-4 * k, np.full(len(square), y), middle[k][:, 1] + 2e-4 * k])
            for k, y in enumerate(heights)
        ]
    )
    return sheet, x


def in_order(x: np.ndarray, sheet: Sheet, count: int) -> bool:
    layers = x[:, 1].reshape(count, -1)
    return bool((np.diff(layers.mean(1)) > 0).all()) and metrics.intersections(x, sheet.faces) == 0


STACKS = [  # [kg/m2] from below upwards, m/s, [m] the lowest one's height, [m] between two
    ([0.1, 0.1, 0.3], 5.0, 0.02, 0.005),
    ([0.1, 0.1, 0.3], 3.0, 0.03, 0.005),
    ([0.1, 0.1, 0.5], 4.0, 0.02, 0.005),
    ([0.05, 0.4], 5.0, 0.02, 0.005),
    ([0.1] * 4, 8.0, 0.02, 0.005),
    ([0.1] * 4, 6.0, 0.027, 0.006),
    ([0.1] * 8, 4.0, 0.033, 0.003),
]


@pytest.mark.parametrize(("densities", "speed", "height", "gap"), STACKS)
def test_a_stack_that_falls_keeps_its_order(
    densities: list[float], speed: float, height: float, gap: float
) -> None:
    """Heavy upon light, and many upon each other: what is stopped by the floor is pressed by all that comes after."""
    sheet, x = stack(densities, [height + gap * k for k in range(len(densities))])
    v = np.zeros_like(x)
    v[:, 1] = -speed
    setup = Setup(
        sheet, [Phase(2 * FRAME, (9.81, 9.81))], contact=Contact(thickness=0.0025), collider=HalfSpace()
    )
    run = Run(setup)
    state = run.begun(x, v)
    for _ in range(2):
        run.frame(state)
        assert in_order(state.positions, sheet, len(densities))


FALLS = [  # [m] side, thickness, height, gap; [kg/m2]; [m/s]; contact
    (2.0, 0.02, 0.2875, 0.04, [1.0, 1.0], 6.0, {}),
    (5.0, 0.02, 0.0694, 0.022, [0.1, 0.3, 0.3], 1.0, {}),
    (0.3, 2e-4, 0.03, 2.2e-4, [0.1, 0.1], 2.0, {}),
    (0.3, 3e-4, 0.0479, 3.06e-4, [1.0, 1.0, 0.03], 5.0, {}),
    (0.3, 0.0025, 0.0555, 0.00255, [0.03, 0.3], 3.0, {"every": 5}),
    (0.3, 0.0025, 0.0214, 0.00255, [0.3, 1.0], 5.0, {"every": 3}),
    (0.3, 0.0025, 0.044, 0.00325, [1.0, 0.3, 1.0], 8.0, {"cap": 0.02}),
]


@pytest.mark.parametrize(("size", "thickness", "height", "gap", "densities", "speed", "contact"), FALLS)
def test_large_thin_and_seldom_asked_layers_keep_their_order(
    size: float,
    thickness: float,
    height: float,
    gap: float,
    densities: list[float],
    speed: float,
    contact: dict[str, Any],
) -> None:
    sheet, x = stack(densities, [height + gap * k for k in range(len(densities))], count=10, size=size)
    v = np.zeros_like(x)
    v[:, 1] = -speed
    touch = Contact(thickness=thickness, **contact)
    run = Run(Setup(sheet, [Phase(3 * FRAME, (9.81, 9.81))], contact=touch, collider=HalfSpace()))
    state = run.begun(x, v)
    for _ in range(3):
        run.frame(state)
        assert in_order(state.positions, sheet, len(densities))


def post(speed: float) -> tuple[Live, Sheet]:
    """Two sheets at rest without weight, and a post of 20 cm below that rises after a frame's rest."""
    import trimesh

    box = trimesh.creation.box(extents=(0.2, 0.55, 0.2)).subdivide().subdivide()
    rise = np.array([0.0, 0.0, 0.0, 1.0, 2.0]) * speed * FRAME
    keys = np.stack([box.vertices + [0.0, -0.295 + up, 0.0] for up in rise])
    sheet, x = stack([0.1, 0.1], [0.0, 0.004])
    x[:, [0, 2]] -= x[:, [0, 2]].mean(0)
    body = moving_mesh(keys, box.faces, cell=0.025, band=0.06)
    return Live(sheet, x, gravity=(0.0, 0.0, 0.0), contact=Contact(thickness=0.0025), collider=body), sheet


def struck(speed: float) -> str:
    """What is said of two sheets that a post strikes; nothing where they are in order after each of four frames."""
    live, sheet = post(speed)
    for frame in range(4):
        try:
            live.step(body=float(frame + 1))
        except SimCoreError as error:
            return str(error)
        assert metrics.intersections(live.positions, sheet.faces) == 0
    return ""


@pytest.mark.parametrize("speed", [1.0, 1.5])
def test_a_post_that_strikes_two_sheets_leaves_them_in_order(speed: float) -> None:
    assert not struck(speed)


@pytest.mark.parametrize("speed", [1.75, 2.0, 4.0])
def test_a_post_that_is_too_fast_for_two_sheets_never_passes_in_silence(speed: float) -> None:
    said = struck(speed)
    assert not said or "more slowly" in said


def test_a_sheet_that_pins_press_into_a_floor_is_told_instead_of_swapped() -> None:
    """A free sheet lies upon the floor, and one above is led down into the floor's clearance: no place is left."""
    shell, count = 0.0025, 10
    sheet, x = stack([0.1, 0.1], [0.01, 0.01 + 3 * shell], count, shares=[1.0, 0.6])
    pins = np.arange(count**2, 2 * count**2)
    live = Live(sheet, x, contact=Contact(thickness=shell), collider=HalfSpace(), pins=pins.tolist())
    place, said = x[pins], ""
    for _ in range(4):
        place[:, 1] = np.maximum(place[:, 1] - 0.3 * FRAME, 0.001)
        try:
            live.step(pins=pins.tolist(), targets=place)
        except SimCoreError as error:
            said = str(error)
            break
    assert "more slowly" in said
