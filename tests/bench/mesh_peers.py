"""Triangle and gmsh, each timed in its own call. Runs in the peers' environment and imports nothing of the project.

Reads one JSON object a line: {"engine", "given": npz, "made": npz}; answers {"seconds": …}.
Triangle `p`: constrained Delaunay triangulation of given points and outline steps (the same work as growth); or with
other switches.
gmsh: Frontal-Delaunay on a given outline whose steps it must keep, one thread; `generate(2)` alone is timed.
"""

import json
import sys
from time import perf_counter

import numpy as np


def triangle(given):
    import triangle as engine

    shape = {"vertices": given["points"], "segments": given["steps"]}
    if len(given["inside_holes"]):
        shape["holes"] = given["inside_holes"]
    begin = perf_counter()
    made = engine.triangulate(shape, str(given["switches"]) if "switches" in given else "pQ")
    return perf_counter() - begin, made["vertices"], made["triangles"]


def gmsh(given):
    import gmsh as engine

    engine.initialize()
    for name, value in (
        ("General.Terminal", 0),
        ("General.NumThreads", 1),
        ("Mesh.Algorithm", 6),
        ("Mesh.MeshSizeExtendFromBoundary", 1),
    ):
        engine.option.setNumber(name, value)
    engine.model.add("panel")
    loops, edge = [], float(given["edge"])
    for loop in np.split(given["points"], np.cumsum(given["lengths"])[:-1]):
        ids = [engine.model.geo.addPoint(x, y, 0, edge) for x, y in loop]
        lines = [engine.model.geo.addLine(ids[k - 1], ids[k]) for k in range(len(ids))]
        loops.append(engine.model.geo.addCurveLoop(lines))
    engine.model.geo.addPlaneSurface(loops)
    engine.model.geo.synchronize()
    for _, curve in engine.model.getEntities(1):
        engine.model.mesh.setTransfiniteCurve(curve, 2)
    engine.model.mesh.generate(1)
    begin = perf_counter()
    engine.model.mesh.generate(2)
    seconds = perf_counter() - begin
    tags, places, _ = engine.model.mesh.getNodes()
    index = np.zeros(int(tags.max()) + 1, dtype=np.int64)
    index[tags.astype(np.int64)] = np.arange(len(tags))
    faces = index[engine.model.mesh.getElementsByType(2)[1].astype(np.int64)].reshape(-1, 3)
    engine.finalize()
    return seconds, places.reshape(-1, 3)[:, :2], faces


def main() -> int:
    for line in sys.stdin:
        asked = json.loads(line)
        with np.load(asked["given"]) as given:
            seconds, vertices, faces = {"triangle": triangle, "gmsh": gmsh}[asked["engine"]](given)
        np.savez(asked["made"], vertices=vertices, faces=faces)
        print(json.dumps({"seconds": seconds}), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
