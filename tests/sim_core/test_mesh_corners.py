"""Lines that cross, meet at one point or end on the outline: no sides finer than what lies there asks for, and no small
angles but the lines' own and few beside a narrow corner."""

from functools import partial
from unittest import mock

import numpy as np
import pytest
from crossing_lines import (
    EDGE,
    Panel,
    best_mesh,
    branch,
    bundle,
    crossing_pairs,
    fixed_steps,
    measured,
    random_lines,
    touching,
)
from exact_delaunay import delaunay_faults

from sim_core.mesh.improvement import best
from sim_core.mesh.measures import mesh_fault
from sim_core.mesh.outline import clean_lines

CASCADES = {
    (286, 361): "6.9 degrees: sides of 3e-11 m",
    (388, 467): "4.6 degrees: sides of 4e-11 m",
    (91, 214): "75.8 degrees: sides of 1e-10 m",
    (153, 234): "62.4 degrees: two and a half times the vertices",
}
KINDS = {
    "bundles": partial(bundle, joined=True),
    "bundles that rounding parts": partial(bundle, joined=False),
    "branches": branch,
    "lines that end on the outline": touching,
}
FINEST = {
    "pair": 100,
    "other": 400,
}  # times finer than the least feature: of what else lies at many-lined corners
OPEN = 10.0  # [degrees] pairs that cross at more have no small angles but their own


def assert_in_measure(panel: Panel, kind: str = "other") -> None:
    """Sound, exactly Delaunay, no cascade, and small angles only at narrow corners: few, and none far below theirs."""
    mesh = best_mesh(panel)
    assert mesh_fault(mesh.vertices, mesh.faces, mesh.boundary, mesh.lines) is None
    assert delaunay_faults(mesh.vertices, mesh.faces, fixed_steps(mesh)) == []
    found = measured(panel, mesh)
    assert found.side >= min(found.feature, EDGE) / FINEST[kind], found
    if (
        found.astray
    ):  # a slit that takes more points than may be put in stays as it was, and nothing else does
        with mock.patch.object(best, "ADDED_AT_LEAST", 10 * best.ADDED_AT_LEAST):
            whole = best_mesh(panel)
        assert len(whole.vertices) > best.ADDED_AT_LEAST, found
        found = measured(panel, whole)
    assert found.astray == 0, found
    assert found.beside >= 0.5, found
    if kind == "pair":
        assert found.vertices <= 1300, found
        assert found.small == 0 if found.own >= OPEN else found.crowd <= 24, found


@pytest.mark.parametrize("names", CASCADES, ids=str)
def test_lines_that_cross_are_not_divided_for_ever(names):
    assert_in_measure(next(pair.panel for pair in crossing_pairs(0) if pair.names == names), "pair")


def test_pairs_that_cross_at_any_angle_stay_in_measure():
    for pair in crossing_pairs(1)[::6]:
        assert_in_measure(pair.panel, "pair")


@pytest.mark.parametrize("kind", KINDS)
def test_lines_that_meet_stay_in_measure(kind):
    for seed in (0, 7, 12, 22, 30):
        assert_in_measure(KINDS[kind](seed))


@pytest.mark.nightly
@pytest.mark.parametrize("seed", range(20))
def test_thousands_of_pairs_stay_in_measure(seed):
    for pair in crossing_pairs(seed):
        assert_in_measure(pair.panel, "pair")


@pytest.mark.nightly
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("block", range(5))
def test_hundreds_of_meeting_lines_stay_in_measure(kind, block):
    for seed in range(100 * block, 100 * block + 100):
        assert_in_measure(KINDS[kind](seed))


def test_lines_that_rounding_parts_meet_at_one_point():
    """Crossings of three lines were points 1e-17 m apart."""
    for seed in range(60):
        outline, lines = bundle(seed, joined=False)
        near = 1e-6 * 0.2
        found, _, _ = clean_lines(lines, [outline])
        ends = np.unique(np.concatenate([line[[0, -1]] for line in found]), axis=0)
        apart = np.hypot(*(ends[:, None] - ends).transpose(2, 0, 1))
        assert apart[apart > 0].min() > near
        given = np.concatenate(lines)
        assert (given[:, None] == ends).all(axis=2).any(axis=1).all()  # these stay where they are
        assert len(found) == 2 * len(lines)


def test_lines_that_cross_apart_stay_to_the_last_bit():
    from shapely import MultiLineString, get_coordinates, unary_union

    lines = random_lines(0)
    found, _, _ = clean_lines(list(lines), [np.array([[-0.1, -0.1], [1.1, -0.1], [1.1, 1.1], [-0.1, 1.1]])])
    exact = np.unique(get_coordinates(unary_union(MultiLineString(lines.tolist()))), axis=0)
    assert np.array_equal(np.unique(np.concatenate(found), axis=0), exact)
