"""Shapes that grow, and small holes at long edges: time by the number of points, angles and counts beside Triangle's.

For the growing shapes Triangle gets the outline as it is drawn, and `p` alone: no steps of the edge's length, so far
fewer points than a panel mesh has. For the holes it has a bound of 30 degrees and the area of an equilateral triangle
of the edge, on the outline as it is drawn and on the steps of `best`: counts compare on one outline only.
Small angles that a corner of the outline has by itself do not count, for either.
"""

import sys
from pathlib import Path

import numpy as np
from peers import Peers

sys.path.append(
    str(Path(__file__).parents[1])
)  # behind the project's own names, which the tests' folders bear too

from growing_shapes import SHAPES, small_holes  # noqa: E402

from sim_core.mesh import panel_mesh, quality  # noqa: E402
from sim_core.mesh.improvement import small_angles  # noqa: E402
from sim_core.mesh.outline import clean_contours  # noqa: E402

__all__ = ["grading", "growing"]

SIZES = {"quick": [500, 1000, 2000], "usual": [1000, 2000, 5000, 10_000, 20_000, 50_000]}
MOST_BEST = 5000  # points up to which `best` is run too: the comb gets a mesh of millions beyond


def growing(sizes: list[int], peers: Peers | None) -> list[dict]:
    """Rows of shape, points given, engine, seconds, vertices, smallest angle."""
    rows = []
    for shape, made in SHAPES.items():
        for size in sizes:
            outline, holes, edge = made(size)
            given = len(outline) + sum(map(len, holes))
            for kind in ("fair", "best") if size <= MOST_BEST else ("fair",):
                mesh = panel_mesh(outline, holes=holes, edge=edge, quality=kind)
                rows.append(
                    _row(shape, given, kind, mesh.report.seconds, mesh.vertices, mesh.faces, mesh.boundary)
                )
            if peers:
                rows.append(_triangle(shape, given, outline, holes, "pQ", peers))
            for row in rows[-3:]:
                if row["points"] == given and row["shape"] == shape:
                    _tell(row)
    return rows


def grading(counts: list[int], peers: Peers | None) -> list[dict]:
    """Rows as of `growing` for round holes of 2 mm at edges of 50 mm."""
    rows = []
    for count in counts:
        outline, holes, edge = small_holes(count)
        mesh = panel_mesh(outline, holes=holes, edge=edge, quality="best")
        given = len(outline) + sum(map(len, holes))
        name = f"{len(holes)} holes of 2 mm"
        rows.append(_row(name, given, "best", mesh.report.seconds, mesh.vertices, mesh.faces, mesh.boundary))
        _tell(rows[-1])
        if peers:
            area = np.sqrt(3) / 4 * edge**2
            loops = [mesh.vertices[loop] for loop in mesh.boundary]
            for engine, shapes in (("as drawn", [outline, *holes]), ("best's outline", loops)):
                rows.append(
                    _triangle(name, given, shapes[0], shapes[1:], f"pq30a{area:.9f}Q", peers)
                    | {"outline": engine}
                )
                _tell(rows[-1])
    return rows


def _triangle(shape: str, given: int, outline, holes, switches: str, peers: Peers) -> dict:
    contours = clean_contours(outline, holes)
    first = np.cumsum([0, *(len(c) for c in contours)])
    loops = [np.arange(len(c)) + k for c, k in zip(contours, first, strict=False)]
    steps = np.concatenate([np.column_stack([loop, np.roll(loop, -1)]) for loop in loops])
    points = np.concatenate(contours)
    inside = np.array([hole.mean(axis=0) for hole in contours[1:]]).reshape(-1, 2)
    made = peers.run("triangle", points=points, steps=steps, inside_holes=inside, switches=np.array(switches))
    row = _row(
        shape, given, f"Triangle {switches[:-1]}", made["seconds"], made["vertices"], made["faces"], None
    )
    return row | {"small": _small(made["vertices"], made["faces"])}


def _row(shape, given: int, engine: str, seconds: float, vertices, faces, boundary) -> dict:
    angle = quality(vertices, faces).min_angle
    row = {"shape": shape, "points": given, "engine": engine, "seconds": seconds, "vertices": len(vertices)}
    row |= {"min_angle_deg": float(angle.min()), "small": 0}
    if boundary is not None:
        steps = np.concatenate([np.column_stack([loop, np.roll(loop, -1)]) for loop in boundary])
        row["small"] = int(small_angles(vertices, faces, steps).sum())
    return row


def _small(vertices, faces) -> int:
    """Small angles of Triangle's mesh that are none of the outline's: its outline is the mesh's open edges."""
    count = len(vertices)
    ahead = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]).astype(np.int64)
    open_ = ahead[~np.isin(ahead @ (count, 1), ahead[:, ::-1] @ (count, 1))]
    return int(small_angles(vertices, faces, open_).sum())


def _tell(row: dict) -> None:
    print(
        f"{row['shape']:<22}{row['points']:>8} given  {row['engine']:<24}{row['vertices']:>9}{row['seconds']:>9.3f} s"
        f"  angle {row['min_angle_deg']:>6.2f}  below 30 {row['small']:>7}",
        flush=True,
    )
