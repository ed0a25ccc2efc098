"""Learned cloth: data, trainings and tables of the published scenes; what FOLDER holds already is not made again.

    python tests/bench/bench_learn.py FOLDER [--scene flag …] [--step data|train|evaluate|reconstruct …] [--workers 2]
    python tests/bench/bench_learn.py FOLDER --json docs/figures/learn.json

Everything goes through the commands of `simcore learn`, each run in a process of its own on one core, `--workers` of
them side by side; interrupted or killed, the same command goes on. Steps, in this order: `data` (34,000 frames),
`train` (three seeds of ours, one of each rival), `evaluate` (rows on sequences held back, the reference beside them,
quicker physics over half of each), `more` (two more seeds of the best rival), `reconstruct` (the paper's own task, from
.6 and .25 of the vertices).
A scene takes about two hours of a core; --json keeps what its file tells of scenes that FOLDER does not hold, so that
the three need not be made in one go, nor on one machine.
--quick: sheets and sequences of a size that tries the way out in minutes; their figures say nothing.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import statistics
import subprocess
import sys
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from signature import signed

SCENES = ("flag", "teapot", "hanging")
RIVALS = ("mfsr", "mesh_conv", "paper")
STEPS = ("data", "train", "evaluate", "more", "reconstruct")
# Of the weights: for a quarter of an hour of a core or so on a sheet of 3,000 vertices, a third of that for mfsr.
UPDATES = {"ours": 8000, "mesh_conv": 2400, "mfsr": 1000, "paper": 160}
SEEDS = 3
SHARES = (0.6, 0.25)
# Of every sequence held back, over which the reference is simulated anew: of hanging sheets it is far below all errors.
FLOOR = {"flag": 1.0, "teapot": 1.0, "hanging": 0.5}
QUICKER = "physics,physics_70,physics_50,physics_35"
QUICKER_FRAMES = 0.5  # of every sequence, simulated by each of them
COMMAND = (sys.executable, "-c", "import sys; from sim_core.cli import main; sys.exit(main(sys.argv[1:]))")
QUICK = {"sequences": 3, "frames": 30, "updates": 40}


@dataclass(frozen=True)
class Course:
    """folder: of all that is made; workers: commands side by side; quick: small."""

    folder: Path
    workers: int
    quick: bool

    def data(self, scene: str) -> Path:
        return self.folder / "data" / scene

    def weights(self, scene: str, row: str, seed: int, share: float | None = None) -> Path:
        return self.folder / "weights" / f"{scene}-{row}-{share or 'whole'}-{seed}.safetensors"

    def result(self, scene: str, name: str) -> Path:
        return self.folder / "results" / f"{scene}-{name}.json"

    def run(self, jobs: Iterable[tuple[Path, Sequence[str]]]) -> None:
        """Commands whose result (their JSON) is not there yet, `workers` at a time; raises where one fails."""
        left = [job for job in jobs if not job[0].is_file()]
        with ThreadPoolExecutor(self.workers) as pool:
            for done in pool.map(self._one, left):
                print(done, flush=True)

    def _one(self, job: tuple[Path, Sequence[str]]) -> str:
        result, words = job
        threads = {f"{name}_NUM_THREADS": "1" for name in ("OMP", "OPENBLAS", "MKL")}
        print("begins", " ".join(words), flush=True)
        made = subprocess.run(
            (*COMMAND, "learn", *words, "--json"),
            env=os.environ | threads,
            stdout=subprocess.PIPE,
            text=True,
            check=True,
        )
        result.parent.mkdir(parents=True, exist_ok=True)
        beside = result.with_suffix(".part")
        beside.write_text(made.stdout, "utf-8")
        beside.replace(result)
        return f"made {result.name}"


def data(course: Course, scenes: Sequence[str]) -> None:
    """One scene after the other, since each takes all the workers."""
    few = ("--sequences", str(QUICK["sequences"]), "--frames", str(QUICK["frames"])) if course.quick else ()
    for scene in scenes:
        words = ("data", scene, "--out", str(course.data(scene)), "--floor", "0", *few)
        alone = Course(course.folder, 1, course.quick)
        alone.run([(course.result(scene, "data"), (*words, "--workers", str(course.workers)))])


def trainings(
    course: Course, scenes: Sequence[str], rows: Iterable[tuple[str, int]], share: float | None = None
) -> None:
    """Of every row and seed on every scene; each scene's first, so that a table of all is there soon."""
    jobs = []
    for row, seed in rows:
        for scene in scenes:
            out = course.weights(scene, row, seed, share)
            out.parent.mkdir(parents=True, exist_ok=True)
            updates = QUICK["updates"] if course.quick else UPDATES[row]
            words = [
                "train", scene, "--data", str(course.data(scene)), "--row", row, "--seed", str(seed),
                "--updates", str(updates), "--out", str(out),
            ]  # fmt: skip
            words += ["--share", str(share)] if share else []
            jobs.append((out.with_suffix(".json"), words))
    course.run(jobs)


def evaluations(course: Course, scenes: Sequence[str]) -> None:
    """All rows with their first seed in one run, and networks one by one with every other that was trained."""
    jobs = []
    for scene in scenes:
        made = json.loads(course.result(scene, "data").read_text("utf-8"))
        frames = made["frames"] // made["sequences"]
        floor, quicker = (str(max(5, int(share * frames))) for share in (FLOOR[scene], QUICKER_FRAMES))
        place = ("evaluate", scene, "--data", str(course.data(scene)))
        for seed in range(SEEDS):
            there = [row for row in (*RIVALS, "ours") if course.weights(scene, row, seed).is_file()]
            given = {row: str(course.weights(scene, row, seed)) for row in there}
            if seed == 0:
                words = (*place, "--weights", *given.values(), "--floor", floor)
                jobs.append((course.result(scene, f"first-{'-'.join(there)}"), words))
                words = (*place, "--rows", QUICKER, "--floor", quicker)
                jobs.append((course.result(scene, "physics"), words))
                continue
            for row, weights in given.items():
                words = (*place, "--weights", weights, "--rows", row)
                jobs.append((course.result(scene, f"more-{row}-{seed}"), words))
    course.run(jobs)


