"""Random simple polygons with and without holes, most of them nasty, and what a mesh of one must fulfil."""

import warnings

import numpy as np
from bench.signature import signed
from exact_delaunay import delaunay_faults

from sim_core.mesh import panel_mesh
from sim_core.mesh.measures import mesh_fault

__all__ = ["random_panel", "report_faults"]


def star(rng) -> np.ndarray:
    """Needles in all directions."""
    count = int(rng.integers(3, 40))
    angle = (np.arange(count) + rng.uniform(-0.45, 0.45, count)) * 2 * np.pi / count
    radius = rng.uniform(0.05, 1, count)
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])


def untangled(rng) -> np.ndarray:
    """Random points joined to a closed line without crossings (2-opt)."""
    points = rng.random((int(rng.integers(4, 14)), 2))
    for _ in range(400):
        n = len(points)
        for i in range(n):
            for j in range(i + 2, n if i else n - 1):
                a, b, c, d = points[i], points[i + 1], points[j], points[(j + 1) % n]
                if np.hypot(*(a - b)) + np.hypot(*(c - d)) > np.hypot(*(a - c)) + np.hypot(*(b - d)) + 1e-12:
                    points[i + 1 : j + 1] = points[i + 1 : j + 1][::-1].copy()
                    break
            else:
                continue
            break
        else:
            break
    return points


def stairs(rng) -> np.ndarray:
    """Right angles on a lattice: ties wherever one looks."""
    count = int(rng.integers(2, 9))
    heights = rng.integers(1, 6, count)
    top = [(x, h) for k, h in enumerate(heights) for x in (k, k + 1)]
    points = np.array([(0, 0), *top, (count, 0)], dtype=float)
    keep = [k for k in range(len(points)) if not np.array_equal(points[k], points[k - 1])]
    return points[keep] / 4


def comb(rng) -> np.ndarray:
    """Teeth that nearly touch."""
    teeth, gap = int(rng.integers(2, 7)), 10.0 ** rng.uniform(-6, -1)
    points = [(0.0, 1.0)]
    for k in range(teeth):
        points += [(k, 0.0), (k + 1 - gap, 0.0), (k + 1 - gap / 2, 0.9 - 0.1 * rng.random())]
    return np.array([*points[:-1], (teeth - gap, 1.0)]) / 2


def spike(rng) -> np.ndarray:
    """One corner of about a degree."""
    angle = np.radians(rng.uniform(0.3, 3))
    side = rng.uniform(0.5, 2)
    tip = side * np.column_stack([np.cos([0, angle]), np.sin([0, angle])])
    return np.vstack([[0, 0], tip[0], tip.mean(axis=0) + (0.3, 0.1 * rng.random()), tip[1]])


def strip(rng) -> np.ndarray:
    """Thinner than any edge."""
    wide, high = rng.uniform(0.5, 2), 10.0 ** rng.uniform(-4, -1)
    return np.array([[0, 0], [wide, 0], [wide, high], [0, high]]) + rng.uniform(0, 0.2 * high, (4, 2))


def ring(rng) -> np.ndarray:
    """All points on one circle."""
    angle = np.sort(rng.random(int(rng.integers(3, 60)))) * 2 * np.pi
    if rng.random() < 0.5:
        angle = np.arange(int(rng.integers(3, 60))) * 2 * np.pi
        angle /= len(angle)
    return np.column_stack([np.cos(angle), np.sin(angle)]) * 0.5


def close_points(rng) -> np.ndarray:
    """Corners a hair apart."""
    points = untangled(rng)
    return np.repeat(points, 2, axis=0) + np.tile([[0, 0], [1e-9, 1e-9]], (len(points), 1))


KINDS = (star, untangled, stairs, comb, spike, strip, ring, close_points)


def random_panel(seed: int):
    """(outline, holes, edge [m], quality) of a random panel that can be meshed."""
    from shapely import Polygon
    from shapely.affinity import affine_transform

    rng = np.random.default_rng(seed)
    while True:
        kind = KINDS[int(rng.integers(len(KINDS)))]
        shape = Polygon(kind(rng))
        if not shape.is_valid or shape.area < 1e-6 * max(shape.length, 1e-9) ** 2 / 16:
            continue
        holes = []
        if rng.random() < 0.5:
            for _ in range(int(rng.integers(1, 5))):
                hole = Polygon(KINDS[int(rng.integers(len(KINDS)))](rng))
                size = 10.0 ** rng.uniform(-1.5, -0.3)
                x, y = shape.bounds[:2] + rng.random(2) * np.ptp(np.reshape(shape.bounds, (2, 2)), axis=0)
                hole = affine_transform(hole, [size, 0, 0, size, x, y])
                clear = all(hole.distance(other) > 1e-5 for other in holes)
                if hole.is_valid and hole.area > 1e-7 and clear and shape.contains(hole):
                    if hole.distance(shape.exterior) > 1e-5:
                        holes.append(hole)
        turn, move = rng.random() * 2 * np.pi * (rng.random() < 0.5), 1e3 * (rng.random() < 0.3)
        c, s = np.cos(turn), np.sin(turn)

        def placed(polygon, c=c, s=s, move=move):
            return np.array(polygon.exterior.coords)[:-1] @ np.array([[c, s], [-s, c]]) + move

        extent = float(np.ptp(np.array(shape.exterior.coords), axis=0).max())
        edge = extent / rng.uniform(1.5, 25)
        quality = ("fair", "light", "best")[int(rng.integers(3))]
        return placed(shape), [placed(hole) for hole in holes], edge, quality


def report_faults(seed: int) -> list[str]:
    """Everything that is wrong with the mesh of `random_panel(seed)`: empty where it is sound and exactly Delaunay."""
    outline, holes, edge, quality = random_panel(seed)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        mesh = panel_mesh(outline, edge=edge, holes=holes, quality=quality)
    found = []
    fault = mesh_fault(mesh.vertices, mesh.faces, mesh.boundary)
    if fault is not None:
        found.append(fault[0])
    if len(mesh.boundary) != 1 + len(holes):
        found.append("loops")
    if mesh.report.outline_deviation > 0.05 * edge:
        found.append(f"deviation {mesh.report.outline_deviation / edge:.3f} edge")
    steps = np.concatenate([np.column_stack([loop, np.roll(loop, -1)]) for loop in mesh.boundary])
    return found + delaunay_faults(mesh.vertices, mesh.faces, steps)


def main() -> int:
    """Count bad meshes among the first so many seeds; --json FILE writes the count."""
    import argparse
    import json
    from pathlib import Path

    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("count", type=int)
    parser.add_argument("--json", type=Path)
    args = parser.parse_args()
    bad, holes = {}, 0
    for seed in range(args.count):
        holes += bool(random_panel(seed)[1])
        try:
            faults = report_faults(seed)
        except Exception as error:  # a refusal counts like any other fault
            faults = [f"{type(error).__name__}: {error}"]
        if faults:
            bad[seed] = faults[:3]
            print(seed, faults[:3], flush=True)
    told = {"polygons": args.count, "with_holes": holes, "bad": len(bad), "faults": bad}
    print(f"{args.count} polygons, {holes} with holes: {len(bad)} bad meshes")
    if args.json:
        args.json.write_text(json.dumps(signed(told), indent=1) + "\n", "utf-8")
    return 1 if bad else 0


if __name__ == "__main__":
    raise SystemExit(main())
