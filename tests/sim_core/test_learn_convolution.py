"""Spiral sequences: where they start, how they go on, and what fills them."""

import numpy as np
import pytest

from sim_core.cloth.scenes import equilateral_sheet
from sim_core.errors import SimCoreError
from sim_core.learn.convolution import STORAGE, check_storage, spirals

REST, FACES = equilateral_sheet(0.5, 0.4, 0.04)


def rings(faces: np.ndarray, vertex: int) -> dict[int, int]:
    """How many edges each vertex is away."""
    near: dict[int, set[int]] = {}
    for a, b, c in faces.tolist():
        for one, others in ((a, (b, c)), (b, (c, a)), (c, (a, b))):
            near.setdefault(one, set()).update(others)
    away, front = {vertex: 0}, [vertex]
    while front:
        ahead = []
        for one in front:
            for other in sorted(near[one] - set(away)):
                away[other] = away[one] + 1
                ahead.append(other)
        front = ahead
    return away


def test_rows_start_at_their_vertex_and_go_outward_ring_by_ring():
    table = spirals(FACES, 40, REST)
    assert table.shape == (len(REST), 40)
    assert table.dtype == np.int32
    assert table.flags.c_contiguous  # sequential storage
    for vertex, row in enumerate(table.tolist()):
        assert row[0] == vertex
        assert len(set(row)) == 40
        away = rings(FACES, vertex)
        told = [away[other] for other in row]
        assert told == sorted(told)
        assert {other for other, ring in away.items() if ring < told[-1]} <= set(
            row
        )  # no ring is left half read


def test_rings_go_round_in_the_sense_of_the_faces_from_x():
    middle = int(np.argmin(((REST - REST.mean(0)) ** 2).sum(1)))
    row = spirals(FACES, 19, REST)[middle]
    away = REST[row[1:]] - REST[middle]
    angle = np.arctan2(-away[:, 1], away[:, 0])  # y is down
    assert angle[0] == pytest.approx(0.0, abs=0.05)
    for ring in (angle[:6], angle[6:]):
        steps = np.diff(ring) % (2 * np.pi)
        assert steps.max() < np.radians(65)
        assert steps.sum() < 2 * np.pi
    flipped = spirals(FACES[:, ::-1], 7, REST)[middle]
    assert flipped.tolist() == [row[0], row[1], *row[6:1:-1].tolist()]


def test_spirals_depend_on_nothing_but_the_mesh():
    shuffled = np.random.default_rng(0).permutation(len(FACES))
    inner = rings(FACES, 0)
    table, other = spirals(FACES, 25, REST), spirals(FACES[shuffled], 25, REST)
    assert np.array_equal(table, spirals(FACES, 25, REST))
    assert np.array_equal(table, other)
    assert len(inner) == len(REST)


def test_where_the_mesh_ends_the_vertex_fills_the_row():
    rest, faces = np.array([[0.0, 0], [1, 0], [0, 1], [1, 1], [9, 9]]), np.array([[0, 1, 2], [1, 3, 2]])
    table = spirals(faces, 6, rest)
    assert table.tolist() == [
        [0, 1, 2, 3, 0, 0],
        [1, 3, 2, 0, 1, 1],
        [2, 3, 0, 1, 2, 2],
        [3, 1, 2, 0, 3, 3],
        [4, 4, 4, 4, 4, 4],  # of no face
    ]
    assert spirals(faces, 1, rest).tolist() == [[0], [1], [2], [3], [4]]


def test_a_table_above_rs_is_refused():
    assert check_storage(6182, 100, 20) == 49_456_000 <= STORAGE
    with pytest.raises(SimCoreError, match=r"6182 vertices x 100 x 21 channels take 51.9 MB .* 50 MB"):
        check_storage(6182, 100, 21)
    with pytest.raises(SimCoreError, match="^spirals: "):
        spirals(FACES, 100, REST, channels=10_000)
    with pytest.raises(SimCoreError, match="^count: 0"):
        spirals(FACES, 0, REST)
