"""Which vertices of a fine mesh stay: by curvature, by quadrics, and two that look at neither.

`curvature` has the angle defects of Gauss and Bonnet; `decimation` is the published method, `quadrics` the better one;
`selection` has the ones to compare with; `pooled` is what comes of each.
"""

from sim_core.learn.pooling.curvature import angle_defects, gauss_curvature, mean_absolute_curvature
from sim_core.learn.pooling.decimation import decimate
from sim_core.learn.pooling.pooled import Pooled
from sim_core.learn.pooling.quadrics import collapse
from sim_core.learn.pooling.selection import farthest_points, random_points

__all__ = [
    "Pooled",
    "angle_defects",
    "collapse",
    "decimate",
    "farthest_points",
    "gauss_curvature",
    "mean_absolute_curvature",
    "random_points",
]
