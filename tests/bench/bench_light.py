"""Rays of the light bake: rays a second and error, beside trimesh.

    python tests/bench/bench_light.py [--rays N] [--rounds N] [--content FOLDER] [--json FILE]

The mesh is what the room's light is computed on: the hall of the content folder with its exhibits. Rays start on the
room's surfaces as the bake's do: cosine-distributed about the normal. nearest: the first triangle and its distance;
blocked: whether anything is in the way within a limit, here the ray to the next ray's start, as to a point on a lamp.
Engines: the bake's (Embree, robust), Embree without its robust mode, and trimesh, which casts rays with Embree, too;
they take turns, every one on one thread, processor seconds, the best of the rounds.

wrong: share of rays whose distance differs by more than .1 mm from the nearest of all triangles in double precision
(one after the other, for a part of the rays), leaks: that meet nothing though there is something, error: of the others.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import trimesh
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene
from numba import njit
from signature import signed

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from hall_app.content import load  # noqa: E402
from hall_app.light import Surfaces  # noqa: E402
from hall_app.light.rays import Tree, blocked, build_tree, cast  # noqa: E402
from hall_app.room import raise_room  # noqa: E402
from hall_app.room.lighting import exhibit_solids, surfaces  # noqa: E402

LIFT = 4e-4  # [m] by which a ray starts above its surface
SHORT = 1e-3  # [m] by which a ray to a point ends before it
SAME = 1e-4  # [m] within which a distance is right
COST = ("build_s", "rays_per_s")
OURS = "the bake's"
Rays = dict[str, np.ndarray]
Answers = tuple[np.ndarray, np.ndarray]  # face (N,), −1: none, and distance (N,) [m], NaN where none is told


def hall(folder: Path) -> Surfaces:
    """What the light of a content folder's room is computed on."""
    content = load(folder)
    room = raise_room(content.plan, content.hall.title, content.exhibits)
    return surfaces(room.patches, exhibit_solids(content, Path("hall-data")))


def rays_of(walls: Surfaces, count: int) -> Rays:
    """origins, directions, towards (N, 3) float32 and limit (N,) float32 [m]: rays from the room, and to its points."""
    rng = np.random.default_rng(0)
    corners = walls.vertices[walls.faces[walls.chart >= 0]]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(across, axis=1)
    chosen = rng.choice(len(area), count, p=area / area.sum())
    u, v = rng.random((2, count))
    u, v = np.where(u + v > 1, 1 - u, u), np.where(u + v > 1, 1 - v, v)
    corner = corners[chosen]
    sides = corner[:, 1:] - corner[:, :1]
    normal = across[chosen] / area[chosen, None]
    point = corner[:, 0] + u[:, None] * sides[:, 0] + v[:, None] * sides[:, 1] + LIFT * normal
    ball = rng.normal(size=(count, 3))
    way = normal + ball / np.linalg.norm(ball, axis=1, keepdims=True)
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    to = np.roll(point, -1, axis=0) - point
    far = np.linalg.norm(to, axis=1)
    found = {"origins": point, "directions": way, "towards": to / far[:, None], "limit": far - SHORT}
    return {name: values.astype(np.float32) for name, values in found.items()}


def loose_tree(walls: Surfaces) -> Tree:
    """As the bake's, but with open edges."""
    scene = EmbreeScene(robust=False)
    TriangleMesh(scene, walls.vertices.astype(np.float32), walls.faces)
    ray = np.ones((1, 3), np.float32)
    scene.run(ray, ray)
    return Tree(scene)


def embree(tree: Tree) -> Callable[[str, Rays], Answers]:
    def answer(kind: str, rays: Rays) -> Answers:
        if kind == "nearest":
            face, distance, *_ = cast(tree, rays["origins"], rays["directions"])
            return face, distance
        found = blocked(tree, rays["origins"], rays["directions"], rays["limit"])
        return np.where(found, 0, -1), np.full(len(found), np.nan)

    return answer


def by_trimesh(walls: Surfaces) -> Callable[[str, Rays], Answers]:
    mesh = trimesh.Trimesh(walls.vertices, walls.faces, process=False)
    mesh.ray.intersects_first(np.zeros((1, 3)), np.ones((1, 3)))

    def answer(kind: str, rays: Rays) -> Answers:
        assert kind == "nearest", "it answers no rays with a limit"
        face = mesh.ray.intersects_first(rays["origins"], rays["directions"])
        return face, np.full(len(face), np.nan)

    return answer


ENGINES: dict[str, Callable[[Surfaces], Callable[[str, Rays], Answers]]] = {
    OURS: lambda walls: embree(build_tree(walls.vertices, walls.faces)),
    "not robust": lambda walls: embree(loose_tree(walls)),
    "trimesh": by_trimesh,
}


def timed(engine: str, walls: Surfaces, kind: str, rays: Rays) -> dict:
    """Processor seconds of the tree (`build`) and of the rays, face, distance."""
    begin = time.process_time()
    answer = ENGINES[engine](walls)
    built = time.process_time()
    face, distance = answer(kind, rays)
    return {
        "build": built - begin,
        "seconds": time.process_time() - built,
        "face": face,
        "distance": distance,
    }


