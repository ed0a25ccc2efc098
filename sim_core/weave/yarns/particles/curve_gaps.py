"""How far the curves of crossing yarns are apart, and by how much their particles must keep farther for that."""

import numpy as np
from numba import njit

from sim_core.weave.yarns.particles.closest_pairs import half_pieces, is_minimum, least_by_line, polished

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
            half_pieces(wu, wz, e, c1, reach1, warp)
            half_pieces(fu, fz, i, j * per, reach2, weft)
            for norm in range(2):
                over_x = 1.0 / wide_x**2 if norm == 0 else 1.0
                over_y = 1.0 / wide_y**2 if norm == 1 else 1.0
                best = 4.0
                lines = least_by_line(
                    warp, weft, reach1, reach2, l1, l2, over_x, over_y, sign, norm, grid, least, where
                )
                for a in range(lines):
                    here = least[a]
                    best = min(best, here)
                    if not is_minimum(least, a, lines):
                        continue
                    s, t = 0.5 * (where[a] if norm else a) - reach1, 0.5 * (a if norm else where[a]) - reach2
                    s1, t1, square = polished(
                        s, t, wu, wz, e, c1, l1, fu, fz, i, j * per, l2, over_x, over_y, sign
                    )
                    if square < here and abs(s1) <= reach1 + 1 and abs(t1) <= reach2 + 1:
                        best = min(best, square)
                gaps[i, j, norm] = np.sqrt(best) - 1.0
