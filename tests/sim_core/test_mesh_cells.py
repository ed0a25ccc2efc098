"""Points in cells: by place within each, however crowded it is."""

import numpy as np
import pytest

from sim_core.mesh.geometry import point_cells


@pytest.mark.parametrize("count", [20, 41, 42, 3000])
def test_a_crowded_cell_is_sorted_by_y_then_x_and_equal_points_by_number(count):
    """From forty points on a cell is sorted by other means."""
    rng = np.random.default_rng(count)
    crowd = 1e-9 * rng.integers(0, 6, (count, 2))
    points = np.concatenate([crowd, [[1.0, 0.5], [0.5, 1.0]]])
    order, cells = point_cells(points)
    assert np.count_nonzero(np.diff(cells.start)) == 3  # the crowd shares one cell
    assert order[:count].tolist() == np.lexsort((np.arange(count), crowd[:, 0], crowd[:, 1])).tolist()
    assert sorted(order[count:].tolist()) == [count, count + 1]
