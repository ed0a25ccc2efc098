"""Outlines, point sets and error measures of the meshing bench."""

import numpy as np

from sim_core.mesh import inside, keep_points, quality, staggered_points
from sim_core.mesh.measures import triangle_areas
from sim_core.mesh.outline import clean_contours, sampled_contours, signed_area

TURN = np.arange(64) * 2 * np.pi / 64
ROUND = np.column_stack([np.cos(TURN), np.sin(TURN)])


def half_robe() -> np.ndarray:
    """Half a robe cut flat: neck curve, sleeve, concave underarm. (n, 2) [m], y down."""
    t = np.linspace(0, 1, 15)[:, None]
    neck = 0.09 * np.column_stack([np.sin(t * np.pi / 2), np.cos(t * np.pi / 2)])
    a, b, c, d = np.array([[0.35, 0.32], [0.27, 0.33], [0.26, 0.36], [0.27, 0.45]])
    arm = (1 - t) ** 3 * a + 3 * (1 - t) ** 2 * t * b + 3 * (1 - t) * t**2 * c + t**3 * d
    return np.vstack([neck, [[0.75, 0.02], [0.75, 0.3]], arm, [[0.38, 1.2], [0, 1.22]]])


PANELS = {
    "rectangle": (np.array([[0, 0], [1, 0], [1, 0.7], [0, 0.7]]), ()),
    "half robe": (half_robe(), ()),
    "hole": (np.array([[0.2, 0], [0.8, 0], [1, 0.9], [0, 0.9]]), (0.15 * ROUND + (0.5, 0.45),)),
}
AREAS = {"rectangle": 0.7, "half robe": 0.515, "hole": 0.65}  # [m2], to choose edges by


def edge_for(panel: str, points: int) -> float:
    """The edge [m] at which a panel has about that many points."""
    return float(np.sqrt(AREAS[panel] / points * 2 / np.sqrt(3)))


class PointSet:
    """Samples and lattice of a panel, filtered as for growth. points: (n, 2) [m]; steps: (m, 2) directed edges."""

    def __init__(self, panel: str, edge: float) -> None:
        outline, holes = PANELS[panel]
        self.panel, self.edge = panel, edge
        self.samples = sampled_contours(clean_contours(outline, holes), edge)
        low, high = self.samples[0].min(axis=0), self.samples[0].max(axis=0)
        kept = keep_points(staggered_points(low, high, edge), self.samples, edge=edge)
        self.points = np.concatenate([*self.samples, kept])
        loops = np.split(
            np.arange(sum(map(len, self.samples))), np.cumsum([len(s) for s in self.samples])[:-1]
        )
        self.steps = np.concatenate([np.column_stack([loop, np.roll(loop, -1)]) for loop in loops])
        self.lengths = np.array([len(s) for s in self.samples])
        self.inside_holes = np.array([hole.mean(axis=0) for hole in holes]).reshape(-1, 2)

    def culled(self, faces: np.ndarray) -> np.ndarray:
        """Faces inside the panel, of a triangulation of the convex hull."""
        return faces[inside(self.points[faces].mean(axis=1), self.samples)]


def errors(vertices: np.ndarray, faces: np.ndarray, case: PointSet) -> dict:
    """Area error, slivers and lost outline steps of a triangulation of the case's points."""
    wanted = sum(signed_area(loop) for loop in case.samples)
    areas = np.abs(triangle_areas(vertices, faces))
    wide = faces.astype(np.int64)
    ahead = np.sort(np.concatenate([wide[:, [0, 1]], wide[:, [1, 2]], wide[:, [2, 0]]]), axis=1)
    steps = np.sort(case.steps, axis=1)
    count = len(vertices)
    lost = ~np.isin(steps[:, 0] * count + steps[:, 1], ahead[:, 0] * count + ahead[:, 1])
    return {
        "faces": len(faces),
        "area_error": abs(float(areas.sum()) - wanted) / wanted,
        "slivers": int((areas < 1e-9 * areas.mean()).sum()),
        "outline_steps_lost": int(lost.sum()),
    }


def shape(vertices: np.ndarray, faces: np.ndarray) -> dict:
    """Quality figures of a mesh."""
    angle, q, ratio = quality(vertices, faces)
    return {
        "vertices": len(vertices),
        "min_angle_deg": float(angle.min()),
        "mean_quality": float(q.mean()),
        "worst_quality": float(q.min()),
        "mean_edge_ratio": float(ratio.mean()),
    }