def best_rival(course: Course, scene: str) -> str:
    """The network nearest by Hausdorff distance, of those that were trained with one seed."""
    rows = merged(course, scene)["rows"]
    return min((row for row in RIVALS if row in rows), key=lambda row: rows[row][0]["hausdorff_mm"])


def reconstructions(course: Course, scenes: Sequence[str]) -> None:
    jobs = []
    for share in SHARES:
        trainings(course, scenes, [("ours", 0)], share)
        for scene in scenes:
            words = ["evaluate", scene, "--data", str(course.data(scene)), "--share", str(share)]
            words += ["--weights", str(course.weights(scene, "ours", 0, share))]
            words += ["--rows", "linear,biharmonic,local_frames,curvature_linear,curvature_biharmonic,ours"]
            jobs.append((course.result(scene, f"share{share}"), words))
    course.run(jobs)


def merged(course: Course, scene: str) -> dict:
    """rows: name -> a row a seed; gate, of the first; tested."""
    results = course.folder / "results"
    firsts = [json.loads(path.read_text("utf-8")) for path in results.glob(f"{scene}-first-*.json")]
    if not firsts:
        return {"rows": {}}
    first = max(firsts, key=lambda told: len(told["rows"]))
    rows = {name: [row] for name, row in first["rows"].items()}
    if (path := course.result(scene, "physics")).is_file():
        rows |= {name: [row] for name, row in json.loads(path.read_text("utf-8"))["rows"].items()}
    for path in sorted(results.glob(f"{scene}-more-*.json")):
        for name, row in json.loads(path.read_text("utf-8"))["rows"].items():
            rows[name].append(row)
    return {"rows": rows} | {key: first[key] for key in ("tested", "gate") if key in first}


def summary(course: Course, scenes: Sequence[str]) -> dict:
    """What the tables are written from."""
    made: dict = {"scenes": {}}
    for scene in scenes:
        if not course.result(scene, "data").is_file():
            continue
        found = merged(course, scene) | {"data": json.loads(course.result(scene, "data").read_text("utf-8"))}
        found["data"].pop("folder", None)
        found |= {"cores": os.cpu_count(), "machine": platform.machine()}
        trained = sorted((course.folder / "weights").glob(f"{scene}-*.json"))
        keep = ("row", "seed", "share", "updates", "seconds", "parameters", "device")
        told = [json.loads(path.read_text("utf-8")) for path in trained]
        found["trained"] = [{key: one[key] for key in keep if key in one} for one in told]
        shares = {str(share): course.result(scene, f"share{share}") for share in SHARES}
        found["reconstructed"] = {
            share: json.loads(path.read_text("utf-8"))["rows"]
            for share, path in shares.items()
            if path.is_file()
        }
        made["scenes"][scene] = found
    return made


def table(found: dict) -> str:
    lines = []
    for scene, one in found["scenes"].items():
        lines.append(f"{scene}: mean, Hausdorff (p95) mm, normals, ms, whole ms")
        for name, rows in one["rows"].items():
            mean, far = ([row[key] for row in rows] for key in ("mean_mm", "hausdorff_mm"))
            row = rows[0]
            lines.append(
                f"  {name:13}{statistics.mean(mean):8.3f} ({min(mean):.3f}–{max(mean):.3f}){statistics.mean(far):8.2f} "
                f"({min(far):.2f}–{max(far):.2f}; {row['p95_mm']:.1f}){row['normal_deg']:7.2f}°{row['net_ms']:8.2f}"
                f"{row['total_ms']:8.2f}"
            )
        for share, rows in one["reconstructed"].items():
            each = ", ".join(
                f"{name} {row['mean_mm']:.3f}/{row['hausdorff_mm']:.2f}" for name, row in rows.items()
            )
            lines.append(f"  from {share}: {each}")
    return "\n".join(lines)


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path, metavar="FOLDER")
    parser.add_argument("--scene", nargs="+", choices=SCENES, default=SCENES)
    parser.add_argument("--step", nargs="+", choices=STEPS, default=STEPS)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write what the tables are made from")
    args = parser.parse_args()
    course, scenes = Course(args.folder, args.workers, args.quick), args.scene
    if "data" in args.step:
        data(course, scenes)
    if "train" in args.step:
        ours = [("ours", seed) for seed in range(SEEDS)]
        trainings(course, scenes, [ours[0], *((row, 0) for row in RIVALS), *ours[1:]])
    if "evaluate" in args.step:
        evaluations(course, scenes)
    if "more" in args.step:
        for scene in scenes:
            best = best_rival(course, scene)
            trainings(course, [scene], [(best, seed) for seed in range(1, SEEDS)])
        evaluations(course, scenes)
    if "reconstruct" in args.step:
        reconstructions(course, scenes)
    found = summary(course, scenes)
    print(table(found))
    if args.json:
        told = json.loads(args.json.read_text("utf-8")) if args.json.is_file() else {"scenes": {}}
        known = told["scenes"] | found["scenes"]
        told |= {"scenes": {scene: known[scene] for scene in SCENES if scene in known}}
        told = signed(told, found["scenes"])
        args.json.write_text(json.dumps(told, indent=1) + "\n", "utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
