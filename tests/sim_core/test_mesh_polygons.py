"""Random polygons, most of them nasty: every mesh is sound and exactly (constrained) Delaunay. None may be refused.

`python tests/mesh_polygons.py 10000` runs as many as one likes and tells how many are bad.
"""

import pytest
from full_matrix import by_day
from mesh_polygons import report_faults


@pytest.mark.parametrize("block", by_day([0], range(6)))
def test_random_panels_are_sound_and_exactly_delaunay(block):
    assert {seed: f for seed in range(50 * block, 50 * block + 50) if (f := report_faults(seed))} == {}


def test_a_point_that_smoothing_moves_into_a_hole_is_dropped():
    assert report_faults(5667) == []


@pytest.mark.nightly
@pytest.mark.slow
def test_more_random_panels_are_sound_and_exactly_delaunay():
    assert {seed: f for seed in range(300, 1500) if (f := report_faults(seed))} == {}
