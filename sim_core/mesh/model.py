"""The values that come out of the mesh room."""

from dataclasses import asdict, dataclass

import numpy as np

__all__ = ["MeshReport", "PanelMesh"]


@dataclass(frozen=True)
class MeshReport:
    """What was measured on a panel mesh.

    seconds: wall time of meshing.  compile_seconds: of making or fetching machine code meanwhile, not part of these.
    min_angle_deg: smallest angle of any triangle [degrees].
    mean_quality, worst_quality: of q = 4 sqrt(3) area / sum of squared edges, 1 = equilateral.
    mean_edge_ratio, worst_edge_ratio: of shortest / longest edge of a triangle.
    area_error: |mesh area - polygon area| / polygon area.  conformity: fraction of outline steps that are mesh edges.
    outline_deviation: Hausdorff distance [m] between the contours given (holes that touch: the rim they leave) and
    the meshed ones.
    """

    seconds: float
    min_angle_deg: float
    mean_quality: float
    worst_quality: float
    mean_edge_ratio: float
    worst_edge_ratio: float
    area_error: float
    conformity: float
    outline_deviation: float
    compile_seconds: float = 0.0

    def to_dict(self) -> dict[str, float]:
        """A plain dictionary that JSON can hold."""
        return asdict(self)


@dataclass(frozen=True, eq=False)
class PanelMesh:
    """A triangulated panel in pattern coordinates (metres, y down).

    vertices: (V, 2) float64 [m].  faces: (F, 3) int32, positive area in (x, -y).
    boundary: one array of vertex indices per contour, the outer one first; outer counter-clockwise and holes
    clockwise in (x, -y), so that the cloth lies to the left.
    lines: one array of vertex indices per inner line, open; their steps are edges of the mesh.
    """

    vertices: np.ndarray
    faces: np.ndarray
    boundary: tuple[np.ndarray, ...]
    report: MeshReport
    lines: tuple[np.ndarray, ...] = ()
