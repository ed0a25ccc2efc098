"""The figures of a finished mesh: how good its triangles are, and how far it is from the contours that were given."""

from dataclasses import asdict, dataclass

import numpy as np
from numba import njit

from sim_core.mesh.measures.triangles import quality
from sim_core.mesh.measures.verification import area_error, conformity

__all__ = ["MeshReport", "deviation", "measured"]

MOST_TRIED = 32


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


def measured(vertices, faces, boundary, free) -> MeshReport:
    """Measure a finished mesh, but for time and deviation (0). Arrays as in PanelMesh; free: its `open_edges`."""
    angle, shape, ratio = quality(vertices, faces)
    return MeshReport(
        seconds=0.0,
        min_angle_deg=float(angle.min()),
        mean_quality=float(shape.mean()),
        worst_quality=float(shape.min()),
        mean_edge_ratio=float(ratio.mean()),
        worst_edge_ratio=float(ratio.min()),
        area_error=area_error(vertices, faces, boundary),
        conformity=conformity(free, boundary, len(vertices)),
        outline_deviation=0.0,
    )


def deviation(given: list[np.ndarray], loops: list[np.ndarray], *, merged: bool = False) -> float:
    """Hausdorff distance [m] between given contours and meshed ones, from the points and middles of their steps.

    given, loops: (n, 2) [m] each; compared one by one, or all with all where holes were merged.
    """
    if merged:
        return max(_apart(given, loops), _apart(loops, given))
    worst = 0.0
    for contour, loop in zip(given, loops, strict=True):
        passed = _passed(contour, loop)
        if passed[0] < 0:
            worst = max(worst, _apart([contour], [loop]), _apart([loop], [contour]))
            continue
        along, across = _bounds(contour, loop, passed)
        worst = _farthest(_probes(loop), contour, along, worst)
        worst = _farthest(_probes(contour), loop, across, worst)
    return worst


def _probes(contour: np.ndarray) -> np.ndarray:
    """The points of a closed contour (n, 2) and the middles of its steps, in turn. (2 n, 2)"""
    return np.stack([contour, (contour + np.roll(contour, -1, axis=0)) / 2], axis=1).reshape(-1, 2)


def _apart(given: list[np.ndarray], others: list[np.ndarray]) -> float:
    """Largest distance [m] from the probes of contours to other contours that have nothing to do with their order."""
    from shapely import LineString, STRtree, points

    steps = np.concatenate([np.stack([c, np.roll(c, -1, axis=0)], axis=1) for c in others])
    probes = np.concatenate([_probes(contour) for contour in given])
    tree = STRtree([LineString(step) for step in steps])
    return float(tree.query_nearest(points(probes), all_matches=False, return_distance=True)[1].max())


def _farthest(probes: np.ndarray, contour: np.ndarray, bounds: np.ndarray, worst: float) -> float:
    """The largest of `worst` and the distances [m] from probes (n, 2) to a closed contour, which are at most `bounds`
    (n,) [m]. Where too many bounds are no distances, because contours run side by side, the bound itself counts."""
    for tried, k in enumerate(np.argsort(-bounds, kind="stable")):
        if bounds[k] <= worst:
            break
        worst = max(worst, float(bounds[k]) if tried >= MOST_TRIED else _nearest(probes[k], contour))
    return worst


@njit(cache=True, error_model="numpy")
def _gap(x, y, contour, k):
    """Distance [m] from a place to step k of a closed contour."""
    m = (k + 1) % len(contour)
    ux, uy = contour[m, 0] - contour[k, 0], contour[m, 1] - contour[k, 1]
    px, py = x - contour[k, 0], y - contour[k, 1]
    t = min(max((px * ux + py * uy) / max(ux * ux + uy * uy, 1e-300), 0.0), 1.0)
    return np.hypot(px - t * ux, py - t * uy)


@njit(cache=True, error_model="numpy")
def _nearest(place, contour):
    """Distance [m] from a place (2,) to a closed contour (n, 2)."""
    nearest = np.inf
    for k in range(len(contour)):
        nearest = min(nearest, _gap(place[0], place[1], contour, k))
    return nearest


@njit(cache=True, error_model="numpy")
def _passed(contour, loop):
    """Steps of a contour (n, 2) that the points of a loop (m, 2) sampled from it lie on, counted on from turn to turn.
    (m + 1,), the last the first again; all -1 where a point lies on none."""
    count = len(contour)
    near = 1e-9 * (np.abs(contour[:, 0] - contour[0, 0]).max() + np.abs(contour[:, 1] - contour[0, 1]).max())
    passed = np.full(len(loop) + 1, -1)
    k = 0
    for m in range(len(loop)):
        last = k + count
        while k < last and _gap(loop[m, 0], loop[m, 1], contour, k % count) > near:
            k += 1
        if k == last or k - max(passed[0], 0) > count:
            passed[:] = -1
            return passed
        passed[m] = k
    passed[-1] = passed[0] + count
    return passed


@njit(cache=True, error_model="numpy")
def _bounds(contour, loop, passed):
    """What the distances [m] between the probes of a loop and the contour, and the other way, are not above: told from
    the steps that lie beside each other."""
    along, across = np.zeros(2 * len(loop)), np.full(2 * len(contour), np.inf)
    for m in range(len(loop)):
        here, ahead = loop[m], loop[(m + 1) % len(loop)]
        x, y = (here[0] + ahead[0]) / 2, (here[1] + ahead[1]) / 2
        along[2 * m] = _gap(here[0], here[1], contour, passed[m] % len(contour))
        along[2 * m + 1] = np.inf
        for turn in range(passed[m], passed[m + 1] + 1):
            k = turn % len(contour)
            n = (k + 1) % len(contour)
            along[2 * m + 1] = min(along[2 * m + 1], _gap(x, y, contour, k))
            across[2 * n] = min(across[2 * n], _gap(contour[n, 0], contour[n, 1], loop, m))
            cx, cy = (contour[k, 0] + contour[n, 0]) / 2, (contour[k, 1] + contour[n, 1]) / 2
            across[2 * k + 1] = min(across[2 * k + 1], _gap(cx, cy, loop, m))
    return along, across