@njit(cache=True, error_model="numpy")
def exact(corners, origins, directions):
    """Distance (N,) [m] of the nearest of all triangles (F, 3, 3), inf: none; Möller–Trumbore in double precision."""
    out = np.full(len(origins), np.inf)
    for i in range(len(origins)):
        o, d = origins[i], directions[i]
        for f in range(len(corners)):
            a = corners[f, 0]
            ex, ey, ez = corners[f, 1, 0] - a[0], corners[f, 1, 1] - a[1], corners[f, 1, 2] - a[2]
            fx, fy, fz = corners[f, 2, 0] - a[0], corners[f, 2, 1] - a[1], corners[f, 2, 2] - a[2]
            px, py, pz = d[1] * fz - d[2] * fy, d[2] * fx - d[0] * fz, d[0] * fy - d[1] * fx
            det = ex * px + ey * py + ez * pz
            if abs(det) < 1e-18:
                continue
            tx, ty, tz = o[0] - a[0], o[1] - a[1], o[2] - a[2]
            u = (tx * px + ty * py + tz * pz) / det
            qx, qy, qz = ty * ez - tz * ey, tz * ex - tx * ez, tx * ey - ty * ex
            v = (d[0] * qx + d[1] * qy + d[2] * qz) / det
            t = (fx * qx + fy * qy + fz * qz) / det
            if u >= -1e-12 and v >= -1e-12 and u + v <= 1 + 1e-12 and 0 < t < out[i]:
                out[i] = t
    return out


def errors(kind: str, made: dict, true: np.ndarray, rays: Rays) -> dict[str, float]:
    """wrong, leaks and error of the first rays, whose true distances are known."""
    face, distance = made["face"][: len(true)], made["distance"][: len(true)].astype(float)
    if kind == "blocked":
        limit = rays["limit"][: len(true)]
        clear = np.abs(true - limit) > SAME  # what ends at the limit may be told either way
        return {"wrong": float(((face >= 0) != (true < limit))[clear].mean())}
    leaks = (face < 0) & np.isfinite(true)
    if np.isnan(distance).all():
        return {"leaks": float(leaks.mean())}
    met = (face >= 0) & np.isfinite(true)
    off = np.abs(distance - true)[met]
    right = off <= SAME
    wrong = float(((face >= 0) != np.isfinite(true)).mean() + (~right).sum() / len(true))
    return {"wrong": wrong, "leaks": float(leaks.mean()), "error_max_m": float(off[right].max())}


def agreement(kind: str, one: dict, other: dict) -> dict[str, float]:
    """Share of all rays for which two engines say the same."""
    if kind == "blocked":
        return {"same": float(((one["face"] >= 0) == (other["face"] >= 0)).mean())}
    found = {"same_face": float((one["face"] == other["face"]).mean())}
    if not np.isnan(other["distance"]).all():
        hit = (one["face"] >= 0) & (other["face"] >= 0)
        near = np.abs(one["distance"] - other["distance"]) <= SAME
        found["same_distance"] = float(np.where(hit, near, (one["face"] < 0) == (other["face"] < 0)).mean())
    return found


def measured(walls: Surfaces, kind: str, count: int, known: int, rounds: int) -> dict:
    """One row an engine: seconds of the tree, rays a second, errors, agreement with the bake's."""
    rays = rays_of(walls, count)
    if kind == "blocked":
        rays["directions"] = rays["towards"]
    double = (rays[name][:known].astype(float) for name in ("origins", "directions"))
    single = walls.vertices.astype(np.float32)[walls.faces].astype(float)  # as all engines hold it
    true = exact(single, *double)
    runs: dict[str, list[dict]] = {}
    for _ in range(rounds):
        for engine in ENGINES:
            if engine != "trimesh" or kind == "nearest":
                runs.setdefault(engine, []).append(timed(engine, walls, kind, rays))
    rows = {}
    for engine, made in runs.items():
        rows[engine] = {
            "build_s": round(min(run["build"] for run in made), 3),
            "rays_per_s": round(count / min(run["seconds"] for run in made)),
            **errors(kind, made[0], true, rays),
            **(agreement(kind, runs[OURS][0], made[0]) if engine != OURS else {}),
        }
    return rows


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--rays", type=int, default=1_000_000, help="how many (1,000,000)")
    parser.add_argument("--exact", type=int, default=4000, help="of them with a known answer (4,000)")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--content", type=Path, default=ROOT / "assets", metavar="FOLDER")
    parser.add_argument("--json", type=Path, metavar="FILE")
    args = parser.parse_args()
    walls = hall(args.content)
    found: dict = {"triangles": len(walls.faces), "rays": args.rays, "exact": args.exact, "engines": {}}
    print(f"{len(walls.faces):,} triangles, {args.rays:,} rays, {args.exact:,} with a known answer")
    for kind in ("nearest", "blocked"):
        rows = measured(walls, kind, args.rays, args.exact, args.rounds)
        found["engines"][kind] = rows
        print(f"\n{kind:<16}{'tree':>8}{'M rays/s':>10}{'ratio':>8}   error and agreement with the bake's")
        for engine, row in rows.items():
            told = ", ".join(f"{name} {value:.6g}" for name, value in row.items() if name not in COST)
            ratio = row["rays_per_s"] / rows[OURS]["rays_per_s"]
            print(
                f"{engine:<16}{row['build_s']:>6.2f} s{row['rays_per_s'] / 1e6:>10.2f}{ratio:>8.2f}   {told}"
            )
    if args.json:
        args.json.write_text(json.dumps(signed(found), indent=1) + "\n", "utf-8")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
