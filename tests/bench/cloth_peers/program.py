"""Runs a peer on a scene, one setting at a time. In the peers' environment; imports nothing of the project.

Reads one JSON object a line: {"engine", "setting", "given": npz, "made": npz}; answers the milliseconds of every
frame (wall and processor), the seconds to build the model and to compile, and the version, or {"error": one line}.
"""

import contextlib
import json
import os
import sys
from time import perf_counter, process_time

import numpy as np


def opened(engine: str, given, setting: dict):
    """The run of an engine, and its version."""
    if engine == "Blender":
        import blender_cloth as module

        return module.BlenderCloth(given, setting), module.VERSION
    if engine.startswith("MuJoCo"):
        import mujoco_cloth as module

        return module.MujocoCloth(given, setting), module.VERSION
    import newton_cloth as module

    style3d = engine == "Newton Style3D"
    return module.NewtonCloth(given, setting, style3d=style3d), module.VERSION


def measured(engine: str, given, setting: dict) -> tuple[dict, np.ndarray]:
    """Figures of a run, and its end (V, 3) or, where `film` is asked for, all frames (T, V, 3) [m].

    Raises TimeoutError for a run that takes more than `longest` seconds of the processor.
    """
    begin = perf_counter()
    run, version = opened(engine, given, setting)
    built = perf_counter()
    run.warm()
    compiled = perf_counter()
    wall, processor, film = [], [], []
    longest, filmed = float(given.get("longest", np.inf)), bool(given.get("film", 0))
    for _ in range(int(given["frames"])):
        w, p = perf_counter(), process_time()
        run.frame()
        wall.append(1e3 * (perf_counter() - w))
        processor.append(1e3 * (process_time() - p))
        if filmed:
            film.append(run.positions())
        if sum(processor) > 1e3 * longest:
            raise TimeoutError(f"not reached in {longest:g} s of processor time")
    figures = {
        "ms": wall,
        "cpu_ms": processor,
        "build_seconds": built - begin,
        "compile_seconds": compiled - built,
        "version": version,
    }
    return figures, np.array(film) if filmed else run.positions()


def main() -> int:
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # peers write to standard output as they like
    for line in sys.stdin:
        asked = json.loads(line)
        try:
            with np.load(asked["given"]) as stored:
                given = {name: stored[name] for name in stored.files}
            with contextlib.redirect_stdout(sys.stderr):
                answer, end = measured(asked["engine"], given, asked["setting"])
            np.savez(asked["made"], positions=end)
        except Exception as error:  # whatever a peer throws is its answer, and the others go on
            answer = {"error": f"{type(error).__name__}: {' '.join(str(error).split())[:300]}"}
        answers.write(json.dumps(answer) + "\n")
        answers.flush()
    return 0


if __name__ == "__main__":
    sys.exit(main())
