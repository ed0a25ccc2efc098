"""How far the curves of crossing yarns are apart, and by how much their particles must keep farther for that."""

import numpy as np
from numba import njit

from sim_core.weave.closest_pairs import LOW, NEAR, _place, _polished

__all__ = ["curve_gaps"]


@njit(cache=True, error_model="numpy")
def curve_gaps(wu, wz, fu, fz, lift, per, l1, l2, wide_x, wide_y, reach1, reach2, gaps):
    """How far the curves of crossing yarns are from touching, in each of the two norms; less than 0 where they overlap.

    wu, wz: (ends, picks * per), fu, fz: (picks, ends * per) [D], curves through these as in curve_overlap, the minima
    of whose distance are found likewise.  gaps: (picks, ends, 2) [D], written: round the warp, round the weft; yarns
    farther than 1 D beyond touching count as that far.
    """
    picks, ends = lift.shape
    rows, columns = 4 * reach1 + 1, 4 * reach2 + 1
    warp, weft, grid = np.zeros((rows, 2)), np.zeros((columns, 2)), np.zeros((rows, columns))
    least, where = np.zeros(max(rows, columns)), np.zeros(max(rows, columns), np.int64)
    for i in range(picks):
        for j in range(ends):
            sign = 1.0 if lift[i, j] else -1.0
            e, c1 = j, i * per
            for a in range(rows):
                warp[a, 0], warp[a, 1], _, _, _, _ = _place(wu, wz, e, c1, 0.5 * a - reach1)
            for b in range(columns):
                weft[b, 0], weft[b, 1], _, _, _, _ = _place(fu, fz, i, j * per, 0.5 * b - reach2)
            for norm in range(2):
                over_x = 1.0 / wide_x**2 if norm == 0 else 1.0
                over_y = 1.0 / wide_y**2 if norm == 1 else 1.0
                best = 4.0
                for a in range(rows):
                    for b in range(columns):
                        x = warp[a, 0] - (0.5 * b - reach2) * l2
                        d = (0.5 * a - reach1) * l1 - weft[b, 0]
                        high = max(sign * (warp[a, 1] - weft[b, 1]), LOW)
                        grid[a, b] = x * x * over_x + d * d * over_y + high * high
                lines = columns if norm else rows
                for a in range(lines):
                    line = grid[:, a] if norm else grid[a]
                    where[a] = np.argmin(line)
                    least[a] = line[where[a]]
                for a in range(lines):
                    here = least[a]
                    best = min(best, here)
                    if (
                        here > NEAR * NEAR
                        or (a > 0 and least[a - 1] < here)
                        or (a < lines - 1 and least[a + 1] < here)
                    ):
                        continue
                    s, t = 0.5 * (where[a] if norm else a) - reach1, 0.5 * (a if norm else where[a]) - reach2
                    s1, t1, square = _polished(
                        s, t, wu, wz, e, c1, l1, fu, fz, i, j * per, l2, over_x, over_y, sign
                    )
                    if square < here and abs(s1) <= reach1 + 1 and abs(t1) <= reach2 + 1:
                        best = min(best, square)
                gaps[i, j, norm] = np.sqrt(best) - 1.0
