"""Lines that cross, meet at one point or end on the outline, by the least angle between them, beside Triangle.

Triangle gets the steps that `best` begins with, a bound of 30 degrees and the area of an equilateral triangle of the
edge. Told are the vertices, the shortest side by the least feature (the least distance of an end or crossing of lines
from a line it is not on, at most the edge) and the angles below 30 degrees that are none of the lines' own.
"""

import sys
from pathlib import Path

import numpy as np
from peers import Peers

sys.path.append(
    str(Path(__file__).parents[1])
)  # behind the project's own names, which the tests' folders bear too

from crossing_lines import EDGE, Panel, best_mesh, bundle, crossing_pairs, measured, touching  # noqa: E402

from sim_core.mesh.improvement import small_angles  # noqa: E402
from sim_core.mesh.measures import quality  # noqa: E402
from sim_core.mesh.outline import (  # noqa: E402
    Rim,
    clean_contours,  # noqa: E402
    clean_lines,  # noqa: E402
    sampled_rim,
)

__all__ = ["corners"]

ANGLES = (0.0, 0.3, 1.0, 2.0, 5.0, 10.0, 20.0, 30.0, 60.0, 91.0)  # [degrees] rows of the tables

SAME = 1e-12  # [m] points this near to a step lie on it


def panels(scale: int) -> dict[str, list[Panel]]:
    """All pairs of `scale` times 500 lines, and as many times 25 of the others."""
    pairs = [pair.panel for seed in range(scale) for pair in crossing_pairs(seed)]
    return {
        "pairs that cross": pairs,
        "bundles through one point": [bundle(seed, joined=False) for seed in range(25 * scale)],
        "lines that end on the outline": [touching(seed) for seed in range(25 * scale)],
    }


def corners(scale: int, peers: Peers | None) -> list[dict]:
    """Rows of kind and least angle: meshes, vertices, shortest sides and small angles, of `best` and of Triangle."""
    rows = []
    for kind, some in panels(scale).items():
        found = [_figures(panel, peers) for panel in some]
        for low, high in zip(ANGLES[:-1], ANGLES[1:], strict=True):
            here = [row for row in found if low <= row["own"] < high]
            if here:
                rows.append({"kind": kind, "angles": [low, high], "meshes": len(here), **_together(here)})
                _tell(rows[-1])
    return rows


def _figures(panel: Panel, peers: Peers | None) -> dict:
    own = measured(panel, best_mesh(panel))
    feature = min(own.feature, EDGE)
    row = {"own": own.own, "best": (own.vertices, own.side / feature, own.small, own.least)}
    row["beside"], row["astray"] = own.beside, own.astray
    if peers:
        row["Triangle"] = _triangle(panel, feature, peers)
    return row


def _triangle(panel: Panel, feature: float, peers: Peers) -> tuple[int, float, int, float]:
    lines, contours, kept = clean_lines(panel.lines, clean_contours(panel.outline, ()))
    rim = sampled_rim(contours, EDGE, lines=lines, kept=kept)
    area = np.sqrt(3) / 4 * EDGE**2
    made = peers.run(
        "triangle",
        points=rim.points,
        steps=np.unique(np.sort(rim.steps, axis=1), axis=0),
        inside_holes=np.zeros((0, 2)),
        switches=np.array(f"pq30a{area:.9f}Q"),
    )
    places, faces = made["vertices"], np.asarray(made["faces"])
    along = places[faces] - np.roll(places[faces], 1, axis=1)
    side = float(np.hypot(along[..., 0], along[..., 1]).min())
    small = small_angles(places, faces, _on(rim, places, faces))
    least = float(quality(places, faces[small]).min_angle.min()) if small.any() else 90.0
    return len(places), side / feature, int(small.sum()), least


def _on(rim: Rim, places: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """The edges (k, 2) of a mesh that lie on the steps of a rim."""
    from shapely import dwithin, linestrings, multilinestrings, points, prepare

    drawn = multilinestrings(linestrings(rim.points[rim.steps]))
    prepare(drawn)
    edges = np.unique(np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0)
    for share in (0.0, 0.5, 1.0):
        there = share * places[edges[:, 0]] + (1 - share) * places[edges[:, 1]]
        edges = edges[dwithin(drawn, points(there), SAME)]
    return edges


def _together(rows: list[dict]) -> dict:
    told: dict = {"beside": min(row["beside"] for row in rows), "astray": sum(row["astray"] for row in rows)}
    for engine in ("best", "Triangle"):
        if engine in rows[0]:
            vertices, side, small, least = np.array([row[engine] for row in rows]).T
            told[engine] = {
                "vertices_median": float(np.median(vertices)),
                "vertices_most": int(vertices.max()),
                "side_by_feature": float(side.min()),
                "small": int(small.sum()),
                "small_most": int(small.max()),
                "meshes_with_small": int((small > 0).sum()),
                "least_deg": float(least.min()),
            }
    return told


def _tell(row: dict) -> None:
    low, high = row["angles"]
    told = f"{row['kind']:<30}{low:>5g} to {high:>3g} degrees{row['meshes']:>6} meshes"
    for engine in ("best", "Triangle"):
        if engine in row:
            of = row[engine]
            told += (
                f"  {engine}: vertices {of['vertices_median']:.0f}, at most {of['vertices_most']},"
                f" side {of['side_by_feature']:.4f}, small {of['small']} in {of['meshes_with_small']} meshes"
            )
    print(told, flush=True)
