"""How far a hanging sheet is from the converged one, by the edge length of its mesh and the seconds to make that.

A horizontal 1 x 1 m sheet is let go with one edge pinned; after 0.4 s its places at a grid of cloth points are
compared with those on the finest mesh. The floor is what the two finest meshes still differ by.
"""

from time import perf_counter

import numpy as np

from sim_core.cloth import Phase, drape
from sim_core.cloth.scenes import GF_CM
from sim_core.cloth.sheet import Sheet
from sim_core.mesh import panel_mesh

SQUARE = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
EDGES, FINEST = (0.12, 0.08, 0.06, 0.04, 0.0283), (0.0141, 0.01)
SECONDS = 0.4
PROBES = np.stack(np.meshgrid(*[np.linspace(0.01, 0.99, 25)] * 2), axis=-1).reshape(-1, 2)


def at_probes(mesh, positions: np.ndarray) -> np.ndarray:
    """Positions (k, 3) [m] of the cloth points PROBES, linear within each triangle."""
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    u, v = b - a, c - a
    double = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    found = np.zeros((len(PROBES), 3))
    for k, probe in enumerate(PROBES):
        w = probe - a
        s = (w[:, 0] * v[:, 1] - w[:, 1] * v[:, 0]) / double
        t = (u[:, 0] * w[:, 1] - u[:, 1] * w[:, 0]) / double
        face = int(np.minimum(np.minimum(s, t), 1 - s - t).argmax())
        shares = np.array([1 - s[face] - t[face], s[face], t[face]])
        found[k] = shares @ positions[mesh.faces[face]]
    return found


def hung(edge: float, quality: str):
    mesh = panel_mesh(SQUARE, edge=edge, quality=quality)
    meshing = min(panel_mesh(SQUARE, edge=edge, quality=quality).report.seconds for _ in range(5))
    sheet = Sheet.of(mesh.vertices, mesh.faces, GF_CM)
    start = np.stack([mesh.vertices[:, 0], np.zeros(len(mesh.vertices)), mesh.vertices[:, 1]], axis=1)
    pins = tuple(int(k) for k in np.flatnonzero(mesh.vertices[:, 1] < 1e-9))
    begin = perf_counter()
    end = drape(sheet, start, (Phase(SECONDS, label="hanging"),), pins=pins)
    return mesh, meshing, perf_counter() - begin, at_probes(mesh, end.positions)


def hanging(*, quick: bool) -> dict:
    """Rows of edge, quality, seconds and error; and the floor of the reference [mm]."""
    edges, finest = (EDGES[:2], (0.06, 0.05)) if quick else (EDGES, FINEST)
    coarse, fine = (hung(edge, "best")[3] for edge in finest)
    floor = float(np.hypot.reduce(fine - coarse, axis=1).mean() * 1e3)
    rows = []
    for edge in edges:
        for quality in ("fair", "best"):
            mesh, meshing, draping, places = hung(edge, quality)
            gap = np.hypot.reduce(places - fine, axis=1) * 1e3
            rows.append(
                {
                    "edge": edge,
                    "quality": quality,
                    "vertices": len(mesh.vertices),
                    "mesh_seconds": meshing,
                    "drape_seconds": draping,
                    "min_angle_deg": mesh.report.min_angle_deg,
                    "mean_quality": mesh.report.mean_quality,
                    "error_mean_mm": float(gap.mean()),
                    "error_max_mm": float(gap.max()),
                }
            )
            row = rows[-1]
            print(
                f"cloth  edge {edge:.3f} {quality:<5}{row['vertices']:>6}  mesh {meshing:.4f} s drape {draping:6.2f} s"
                f"  angle {row['min_angle_deg']:.1f} q {row['mean_quality']:.4f}"
                f"  error {row['error_mean_mm']:.2f} mm mean {row['error_max_mm']:.1f} max",
                flush=True,
            )
    print(f"floor of the reference: {floor:.2f} mm")
    return {"rows": rows, "floor_mm": floor, "reference_edge": finest[1], "seconds": SECONDS}
